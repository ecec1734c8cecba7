import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.planning import KinematicTrajectoryOptimization
from scipy.interpolate import BSpline

from ictamp_drake.motion.splines import differentiation, knots, paces

points = st.integers(7, 30)
orders = st.integers(4, 7)


@given(points, orders)
def test_knots_are_those_of_trajectory_optimization(count: int, order: int) -> None:
    basis = KinematicTrajectoryOptimization(7, count, order).basis()
    np.testing.assert_array_equal(knots(count, order), basis.knots())


@given(points, orders, st.integers(0, 99))
def test_differentiation_gives_the_control_points_of_derivatives(count: int, order: int, seed: int) -> None:
    control_points = np.random.default_rng(seed).normal(size=(count, 7))
    spline = BSpline(knots(count, order), control_points, order - 1)
    for times, matrix in enumerate(differentiation(count, order), start=1):
        np.testing.assert_allclose(matrix @ control_points, spline.derivative(times).c[: count - times], rtol=1e-9)


@given(points, orders)
def test_paces_go_forward_from_rest_to_rest(count: int, order: int) -> None:
    for pace in paces(count, order):
        assert list(pace[:3]) == [0.0, 0.0, 0.0]
        assert list(pace[-3:]) == [1.0, 1.0, 1.0]
        assert np.all(np.diff(pace) >= -1e-15)
        np.testing.assert_allclose(pace + pace[::-1], 1.0, atol=1e-12)  # slowing down is speeding up, backwards


@pytest.mark.parametrize("count", [7, 14, 15])
def test_paces_differ_in_how_long_they_cruise(count: int) -> None:
    speed, acceleration, _ = (matrix @ paces(count, 5).T for matrix in differentiation(count, 5))
    for number, column in enumerate(acceleration.T):
        size = np.abs(column)
        assert np.all((size < 1e-9) | np.isclose(size, size.max()))  # full or none
        assert (size < 1e-9).sum() == 2 * number + 2 + count % 2
    assert np.all(np.diff(speed.max(axis=0)) < 0)  # the longer, the slower
