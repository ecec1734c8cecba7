import numpy as np
from hypothesis import example, given
from hypothesis import strategies as st

from ictamp_drake.core.types import FloatArray
from ictamp_drake.robots.panda import forward, postures
from tests.panda import HOME, LOWER, UPPER

shares = st.lists(st.floats(0.0, 1.0), min_size=7, max_size=7)
within_limits = shares.map(lambda share: LOWER + np.array(share) * (UPPER - LOWER))


def apart(one: FloatArray, other: FloatArray) -> FloatArray:
    """Greatest difference of an angle, modulo full turns."""
    return np.abs(np.remainder(one - other + np.pi, 2 * np.pi) - np.pi).max(axis=-1)


def existing_postures(X_BG: FloatArray, last: FloatArray) -> FloatArray:
    """The postures that exist, shape (m, 7)."""
    found = postures(X_BG, last)
    assert found.shape == (8, len(last), 7)
    there = np.isfinite(found).all(axis=2)
    assert np.isnan(found[~there]).all()
    return found[there]


@given(within_limits, st.lists(st.floats(-3, 3), min_size=1, max_size=5).map(np.array))
@example(np.zeros(7), np.zeros(1))
def test_all_hold_the_hand_where_it_shall_be(q: FloatArray, last: FloatArray) -> None:
    (X_BG,) = forward(q[None])
    found = existing_postures(X_BG, last)
    assert np.isin(found[:, 6], last).all()
    np.testing.assert_allclose(forward(found), np.broadcast_to(X_BG, (len(found), 4, 4)), atol=1e-6)


@given(within_limits)
def test_every_posture_is_among_those_of_its_hand(q: FloatArray) -> None:
    """Except where a turn of one joint can undo that of another: there are more such postures than can be listed."""
    (X_BG,) = forward(q[None])
    if min(abs(np.sin(q[1])), abs(np.cos(q[4]))) > 1e-3:
        assert apart(existing_postures(X_BG, q[6:]), q).min() < 1e-4


def test_a_posture_has_up_to_eight_twins() -> None:
    found = existing_postures(forward(HOME[None])[0], HOME[6:])
    assert 4 <= len(found) <= 8
    assert all(apart(found[:number], one).min() > 1e-3 for number, one in enumerate(found) if number)


def test_what_is_out_of_reach_has_none() -> None:
    X_BG = np.diag([1.0, -1.0, -1.0, 1.0])
    X_BG[:3, 3] = 1.2, 0.0, 0.1
    assert not len(existing_postures(X_BG, np.linspace(-2, 2, 9)))


def test_each_angle_can_have_a_pose_of_its_own() -> None:
    q = np.stack([HOME, HOME + 0.2, HOME - 0.2])
    X_BG, found = forward(q), postures(forward(q), q[:, 6])
    for number in range(3):
        np.testing.assert_array_equal(found[:, number], postures(X_BG[number], q[[number], 6])[:, 0])
