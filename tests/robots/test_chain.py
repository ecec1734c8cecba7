import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.core.types import FloatArray
from ictamp_drake.robots.chain import TOLERANCE, is_within, pose_error, turn_into
from ictamp_drake.robots.panda import forward
from tests.robots.arms import CROOKED, PANDA, SIX

angles = st.lists(st.floats(-9.0, 9.0), min_size=7, max_size=7).map(np.array)


@given(angles)
def test_the_pandas_chain_is_its_published_kinematics(q: FloatArray) -> None:
    np.testing.assert_allclose(PANDA.forward(q[None]), forward(q[None]), atol=1e-10)


@given(angles, angles)
def test_jacobian_is_the_derivative_of_forward_kinematics(q: FloatArray, direction: FloatArray) -> None:
    step = 1e-6 * direction / max(1.0, np.abs(direction).max())
    X, J = CROOKED.forward_with_jacobian(np.array([q - step / 2, q, q + step / 2]))
    np.testing.assert_allclose(pose_error(X[:1], X[2:])[0], J[1] @ step, atol=1e-12)


@given(angles)
def test_a_posture_is_at_its_pose_and_not_at_another(q: FloatArray) -> None:
    X_BG = CROOKED.forward(q[None])
    assert CROOKED.is_at(q[None], X_BG).all()
    X_BG[0, 0, 3] += 2 * TOLERANCE
    assert not CROOKED.is_at(q[None], X_BG).any()


@given(angles)
def test_full_turns_lead_into_limits_wherever_they_can(q: FloatArray) -> None:
    for limits in (PANDA.limits, CROOKED.limits):
        turned = turn_into(q, limits)
        np.testing.assert_allclose(np.remainder(turned - q + 1.0, 2 * np.pi), 1.0, atol=1e-9)
        if any(is_within(q + turns, limits) for turns in 2 * np.pi * np.array([[-1], [0], [1]])):
            assert is_within(turned, limits)


def test_limits_hold_up_to_rounding() -> None:
    upper = SIX.limits[1]
    assert is_within(upper + 1e-12, SIX.limits)
    assert not is_within(upper + 1e-6, SIX.limits)
    assert not is_within(upper * np.nan, SIX.limits)
