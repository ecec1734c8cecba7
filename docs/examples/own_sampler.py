"""Your own sampler: `python docs/examples/own_sampler.py`."""

from collections.abc import Iterator
from dataclasses import dataclass
from pathlib import Path

import numpy as np

import ictamp_drake as ict
from ictamp_drake.plugins import Action, Configuration, Parameter, SamplerContext, World

BELOW_TOP = 0.02  # of the grasp [m]
SPREAD = 0.03  # standard deviation of placements [m]


@dataclass(frozen=True)
class CentralConfig:
    """Nothing to choose."""

    def create(self, context: SamplerContext) -> "Central":
        """The sampler for one scene; `context.arm` says what is within reach."""
        return Central(context.world)


class Central:
    """Grasps on the box's axis and placements around the middle; what they hit is left to motion planning."""

    def __init__(self, world: World) -> None:
        self._world = world

    def draws(self, c: Configuration, action: Action, rng: np.random.Generator) -> Iterator[Parameter]:
        """Any number of k = (x, y, z, yaw): see `plugins.Parameter` for the frames."""
        box, place = action.args
        while True:
            yaw = rng.integers(4) * np.pi / 2
            if action.name == "pick":
                yield np.array([0.0, 0.0, self._world.upright_frame(c, box).size[2] / 2 - BELOW_TOP, yaw])
            else:
                spread = 0.0 if place in self._world.spec.boxes else SPREAD
                yield np.array([*rng.normal(0.0, spread, 2), 0.002, yaw])


def main() -> None:
    method = ict.Method(estimator="constant", time_limit=250)
    task = ict.load(Path(__file__).with_name("own_scene.yaml"), method)
    solution = ict.solve(task, method, sampler=CentralConfig())

    assert solution.result.plan is not None, solution.result.stop_reason
    for attempt in solution.result.plan:
        print(attempt.action, "with k =", attempt.k)
        assert attempt.k is not None
        assert attempt.action.name == "place" or not np.any(attempt.k[:2]), "grasps are on the axis"


if __name__ == "__main__":
    main()
