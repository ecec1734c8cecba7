"""k drawn uniformly from its range, the least that a sampler can know."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ictamp_drake.core.checks import check_fields, check_interval
from ictamp_drake.core.types import Action, Configuration, Parameter
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.world.world import World


@dataclass(frozen=True)
class UniformConfig:
    """Ranges of k.

    Attributes:
        yaw: least and greatest yaw [rad]; half a turn holds every grasp of a gripper with two fingers.
        max_height: greatest height of a placement above the receptacle's top face [m].
    """

    yaw: tuple[float, float] = (-np.pi / 4, 3 * np.pi / 4)
    max_height: float = 0.01

    def __post_init__(self) -> None:
        check_interval("samplers.uniform.yaw", self.yaw, -10, 10)
        check_fields(self, "samplers.uniform", max_height=(0, 1))

    def create(self, world: World, arm: ArmKinematics) -> "UniformSampler":  # noqa: ARG002  (the same for all samplers)
        """The sampler for one scene."""
        return UniformSampler(world, self)


class UniformSampler:
    """Pick: anywhere in the box. Place: anywhere on the top face, a little above it. Both with any yaw of the range."""

    def __init__(self, world: World, config: UniformConfig) -> None:
        self._world = world
        self._config = config

    def draws(self, c: Configuration, action: Action, rng: np.random.Generator) -> Iterator[Parameter]:
        """Any number of k; there always is one, but it seldom fits."""
        if action.name == "pick":
            half = self._world.upright_frame(c, action.args[0]).size / 2
            low, high = -half, half
        else:
            half = np.append(self._world.top_size(c, action.args[1]) / 2, 0.0)
            low, high = -half, half + [0.0, 0.0, self._config.max_height]
        while True:
            yield np.append(rng.uniform(low, high), rng.uniform(*self._config.yaw))
