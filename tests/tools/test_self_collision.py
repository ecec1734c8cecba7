"""Pairs of links that are tested for self-collision, and their verdicts on typical configurations."""

import numpy as np
import pytest

from ictamp_drake.models.panda import INERTIALS
from ictamp_drake.robots.robot import find_robot
from tools.panda.self_collision import FINGERS, ignored_pairs, panda_probe
from tools.self_collision import ALWAYS, Probe, shares

SAMPLE = 1000
HOME = find_robot("panda").home


@pytest.fixture(scope="module")
def probe() -> Probe:
    return panda_probe(ignored_pairs())


@pytest.fixture(scope="module")
def found() -> dict[tuple[str, str], float]:
    return shares(panda_probe(()), INERTIALS, SAMPLE, seed=1)


def test_pairs_left_out_touch_always_or_never(found: dict[tuple[str, str], float]) -> None:
    for pair in set(ignored_pairs()) - {FINGERS}:
        assert found[pair] == 0.0 or found[pair] >= ALWAYS - 0.03


def test_pairs_that_touch_now_and_then_are_kept(found: dict[tuple[str, str], float]) -> None:
    sometimes = {pair for pair, share in found.items() if 0.0 < share < ALWAYS - 0.03}
    assert len(sometimes) > 10
    assert not (sometimes - {FINGERS}) & set(ignored_pairs())


def test_open_and_closed_hand_at_home_touch_nothing(probe: Probe) -> None:
    for finger in (0.0, 0.02, 0.04):
        assert not probe.touching_pairs(np.r_[HOME, finger, finger])


def test_configurations_around_home_touch_nothing(probe: Probe) -> None:
    rng = np.random.default_rng(2)
    for _ in range(200):
        q = HOME + rng.uniform(-0.4, 0.4, 7)
        assert not probe.touching_pairs(np.r_[q, 0.03, 0.03])


def test_an_arm_folded_into_itself_touches(probe: Probe) -> None:
    folded = np.array([0.0, -1.7, 0.0, -3.05, 0.0, 0.5, 0.785])
    assert probe.touching_pairs(np.r_[folded, 0.03, 0.03])
