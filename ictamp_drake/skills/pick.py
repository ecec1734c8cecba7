"""ψ_pick: approach, lower, grasp, lift."""

from dataclasses import dataclass

import numpy as np

from ictamp_drake.core.types import Action, Configuration, GripperCommand, Motion, Parameter
from ictamp_drake.models.constants import MAX_GRIP_FORCE
from ictamp_drake.motion.planner import MotionPlanner, Refusal
from ictamp_drake.scenes.checks import check_fields
from ictamp_drake.skills.base import OPEN, TIP, at_end, hold, imagined
from ictamp_drake.skills.geometry import grasp_pose, grip_width, gripped_squarely, raised
from ictamp_drake.world.poses import to_pose, to_transform
from ictamp_drake.world.situations import LIFT
from ictamp_drake.world.world import World


@dataclass(frozen=True)
class PickConfig:
    """Constants of a pick.

    Attributes:
        force: grip force of each finger [N].
        margin: height of the finger tips above the box before they are lowered [m].
        lift: rise of the hand with the box [m].
    """

    force: float = 30.0
    margin: float = 0.015
    lift: float = LIFT

    def __post_init__(self) -> None:
        check_fields(self, "skills.pick", force=(0.1, MAX_GRIP_FORCE), margin=(0, 1), lift=(1e-3, 1))

    def create(self, world: World, planner: MotionPlanner) -> "Pick":
        """The skill in one scene."""
        return Pick(world, planner, self)


class Pick:
    """Grasps a box from above, wherever and however it lies."""

    def __init__(self, world: World, planner: MotionPlanner, config: PickConfig) -> None:
        self._world = world
        self._planner = planner
        self._config = config

    def plan(self, c: Configuration, action: Action, k: Parameter, rng: np.random.Generator) -> Motion | Refusal:
        """The motion that grasps with parameter k from c, or what is in its way."""
        planner, box = self._planner, action.args[0]
        X_WG = grasp_pose(self._world, c, box, k)
        grasp = GripperCommand(grip_width(self._world, c, box, k[3]), self._config.force)
        above = self._world.upright(c, box).size[2] / 2 - k[2] + TIP + self._config.margin

        planner.set_configuration(imagined(c, q=c.commanded, width=OPEN.width, held=None))
        X_WG_above = raised(X_WG, above)
        q_grasp = planner.posture(X_WG, c.commanded, towards=X_WG_above)
        if isinstance(q_grasp, Refusal):
            return q_grasp
        back = planner.straight(q_grasp, X_WG_above)
        if isinstance(back, Refusal):
            return back
        approach = planner.transfer(c.commanded, back.trajectory.end, rng)
        if isinstance(approach, Refusal):
            return approach
        planner.set_configuration(imagined(c, q=q_grasp, width=grasp.width, held=box))
        lift = planner.straight(q_grasp, raised(X_WG, self._config.lift))
        if isinstance(lift, Refusal):
            return lift
        return (
            approach.trajectory.segment("approach", OPEN, ()),
            back.trajectory.reversed().segment("lower", OPEN, ()),
            hold("grasp", q_grasp, OPEN, grasp, {box}),
            lift.trajectory.segment("lift", grasp, {box}),
        )

    def promise(self, c: Configuration, action: Action, k: Parameter, motion: Motion) -> Configuration:
        """The box in the lifted hand, in the middle of the fingers and square to them."""
        box = action.args[0]
        lying = self._world.upright(c, box)
        X_WG = self._planner.kinematics.forward(motion[-1].control_points[-1])
        X_WU = X_WG @ gripped_squarely(k)
        X_WO = X_WU @ lying.X_WU.inverse() @ to_transform(c.poses[box])
        return at_end(c, motion, width=grip_width(self._world, c, box, k[3]), held=box, moved={box: to_pose(X_WO)})
