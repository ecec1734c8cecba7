"""Your own skill, another way to carry out an action: `python docs/examples/own_skill.py`."""

from dataclasses import dataclass
from pathlib import Path

import numpy as np

import ictamp_drake as ict
from ictamp_drake.plugins import (
    Action,
    Configuration,
    Motion,
    MotionPlanner,
    Parameter,
    Pick,
    PickConfig,
    Refusal,
    SkillContext,
    SkillsConfig,
    imagine,
    raise_pose,
)


@dataclass(frozen=True)
class ProvenPickConfig:
    """Constants of a pick that proves its grasp.

    Attributes:
        pick: constants of the pick.
        rise: how much further the box is lifted and let down again [m].
    """

    pick: PickConfig = PickConfig()
    rise: float = 0.03

    def create(self, context: SkillContext) -> "ProvenPick":
        """The skill in one scene."""
        return ProvenPick(self.pick.create(context), context.planner, self.rise)


@dataclass(frozen=True, eq=False)
class ProvenPick:
    """ψ_pick that heaves the lifted box once more: a grasp that slips does so here, and not on the way."""

    pick: Pick
    planner: MotionPlanner
    rise: float

    def plan(self, c: Configuration, action: Action, k: Parameter, rng: np.random.Generator) -> Motion | Refusal:
        """The motion with parameter k from c, or what is in its way."""
        motion = self.pick.plan(c, action, k, rng)
        if isinstance(motion, Refusal):
            return motion
        grasp, lift = motion[-2:]
        q_grasp, q_lifted = grasp.control_points[-1], lift.control_points[-1]
        X_WG = self.planner.kinematics.forward(q_lifted)
        gripper = self.planner.kinematics.robot.gripper
        holding = imagine(gripper, c, q=q_grasp, width=lift.gripper.width, held=action.args[0])
        heave = self.planner.plan_straight(holding, q_lifted, raise_pose(X_WG, self.rise))
        if isinstance(heave, Refusal):
            return heave
        way = heave.trajectory
        return (*motion, way.segment("heave", lift.gripper), way.reversed().segment("let down", lift.gripper))

    def promise(self, c: Configuration, action: Action, k: Parameter, motion: Motion) -> Configuration:
        """Where the motion ends if all goes well."""
        return self.pick.promise(c, action, k, motion)


def main() -> None:
    method = ict.Method(sampler="optimization", estimator="constant", time_limit=250)
    task = ict.load(Path(__file__).with_name("own_scene.yaml"), method)
    result = ict.solve(task, method, skills=SkillsConfig(pick=ProvenPickConfig())).result

    assert result.plan is not None, result.stop_reason
    for attempt in result.plan:
        labels = [segment.label for segment in attempt.motion]
        print(attempt.action, *labels, sep=", ")
        assert attempt.action.name == "place" or labels[4:6] == ["heave", "let down"]


if __name__ == "__main__":
    main()
