import subprocess
import sys
from itertools import pairwise

import numpy as np
import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.core.types import FloatArray
from ictamp_drake.motion.config import PathConfig
from ictamp_drake.motion.paths import find_path
from tests.refusals import refusal

LIMITS = (np.full(7, -2.0), np.full(7, 2.0))
START, END = np.array([-1.0, *[0.0] * 6]), np.array([1.0, *[0.0] * 6])


def wall(q: FloatArray, shrunk: float = 0.0) -> bool:
    """Free outside a wall across the first axis, which has a way around it along the second axis."""
    return not (abs(q[0]) < 0.3 - shrunk and q[1] < 0.4 - shrunk)


def find(seed: int = 0, **changes: float) -> FloatArray | None:
    config = PathConfig(**changes)  # type: ignore[arg-type]
    return find_path(START, END, wall, limits=LIMITS, rng=np.random.default_rng(seed), config=config)


def test_path_leads_round_the_wall() -> None:
    for seed in range(5):
        path = find(seed)
        assert path is not None
        np.testing.assert_allclose(path[[0, -1]], [START, END])
        assert np.all(path >= LIMITS[0])
        assert np.all(path <= LIMITS[1])
        shares = np.linspace(0, 1, 200)[:, None]
        dense = np.vstack([a + shares * (b - a) for a, b in pairwise(path)])
        assert all(wall(q, shrunk=0.05) for q in dense)  # edges are checked that finely


def test_same_seed_gives_the_same_path_whatever_came_before() -> None:
    first, other, again = find(3), find(4), find(3)
    np.testing.assert_array_equal(first, again)
    assert first is not None
    assert other is not None
    assert first.shape != other.shape or not np.allclose(first, other)


def test_no_path_within_the_checks_is_none() -> None:
    assert find(max_checks=10) is None
    assert find(margin=0.2) is None  # the way around is farther out


def test_checks_may_be_as_far_apart_as_the_margin_is_wide_and_no_further() -> None:
    near = PathConfig(margin=0.03, step=0.03)
    for end in (START, START + 1e-6):
        find_path(START, end, lambda _: True, limits=LIMITS, rng=np.random.default_rng(0), config=near)
    with refusal(Code.OUT_OF_RANGE, "skills.motion.path.step", value=0.05):
        PathConfig(margin=0.03)


def test_straight_way_is_taken_when_it_is_free() -> None:
    path = find_path(
        START, END, lambda _: True, limits=LIMITS, rng=np.random.default_rng(0), config=PathConfig(shortcuts=100)
    )
    assert path is not None
    length = np.linalg.norm(np.diff(path, axis=0), axis=1).sum()
    assert length < 1.5 * np.linalg.norm(END - START)


def test_ends_outside_the_limits_are_kept() -> None:
    start = np.array([-2.1, *[0.0] * 6])
    path = find_path(start, END, wall, limits=LIMITS, rng=np.random.default_rng(0), config=PathConfig())
    assert path is not None
    np.testing.assert_allclose(path[0], start)


def test_interrupt_passes_through_the_library() -> None:
    def interrupt(_: FloatArray) -> bool:
        raise KeyboardInterrupt

    with pytest.raises(KeyboardInterrupt):
        find_path(START, END, interrupt, limits=LIMITS, rng=np.random.default_rng(0), config=PathConfig())


def test_library_leaves_nothing_behind() -> None:
    """At exit, the interpreter counts its objects and reports those that were never freed."""
    program = f"""
import numpy as np
from ictamp_drake.motion.config import PathConfig
from ictamp_drake.motion.paths import find_path
limits = np.full(7, -2.0), np.full(7, 2.0)
for seed in range(3):
    rng = np.random.default_rng(seed)
    find_path(np.array({START.tolist()}), np.array({END.tolist()}), lambda q: True, limits=limits, rng=rng,
              config=PathConfig())
"""
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True, check=True)
    assert result.stdout + result.stderr == ""
