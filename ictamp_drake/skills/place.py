"""ψ_place: transfer, lower, release, retreat."""

from collections.abc import Sequence

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Configuration, GripperCommand, Motion, Parameter
from ictamp_drake.motion.planner import MotionPlanner, Refusal
from ictamp_drake.motion.trajectory import Trajectory
from ictamp_drake.skills.base import configuration_after, hold, imagine, openings
from ictamp_drake.skills.config import PlaceConfig
from ictamp_drake.skills.geometry import held_bottom, level_pose, needed_opening, placement_pose, raise_pose, yaw_of
from ictamp_drake.world.poses import to_pose, to_transform
from ictamp_drake.world.world import World


class Place:
    """Put the held box down on a support or on another box."""

    def __init__(self, world: World, planner: MotionPlanner, config: PlaceConfig) -> None:
        self._world = world
        self._planner = planner
        self._config = config
        self._gripper = world.robot.gripper

    def plan(self, c: Configuration, action: Action, k: Parameter, rng: np.random.Generator) -> Motion | Refusal:
        """The motion that places with parameter k from c, or the reason why there is none."""
        planner, (box, receptacle) = self._planner, action.args
        support = self._world.spec.support_of(receptacle)
        X_WG0 = planner.kinematics.forward(c.q)
        X_GB = held_bottom(self._world, c, box, X_WG0)
        X_WG = placement_pose(self._world, c, receptacle, X_GB, k)
        X_WO = X_WG @ X_WG0.inverse() @ to_transform(c.poses[box])
        above = self._top_above_hand(c, box, X_GB) + self._gripper.hand.tip + self._config.margin

        q_place = planner.posture(c, X_WG, c.commanded, towards=raise_pose(X_WG, max(self._config.drop, above)))
        if isinstance(q_place, Refusal):
            return q_place
        back = planner.plan_straight(c, q_place, raise_pose(X_WG, self._config.drop))
        if isinstance(back, Refusal):
            return back
        needed = needed_opening(self._world, c, box, X_WG0)
        placed = imagine(self._gripper, c, q=q_place, width=needed, held=None, moved={box: to_pose(X_WO)})
        way = self._way_up(placed, openings(self._gripper, needed, self._config.clearances), raise_pose(X_WG, above))
        if isinstance(way, Refusal):
            return way
        opening, retreat = way
        carried = self._carry(c, back.trajectory.reversed(), rng)
        if isinstance(carried, Refusal):
            return carried
        transfer, lower = carried
        return (
            transfer.segment("transfer", c.gripper, {box}),
            lower.segment("lower", c.gripper, {box, support}),
            hold(self._gripper, "release", q_place, c.gripper, opening, touches={box, support}),
            retreat.segment("retreat", opening, ()),
        )

    def _carry(self, c: Configuration, lower: Trajectory, rng: np.random.Generator) -> tuple[Trajectory, ...] | Refusal:
        """Return the transfer to the start of lowering, and lowering itself, as fast as the grip allows."""
        transfer = self._planner.transfer(c, c.commanded, lower.start, rng)
        return transfer if isinstance(transfer, Refusal) else self._planner.carry(c, transfer.trajectory, lower)

    def _way_up(
        self, placed: Configuration, fitting: Sequence[GripperCommand], X_WG: RigidTransform
    ) -> tuple[GripperCommand, Trajectory] | Refusal:
        """The first opening that the neighbors leave room for, and the straight way to X_WG with it."""
        refusal = Refusal(Failure.GOAL_IN_COLLISION)
        for opening in fitting:
            opened = imagine(self._gripper, placed, q=placed.q, width=opening.width, held=None)
            retreat = self._planner.plan_straight(opened, placed.q, X_WG)
            if not isinstance(retreat, Refusal):
                return opening, retreat.trajectory
            refusal = retreat
        return refusal

    def promise(self, c: Configuration, action: Action, k: Parameter, motion: Motion) -> Configuration:
        """c with the box level on the receptacle and the hand retreated."""
        box, receptacle = action.args
        X_WO = to_transform(c.poses[box])
        lying = self._world.upright_frame(c, box)
        X_TB = level_pose(k)
        X_WT = self._world.X_WT(c, receptacle)
        X_WB = X_WT @ X_TB
        X_WU = RigidTransform(
            RotationMatrix.MakeZRotation(yaw_of(X_WB.rotation())),
            [*X_WB.translation()[:2], X_WT.translation()[2] + lying.size[2] / 2],
        )
        end = X_WU @ lying.X_WU.inverse() @ X_WO
        width = motion[-1].gripper.width
        return configuration_after(self._gripper, c, motion, width=width, held=None, moved={box: to_pose(end)})

    def _top_above_hand(self, c: Configuration, box: str, X_GB: RigidTransform) -> float:
        return float(self._world.upright_frame(c, box).size[2] - X_GB.translation()[2])
