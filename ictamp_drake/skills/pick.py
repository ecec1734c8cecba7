"""ψ_pick: approach, lower, grasp, lift."""

from dataclasses import replace

import numpy as np
from pydrake.math import RigidTransform

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Configuration, FloatArray, GripperCommand, Motion, Parameter
from ictamp_drake.motion.planner import MotionPlanner, Refusal
from ictamp_drake.motion.trajectory import Trajectory
from ictamp_drake.robots.grip import needed_force
from ictamp_drake.skills.base import configuration_after, hold, imagine, openings
from ictamp_drake.skills.config import PickConfig
from ictamp_drake.skills.geometry import (
    grasp_pose,
    grip_width,
    needed_opening,
    pads_in_hand,
    raise_pose,
    squared_grasp,
)
from ictamp_drake.world.commands import gripper_time
from ictamp_drake.world.poses import to_pose, to_transform
from ictamp_drake.world.world import World


class Pick:
    """Grasp a box from above, wherever and however it lies."""

    def __init__(self, world: World, planner: MotionPlanner, config: PickConfig) -> None:
        self._world = world
        self._planner = planner
        self._config = config
        self._gripper = world.robot.gripper

    def plan(self, c: Configuration, action: Action, k: Parameter, rng: np.random.Generator) -> Motion | Refusal:
        """The motion that grasps with parameter k from c, or the reason why there is none."""
        planner, box = self._planner, action.args[0]
        X_WG = grasp_pose(self._world, c, box, k)
        force = self._choose_force(box, float(squared_grasp(k).translation()[0]))
        if isinstance(force, Refusal):
            return force
        grasp = GripperCommand(grip_width(self._world, c, box, k[3]), force)
        way = self._way_up(c, box, X_WG, k)
        if isinstance(way, Refusal):
            return way
        opening, back = way
        q_grasp = back.start
        approach = self._approach(c, opening, back.end, rng)
        if isinstance(approach, Refusal):
            return approach
        grasped = imagine(self._gripper, c, q=q_grasp, width=grasp.width, held=box)
        lift = planner.plan_straight(grasped, q_grasp, raise_pose(X_WG, self._config.lift))
        if isinstance(lift, Refusal):
            return lift
        lifting = planner.carry(replace(grasped, gripper=grasp), lift.trajectory)
        if isinstance(lifting, Refusal):
            return lifting
        return (
            *approach,
            back.reversed().segment("lower", opening, ()),
            hold(self._gripper, "grasp", q_grasp, opening, grasp, touches={box}),
            lifting[0].segment("lift", grasp, {box}),
        )

    def _choose_force(self, box: str, offset: float) -> float | Refusal:
        """Return the grip force of each finger [N] that holds the box at `offset` [m] from its center."""
        spec, config, most = self._world.spec.boxes[box], self._config, self._gripper.force
        lever = self._gripper.hand.lever
        least = needed_force(spec.mass, spec.friction, lever, safety=config.safety)
        if least > most:
            return Refusal(Failure.TOO_HEAVY, f"it needs {least:.0f} N, and the hand has {most:g} N")
        return min(most, max(config.force, needed_force(spec.mass, spec.friction, lever, offset, config.safety)))

    def _way_up(
        self, c: Configuration, box: str, X_WG: RigidTransform, k: Parameter
    ) -> tuple[GripperCommand, Trajectory] | Refusal:
        """The first opening that the neighbors leave room for, and the straight way up from the grasp with it."""
        planner, config = self._planner, self._config
        tip = self._gripper.hand.tip
        X_WG_above = raise_pose(X_WG, self._world.upright_frame(c, box).size[2] / 2 - k[2] + tip + config.margin)
        refusal = Refusal(Failure.GOAL_IN_COLLISION)
        for opening in openings(self._gripper, needed_opening(self._world, c, box, X_WG), config.clearances):
            opened = imagine(self._gripper, c, q=c.commanded, width=opening.width, held=None)
            q_grasp = planner.posture(opened, X_WG, c.commanded, towards=X_WG_above)
            back = q_grasp if isinstance(q_grasp, Refusal) else planner.plan_straight(opened, q_grasp, X_WG_above)
            if not isinstance(back, Refusal):
                return opening, back.trajectory
            refusal = back
            if refusal.failure is Failure.NO_INVERSE_KINEMATICS:
                break
        return refusal

    def _approach(
        self, c: Configuration, opening: GripperCommand, q: FloatArray, rng: np.random.Generator
    ) -> Motion | Refusal:
        """Motion from c to q, shape (n,) [rad]. The hand changes its opening on the way, or before it if it must."""
        planner = self._planner
        widest = imagine(self._gripper, c, q=c.commanded, width=max(opening.width, c.gripper.width), held=None)
        way = planner.transfer(widest, c.commanded, q, rng)
        first = (
            isinstance(way, Refusal) and way.failure is Failure.GOAL_IN_COLLISION and opening.width < c.gripper.width
        )
        if first:
            opened = imagine(self._gripper, c, q=c.commanded, width=opening.width, held=None)
            way = planner.transfer(opened, c.commanded, q, rng)
        if isinstance(way, Refusal):
            return way
        approach = way.trajectory.segment("approach", opening, ())
        if first or approach.duration < gripper_time(c.gripper, opening, self._gripper.speed):
            return hold(self._gripper, "adjust", c.commanded, c.gripper, opening, touches=()), approach
        return (approach,)

    def promise(self, c: Configuration, action: Action, k: Parameter, motion: Motion) -> Configuration:
        """c with the box in the lifted hand, centered between the fingers and square to them."""
        box = action.args[0]
        lying = self._world.upright_frame(c, box)
        X_WG = self._planner.kinematics.forward(motion[-1].control_points[-1])
        width = grip_width(self._world, c, box, k[3])
        X_WU = X_WG @ pads_in_hand(self._gripper, width) @ squared_grasp(k)
        X_WO = X_WU @ lying.X_WU.inverse() @ to_transform(c.poses[box])
        return configuration_after(self._gripper, c, motion, width=width, held=box, moved={box: to_pose(X_WO)})
