"""k of placements in scenes with regions and poses: only those with which the box ends in the action's place."""

from collections.abc import Iterator

import numpy as np

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.protocols import Sampler
from ictamp_drake.core.types import Action, Configuration, Parameter
from ictamp_drake.skills.config import HEIGHTS
from ictamp_drake.skills.geometry import level_pose
from ictamp_drake.world.world import SQUARE, World

MARGIN = 0.003
"""Distance that a placement keeps from the border of a region, inside or outside [m]."""

PATIENCE = 200
"""Number of parameters in a row outside the place after which a sampler is not asked again."""

SHARE = 0.5
"""Share of a pose's tolerance that k may use; the rest is for the execution."""


class AreaSampler:
    """Drops what another sampler draws outside the place of a placement; when too much is dropped, draws at random.

    At a pose it draws k itself, since other samplers rarely hit so small a place.

    Args:
        world: The scene.
        sampler: Other sampler.
        random: Sampler that is asked when `sampler` fails.
    """

    def __init__(self, world: World, sampler: Sampler[Configuration], random: Sampler[Configuration]) -> None:
        self._world = world
        self._samplers = (sampler, random)
        self._divided = {area.on for area in world.spec.areas.values()}

    def draws(self, c: Configuration, action: Action, rng: np.random.Generator) -> Iterator[Parameter | Failure]:
        """Any number of k; for a placement on a divided support or in a region, GOAL_IN_COLLISION when both fail."""
        spec, place = self._world.spec, action.args[1]
        if action.name != "place" or (place not in self._divided and place not in spec.areas):
            return self._samplers[0].draws(c, action, rng)
        if place in spec.poses:
            return self._draw_at_pose(c, action, rng)
        return self._draw_in_place(c, action, rng)

    def _draw_in_place(
        self, c: Configuration, action: Action, rng: np.random.Generator
    ) -> Iterator[Parameter | Failure]:
        for sampler in self._samplers:
            refused = 0
            for k in sampler.draws(c, action, rng):
                if isinstance(k, Failure):
                    break
                if self._is_in_place(c, action, k):
                    refused = 0
                    yield k
                else:
                    refused += 1
                if refused >= PATIENCE:
                    break
        yield Failure.GOAL_IN_COLLISION

    def _is_in_place(self, c: Configuration, action: Action, k: Parameter) -> bool:
        box, place = action.args
        X_WU = self._world.X_WT(c, place) @ level_pose(k)
        margin = -MARGIN if place in self._world.spec.areas else MARGIN
        return self._world.area_at(place, X_WU, self._world.upright_frame(c, box).size, margin) == place

    def _draw_at_pose(self, c: Configuration, action: Action, rng: np.random.Generator) -> Iterator[Parameter]:
        distance, angle = self._world.spec.poses[action.args[1]].tolerance
        quarters = 1 if np.ptp(self._world.upright_frame(c, action.args[0]).size[:2]) < SQUARE else 2
        while True:
            radius, direction = SHARE * distance * rng.uniform() ** 0.5, rng.uniform(-np.pi, np.pi)
            z = rng.uniform(*HEIGHTS)
            yaw = rng.integers(4 // quarters) * quarters * np.pi / 2 + np.deg2rad(SHARE * angle) * rng.uniform(-1, 1)
            yield np.array([radius * np.cos(direction), radius * np.sin(direction), z, yaw])
