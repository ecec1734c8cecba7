"""k drawn uniformly from its range, without any knowledge of the scene's other objects."""

from collections.abc import Iterator

import numpy as np

from ictamp_drake.core.types import Action, Configuration, Parameter
from ictamp_drake.skills.config import UniformConfig
from ictamp_drake.world.world import World


class UniformSampler:
    """Pick: anywhere in the box, or a little above a flat one. Place: on the top face or a little above it. Any yaw."""

    def __init__(self, world: World, config: UniformConfig) -> None:
        self._world = world
        self._config = config

    def draws(self, c: Configuration, action: Action, rng: np.random.Generator) -> Iterator[Parameter]:
        """Any number of k, most of which do not fit."""
        if action.name == "pick":
            half = self._world.upright_frame(c, action.args[0]).size / 2
            lowest = self._world.robot.gripper.hand.lowest_grasp
            low, high = -half, np.append(half[:2], max(half[2], lowest - half[2]))
        else:
            half = np.append(self._world.top_size(c, action.args[1]) / 2, 0.0)
            low, high = -half, half + [0.0, 0.0, self._config.max_height]
        while True:
            yield np.append(rng.uniform(low, high), rng.uniform(*self._config.yaw))
