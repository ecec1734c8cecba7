"""Speed with a box in the hand: full where the grip allows it, else just as slow as it asks for."""

import numpy as np
import pytest

from ictamp_drake.motion.carrying import Load, slow_down
from ictamp_drake.motion.config import CarryingConfig, TrajectoryConfig
from ictamp_drake.motion.trajectory import Trajectory
from ictamp_drake.motion.trajectory_optimization import TrajectoryOptimizer
from ictamp_drake.robots.grip import GRAVITY, friction_load
from ictamp_drake.robots.panda import forward
from tests.panda import HAND, HOME, PANDA

HANGING = np.array([0.0, 0.0, 0.05])
TURN = np.array([1.5, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0])
TURNED_HAND = HOME - [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, np.pi / 2]
FAST = TrajectoryOptimizer(PANDA, TrajectoryConfig()).connect(HOME, HOME + TURN)
"""An arc about the base, along the fingers' direction."""
ACROSS = TrajectoryOptimizer(PANDA, TrajectoryConfig()).connect(TURNED_HAND, TURNED_HAND + TURN)
"""The same arc across the fingers' direction, so that friction bears the acceleration."""
ANY_SLIDE = CarryingConfig(slide=1.0)


def largest_load(trajectory: Trajectory, mass: float) -> float:
    """Largest load on the friction, by differences of positions over time [N]."""
    times = np.linspace(0.0, trajectory.duration, 801)
    X_WGs = forward(trajectory.positions(times))
    p_WO = X_WGs[:, :3, :3] @ HANGING + X_WGs[:, :3, 3]
    acceleration = np.diff(p_WO, n=2, axis=0) / times[1] ** 2
    forces = mass * (acceleration + [0.0, 0.0, GRAVITY])
    return float(friction_load(HANGING, np.einsum("nji,nj->ni", X_WGs[1:-1, :3, :3], forces), HAND.lever).max())


def test_a_light_box_is_carried_at_full_speed() -> None:
    assert slow_down(FAST, forward, Load(HANGING, 0.1, 45.0, HAND.lever), 0.004, CarryingConfig()) is FAST


@pytest.mark.parametrize("reserve", [1.0, 1.1, 1.25])
def test_a_heavy_box_is_carried_as_slowly_as_the_reserve_asks_for(reserve: float) -> None:
    mass, bearable = 1.8, 24.0
    assert reserve * largest_load(ACROSS, mass) > bearable
    slower = slow_down(
        ACROSS, forward, Load(HANGING, mass, bearable, HAND.lever), 0.004, CarryingConfig(reserve, slide=1.0)
    )
    assert slower is not None
    assert ACROSS.duration < slower.duration < 10 * ACROSS.duration
    assert 0.7 * bearable < reserve * largest_load(slower, mass) <= 1.001 * bearable


def test_the_slide_of_a_time_step_is_limited() -> None:
    """In an arc at constant height it is half the time step times the square of the speed over the radius."""
    limited = CarryingConfig(slide=5e-4)
    slower = slow_down(FAST, forward, Load(HANGING, 0.1, 45.0, HAND.lever), 0.004, limited)
    assert slower is not None
    radius = float(np.linalg.norm(forward(HOME[None])[0, :2, 3]))
    times = np.linspace(0.0, slower.duration, 401)
    turning = np.gradient(slower.positions(times)[:, 0], times)
    slide = 0.004 / 2 * radius * float(np.sum(turning[1:] ** 2)) * times[1]
    assert slide == pytest.approx(5e-4, rel=0.05)
    finer = slow_down(FAST, forward, Load(HANGING, 0.1, 45.0, HAND.lever), 0.002, limited)
    assert finer is not None
    assert finer.duration == pytest.approx(slower.duration / 2, rel=1e-6)


def test_what_the_pads_do_not_bear_at_rest_is_carried_at_no_speed() -> None:
    assert slow_down(FAST, forward, Load(HANGING, 1.8, 17.0, HAND.lever), 0.004, ANY_SLIDE) is None
