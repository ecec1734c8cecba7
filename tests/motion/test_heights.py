import numpy as np
import pytest
from pydrake.math import RigidTransform, RotationMatrix

from ictamp_drake.motion.heights import obstacle_height, raised_path, reach_below_grasp
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.world.world import World
from tests.panda import HOME, PANDA
from tools.panda.panda_collision import PAD_HALF_HEIGHT

ARM = ArmKinematics(PANDA, RigidTransform())
TOWER_TOP, RACK_TOP = 0.254, 0.16


def position(*xyz: float) -> np.ndarray:
    return np.array(xyz)


@pytest.mark.parametrize(
    ("p0", "p1", "height"),
    [
        ((0.5, -0.1, 0.1), (0.5, 0.4, 0.1), TOWER_TOP),
        ((0.7, -0.1, 0.1), (0.7, 0.1, 0.1), 0.0),
        ((0.44, -0.3, 0.3), (0.7, -0.3, 0.1), RACK_TOP),
        ((0.5, 0.1, 0.4), (0.5, 0.1, 0.4), TOWER_TOP),
        ((0.5, 0.3, 0.2), (0.7, 0.3, 0.2), 0.106),
    ],
)
def test_height_is_that_of_the_tallest_thing_on_the_way(world: World, p0, p1, height: float) -> None:
    c = world.initial_configuration()
    assert obstacle_height(world, c, position(*p0), position(*p1), 0.05) == pytest.approx(height)


def test_held_box_is_no_obstacle_but_hangs_down(world: World, holding) -> None:
    X_WG = ARM.forward(HOME)
    c = holding(HOME, "red_box", X_WG @ RigidTransform(RotationMatrix.MakeXRotation(np.pi), [0.0, 0.0, 0.03]))
    height = obstacle_height(world, c, position(0.5, 0.0, 0.1), position(0.5, 0.2, 0.1), 0.05)
    assert height == pytest.approx(TOWER_TOP - 0.118)
    assert reach_below_grasp(world, c, X_WG) == pytest.approx(0.03 + 0.059)
    assert reach_below_grasp(world, world.initial_configuration(), X_WG) == PAD_HALF_HEIGHT


def test_raised_path_goes_up_over_and_down(down) -> None:
    q0, q1 = (ARM.solve(down(0.5, y, 0.1), HOME) for y in (-0.1, 0.3))
    assert q0 is not None
    assert q1 is not None
    path = raised_path(ARM, q0, q1, 0.4)
    assert path is not None
    np.testing.assert_array_equal(path[[0, -1]], [q0, q1])
    points = np.array([ARM.forward(q).translation() for q in path])
    over = points[:, 2] > 0.399
    assert over.sum() >= 3
    np.testing.assert_allclose(
        points[~over & (points[:, 1] < 0.1)][:, :2], np.tile([0.5, -0.1], (sum(~over) // 2, 1)), atol=1e-3
    )
    assert raised_path(ARM, q0, q1, 1.5) is None


def test_high_enough_ends_are_joined_by_a_middle_point(down) -> None:
    q0, q1 = (ARM.solve(down(0.5, y, 0.4), HOME) for y in (-0.1, 0.3))
    path = raised_path(ARM, q0, q1, 0.3)
    assert path is not None
    assert len(path) == 3
