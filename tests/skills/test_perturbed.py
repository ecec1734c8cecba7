"""Noise on k."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import islice, repeat

import numpy as np

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Parameter
from ictamp_drake.skills.perturbed import PerturbedConfig, PerturbedSampler
from ictamp_drake.world.world import World
from tests.world.scenes import build_tower, scene

WORLD = World(scene(build_tower("red_box", "blue_box")))
START = WORLD.initial_configuration()
CONFIG = PerturbedConfig()


@dataclass(frozen=True)
class Fixed:
    """A sampler that always draws the same k."""

    k: Parameter | Failure

    def draws(self, c: object, action: object, rng: object) -> Iterator[Parameter | Failure]:  # noqa: ARG002
        """Draw the fixed k."""
        return repeat(self.k)


def drawn(action: Action, config: PerturbedConfig = CONFIG) -> np.ndarray:
    rng = np.random.default_rng(0)
    sampler = PerturbedSampler(WORLD, Fixed(np.zeros(4)), config)
    return np.array(list(islice(sampler.draws(START, action, rng), 500)))


def test_noise_has_small_and_large_deviations_and_stays_about_the_given_k() -> None:
    noise = np.abs(drawn(Action("pick", ("blue_box", "red_box"))))
    assert np.all(np.quantile(noise, 0.1, axis=0) < 0.05 * np.array(CONFIG.grasp))
    assert np.all(np.quantile(noise, 0.95, axis=0) > 0.5 * np.array(CONFIG.grasp))
    assert np.all(noise.max(axis=0) < 4 * np.array(CONFIG.grasp))


def test_placements_are_never_pressed_down_and_some_have_any_yaw() -> None:
    for place in ("table", "red_box"):
        k = drawn(Action("place", ("blue_box", place)))
        assert k[:, 2].min() == CONFIG.lowest
        assert np.mean(np.abs(k[:, 3]) > np.pi / 2) > 0.1


def test_supports_leave_more_room_than_boxes() -> None:
    on_table, on_box = (drawn(Action("place", ("blue_box", place))) for place in ("table", "red_box"))
    assert on_table[:, 0].std() > on_box[:, 0].std()


def test_no_k_stays_no_k() -> None:
    sampler = PerturbedSampler(WORLD, Fixed(Failure.GOAL_IN_COLLISION), CONFIG)
    k = next(sampler.draws(START, Action("pick", ("blue_box", "red_box")), np.random.default_rng(0)))
    assert k is Failure.GOAL_IN_COLLISION
