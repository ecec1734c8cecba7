"""Thinned tracks agree with the recording."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra import numpy as hnp

from ictamp_drake.viz.keyframes import keyframes, same_hemisphere

TOLERANCE = 0.1

tracks = hnp.arrays(float, st.tuples(st.integers(1, 40), st.integers(1, 3)), elements=st.floats(-2, 2))


@given(tracks)
def test_lines_between_kept_moments_are_within_tolerance(values: np.ndarray) -> None:
    times = np.cumsum(np.linspace(0.5, 1.5, len(values)))
    kept = keyframes(times, values, TOLERANCE)
    shown = np.stack([np.interp(times, times[kept], column[kept]) for column in values.T], axis=1)
    assert np.abs(shown - values).max() <= TOLERANCE + 1e-12


@given(tracks)
def test_first_and_last_are_kept_unless_nothing_moves(values: np.ndarray) -> None:
    kept = keyframes(np.arange(len(values), dtype=float), values, TOLERANCE)
    still = np.abs(values - values[0]).max() <= TOLERANCE
    assert kept == sorted(set(kept))
    assert kept == [0] if still else kept[0] == 0 and kept[-1] == len(values) - 1


def test_a_move_between_two_rests_needs_four_moments() -> None:
    times = np.linspace(0, 10, 101)
    values = np.clip(times - 4, 0, 1)[:, None]
    assert keyframes(times, values, 1e-6) == [0, 40, 50, 100]


def test_quaternions_keep_their_rotation_and_do_not_jump() -> None:
    angles = np.linspace(0, 4 * np.pi, 50)
    quaternions = np.stack([np.cos(angles / 2), np.sin(angles / 2), 0 * angles, 0 * angles], axis=1)
    flipped = quaternions * np.where(quaternions[:, :1] < 0, -1.0, 1.0)
    np.testing.assert_allclose(same_hemisphere(flipped), quaternions, atol=1e-12)
