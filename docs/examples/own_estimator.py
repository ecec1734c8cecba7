"""Your own estimator: `python docs/examples/own_estimator.py`."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import ictamp_drake as ict
from ictamp_drake.plugins import Configuration, EstimatorContext, FloatArray, Skeleton


@dataclass(frozen=True)
class RoomConfig:
    """Configuration of the estimator.

    Attributes:
        room: distance between boxes at which success is as likely as not [m].
    """

    room: float = 0.1

    def create(self, _: EstimatorContext) -> "Room":
        """The estimator for one search; its context is for those that ask for the scene or run skills."""
        return Room(self.room)


@dataclass(frozen=True)
class Room:
    """The more room around a box, the likelier it is picked; placements always succeed."""

    room: float

    def estimate(self, options: Sequence[tuple[Configuration, Skeleton]]) -> FloatArray:
        """P of the first action of each plan from its c, shape (len(options),)."""
        return np.array([self._P(c, plan) for c, plan in options])

    def _P(self, c: Configuration, plan: Skeleton) -> float:
        action = plan.actions[0]
        if action.name == "place":
            return 1.0
        position = c.poses[action.args[0]][4:]
        others = [pose[4:] for box, pose in c.poses.items() if box != action.args[0]]
        distance = min((np.linalg.norm(position - other) for other in others), default=np.inf)
        return float(1 - 0.5 ** (distance / self.room))


def main() -> None:
    method = ict.Method(sampler="optimization", time_limit=250)
    task = ict.load(Path(__file__).with_name("own_scene.yaml"), method)
    result = ict.solve(task, method, estimator=RoomConfig()).result
    assert result.solved, result.stop_reason

    tree = result.tree
    P = Room(room=0.1).estimate([(tree.nodes[step.node].c, tree.plans[step.plan]) for step in tree.steps])
    for step, p in zip(tree.steps, P, strict=True):
        print(step.attempt.action, f"was run with P = {p:.2f}")
        assert p == 1 if step.attempt.action.name == "place" else 0 < p < 1


if __name__ == "__main__":
    main()
