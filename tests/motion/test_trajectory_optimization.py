import itertools

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ictamp_drake.core.errors import Code
from ictamp_drake.core.types import FloatArray
from ictamp_drake.models.panda import ARM_LIMITS
from ictamp_drake.motion.config import TrajectoryConfig
from ictamp_drake.motion.trajectory import Trajectory
from ictamp_drake.motion.trajectory_optimization import HalfSpace, TrajectoryOptimizer
from tests.motion.derivatives import derivatives
from tests.panda import HOME, LOWER, PANDA, UPPER
from tests.refusals import refusal

OPTIMIZER = TrajectoryOptimizer(PANDA)
shares = st.lists(st.floats(0.0, 1.0), min_size=7, max_size=7).map(np.array)
FAST = TrajectoryConfig(velocity=0.7, acceleration=0.5, jerk=0.1)
STEPS = np.array([[0.0] * 7, [0.5, 0.3, 0, 0.4, 0, 0.2, 0.3], [0.9, -0.2, 0.1, 0.1, 0.3, 0, 0.8]])


def check_limits(trajectory: Trajectory, config: TrajectoryConfig) -> FloatArray:
    """Greatest used fraction of each limit."""
    times = np.linspace(0.0, trajectory.duration, 2000)
    limits = np.array(ARM_LIMITS)
    qs = trajectory.positions(times)
    assert np.all(qs >= limits[:, 0] - 1e-9)
    assert np.all(qs <= limits[:, 1] + 1e-9)
    used = [np.abs(derivatives(trajectory, times, i)).max(axis=0) / limits[:, 1 + i] for i in (1, 2, 3)]
    parts = np.array(used) / np.array([config.velocity, config.acceleration, config.jerk])[:, None]
    assert parts.max() <= 1 + 1e-9
    return parts


def check_rest(trajectory: Trajectory) -> None:
    points = trajectory.control_points
    for end in points[:3], points[-3:]:  # no velocity and no acceleration, exactly
        np.testing.assert_array_equal(end, end[[0, 0, 0]])
    for order in (1, 2):
        ends = derivatives(trajectory, np.array([0.0, trajectory.duration]), order)
        np.testing.assert_allclose(ends, 0.0, atol=1e-6)


@settings(max_examples=40)
@given(shares, shares)
def test_free_obeys_the_limits_and_ends_at_rest(share0: FloatArray, share1: FloatArray) -> None:
    q0, q1 = (LOWER + share * (UPPER - LOWER) for share in (share0, share1))
    trajectory = OPTIMIZER.connect(q0, q1)
    np.testing.assert_array_equal([trajectory.start, trajectory.end], [q0, q1])
    check_rest(trajectory)
    check_limits(trajectory, OPTIMIZER.config)


paths = st.lists(st.tuples(shares, st.floats(0, 0.02)), min_size=1, max_size=5)


def crooked_path(share: FloatArray, pieces: list[tuple[FloatArray, float]]) -> FloatArray:
    """Path within the limits that turns at every point, shape (m, 7)."""
    path = [LOWER + share * (UPPER - LOWER)]
    for towards, part in pieces:
        path.append(path[-1] + part * (LOWER + towards * (UPPER - LOWER) - path[-1]))
    return np.array(path)


@given(shares, paths, st.sampled_from([TrajectoryConfig(), FAST, TrajectoryConfig(order=7, jerk=0.001)]))
def test_following_a_path_obeys_the_limits_and_ends_at_rest(
    share: FloatArray, pieces: list[tuple[FloatArray, float]], config: TrajectoryConfig
) -> None:
    path = crooked_path(share, pieces)
    trajectory = TrajectoryOptimizer(PANDA, config).follow(path, 14)
    np.testing.assert_array_equal([trajectory.start, trajectory.end], path[[0, -1]])
    check_rest(trajectory)
    check_limits(trajectory, config)


def test_following_a_path_keeps_all_control_points_on_it() -> None:
    path = HOME + 0.2 * STEPS
    dense = np.vstack([np.linspace(*piece, 2000) for piece in itertools.pairwise(path)])
    for point in OPTIMIZER.follow(path, 20).control_points:
        assert np.abs(dense - point).max(axis=1).min() < 1e-3 * np.abs(np.diff(path, axis=0)).max()


@pytest.mark.parametrize("config", [TrajectoryConfig(), FAST])
def test_following_a_path_takes_no_longer_than_optimizing_in_a_narrow_corridor(config: TrajectoryConfig) -> None:
    optimizer = TrajectoryOptimizer(PANDA, config)
    for step in STEPS[1:]:
        path = HOME + np.linspace(0.0, 0.3, 5)[:, None] * step
        assert optimizer.follow(path, 14).duration <= optimizer.follow_corridor(path, 0.0025, 14).duration


@pytest.mark.parametrize("jerk", [0.002, 0.05])
def test_limits_of_jerk_are_heeded_where_they_matter(jerk: float) -> None:
    """Without them, the fastest trajectory would violate the lower limits."""
    config = TrajectoryConfig(jerk=jerk)
    for trajectory in (
        TrajectoryOptimizer(PANDA, config).connect(HOME, HOME + STEPS[2]),
        TrajectoryOptimizer(PANDA, config).follow_corridor(HOME + STEPS, 0.1, 18),
    ):
        parts = check_limits(trajectory, config).max(axis=1)
        assert (parts[2] > 0.6) == (jerk == 0.002)
        assert parts.max() > 0.9


def test_free_uses_the_limits() -> None:
    trajectory = OPTIMIZER.connect(HOME, HOME + STEPS[2])
    assert check_limits(trajectory, OPTIMIZER.config).max(axis=1).max() > 0.9


def test_slower_configuration_takes_longer() -> None:
    slow = TrajectoryConfig(velocity=0.1, acceleration=0.1)
    trajectory = TrajectoryOptimizer(PANDA, slow).connect(HOME, HOME + STEPS[2])
    check_limits(trajectory, slow)
    assert trajectory.duration > 2 * OPTIMIZER.connect(HOME, HOME + STEPS[2]).duration


@pytest.mark.parametrize("part", ["velocity", "acceleration", "jerk"])
@pytest.mark.parametrize("value", [0.0, 2.0])
def test_parts_of_the_limits_are_more_than_nothing_and_at_most_all(part: str, value: float) -> None:
    with refusal(Code.OUT_OF_RANGE, f"skills.motion.trajectory.{part}", value=value):
        TrajectoryConfig(**{part: value})


def test_splines_of_every_order_that_is_allowed_obey_the_limits() -> None:
    for order, points in ((4, 7), (7, 7), (4, 20), (7, 20)):
        config = TrajectoryConfig(order=order, control_points=points, velocity=1.0)
        check_limits(TrajectoryOptimizer(PANDA, config).connect(HOME, HOME + STEPS[2]), config)
    for order in (0, 3, 8):
        with refusal(Code.OUT_OF_RANGE, "skills.motion.trajectory.order", value=order):
            TrajectoryConfig(order=order)


def test_nowhere_to_go_takes_almost_no_time() -> None:
    trajectory = OPTIMIZER.connect(HOME, HOME)
    assert 0 < trajectory.duration < 0.01
    np.testing.assert_allclose(trajectory.positions(np.array([0.0, trajectory.duration])), [HOME, HOME])


@pytest.mark.parametrize(("radius", "points"), [(0.02, 30), (0.1, 18), (0.3, 14)])
def test_along_stays_in_the_corridor(radius: float, points: int) -> None:
    path = HOME + STEPS
    trajectory = OPTIMIZER.follow_corridor(path, radius, points)
    check_rest(trajectory)
    check_limits(trajectory, OPTIMIZER.config)
    shares = np.linspace(0, 1, 500)[:, None]
    dense = np.vstack([path[0] + shares * (path[1] - path[0]), path[1] + shares * (path[2] - path[1])])
    distances = [np.abs(dense - point).max(axis=1).min() for point in trajectory.control_points]
    assert max(distances) <= radius + 2e-3


def test_wider_corridor_is_not_slower() -> None:
    durations = [OPTIMIZER.follow_corridor(HOME + STEPS, radius, 14).duration for radius in (0.01, 0.1, 0.5)]
    assert durations[0] > durations[1] > durations[2]


def test_around_meets_demands_that_the_trajectory_did_not() -> None:
    trajectory = OPTIMIZER.connect(HOME, HOME + STEPS[2])
    normal = np.eye(7)[3]
    middle = np.array([trajectory.duration / 2])
    offset = float(trajectory.positions(middle)[0, 3]) + 0.1
    moved = OPTIMIZER.adjust(trajectory, 0.3, [HalfSpace(0.5, normal, offset)])
    assert moved.positions(np.array([moved.duration / 2]))[0, 3] >= offset - 1e-5
    np.testing.assert_array_equal([moved.start, moved.end], [trajectory.start, trajectory.end])
    check_rest(moved)
    check_limits(moved, OPTIMIZER.config)
    again = OPTIMIZER.connect(HOME, HOME + STEPS[2])
    np.testing.assert_array_equal(again.control_points, trajectory.control_points)  # the demand is forgotten


def test_demands_out_of_reach_leave_a_valid_trajectory() -> None:
    trajectory = OPTIMIZER.connect(HOME, HOME + STEPS[2])
    moved = OPTIMIZER.adjust(trajectory, 0.05, [HalfSpace(0.5, np.eye(7)[0], 50.0)])
    assert np.abs(moved.control_points - trajectory.control_points).max() <= 0.05 + 1e-9
    check_limits(moved, OPTIMIZER.config)


def test_history_does_not_change_the_result() -> None:
    fresh = TrajectoryOptimizer(PANDA).connect(HOME, HOME + STEPS[1])
    used = TrajectoryOptimizer(PANDA)
    used.connect(HOME + STEPS[2], HOME)
    used.follow_corridor(HOME + STEPS, 0.1, 14)
    np.testing.assert_array_equal(used.connect(HOME, HOME + STEPS[1]).control_points, fresh.control_points)
