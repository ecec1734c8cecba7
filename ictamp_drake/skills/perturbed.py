"""k of another sampler with noise: near misses, off-center grasps, drops, crowded and overhanging placements."""

from collections.abc import Iterator
from dataclasses import dataclass

import numpy as np

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.protocols import Sampler
from ictamp_drake.core.types import Action, Configuration, Parameter
from ictamp_drake.world.world import World


@dataclass(frozen=True)
class PerturbedConfig:
    """Largest standard deviations of the noise on k = (x, y, z, yaw).

    Attributes:
        grasp: Deviations for a pick [m, m, m, rad].
        on_box: Deviations for a placement on a box [m, m, m, rad].
        on_support: Deviations for a placement on a support [m, m, m, rad].
        least: Smallest standard deviation as a fraction of the largest. Each number of k draws its own deviation in
            between, log-uniformly.
        any_yaw: Probability that the yaw of a placement is uniformly random.
        lowest: Lower bound of a placement's z, so that it is not pressed deeper into the top face [m].
    """

    grasp: tuple[float, float, float, float] = (0.05, 0.05, 0.03, 0.8)
    on_box: tuple[float, float, float, float] = (0.05, 0.05, 0.04, 0.8)
    on_support: tuple[float, float, float, float] = (0.1, 0.1, 0.04, 1.0)
    least: float = 0.1
    any_yaw: float = 0.3
    lowest: float = -0.002


class PerturbedSampler:
    """Adds noise to what another sampler draws."""

    def __init__(self, world: World, sampler: Sampler[Configuration], config: PerturbedConfig) -> None:
        self._world = world
        self._sampler = sampler
        self._config = config

    def draws(self, c: Configuration, action: Action, rng: np.random.Generator) -> Iterator[Parameter | Failure]:
        """Any number of k, or the failure of the other sampler."""
        for k in self._sampler.draws(c, action, rng):
            yield k if isinstance(k, Failure) else self._shift(k, action, rng)

    def _shift(self, k: Parameter, action: Action, rng: np.random.Generator) -> Parameter:
        config = self._config
        if action.name == "pick":
            return k + self._noise(config.grasp, rng)
        k = k + self._noise(config.on_box if action.args[1] in self._world.spec.boxes else config.on_support, rng)
        k[2] = max(k[2], config.lowest)
        if rng.random() < config.any_yaw:
            k[3] = rng.uniform(-np.pi, np.pi)
        return k

    def _noise(self, largest: tuple[float, float, float, float], rng: np.random.Generator) -> Parameter:
        return np.array(largest) * self._config.least ** rng.random(4) * rng.normal(size=4)
