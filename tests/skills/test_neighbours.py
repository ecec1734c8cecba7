"""Objects around a place, and the spot with the most room."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.math import RigidTransform, RotationMatrix

from ictamp_drake.skills.neighbours import Neighbour, free_spot, neighbours
from ictamp_drake.world.world import World
from tests.world.scenes import arrange, far_boxes, pose, scene


@pytest.fixture(scope="module")
def world() -> World:
    return World(scene(far_boxes()))


def test_only_what_reaches_higher_counts(world: World) -> None:
    c = arrange(world, {"red_box": pose(0.5, -0.1, 0.025, roll=90.0)})

    def count(height: float, without: set[str]) -> int:
        return len(neighbours(world, c, without, height))

    assert count(0.0, set()) == 5  # four boxes and the rack
    assert count(0.06, set()) == 4  # red_box lies and is 0.05 m high
    assert count(0.06, {"rack", "blue_box"}) == 2
    assert count(0.16, set()) == 0


@given(x=st.floats(-0.3, 0.3), y=st.floats(-0.3, 0.3), yaw=st.floats(-3, 3))
def test_distance_is_that_from_the_outline(x: float, y: float, yaw: float) -> None:
    X_WU = RigidTransform(RotationMatrix.MakeZRotation(yaw), [0.4, 0.1, 0.2])
    neighbour = Neighbour(X_WU, np.array([0.1, 0.05]), 0.1)
    p_W = np.array([X_WU @ np.array([x, y, 0.0])])
    nearest = np.clip([x, y], [-0.1, -0.05], [0.1, 0.05])
    assert neighbour.distance(p_W)[0] == pytest.approx(np.hypot(*([x, y] - nearest)), abs=1e-9)
    assert neighbour.radius == 0.05


def test_the_spot_with_most_room_is_taken() -> None:
    around = [Neighbour(RigidTransform([1.0, 0.0, 0.0]), np.array([0.05, 0.05]), 0.1)]
    X_WT = RigidTransform(RotationMatrix.MakeZRotation(np.pi / 2), [1.0, 0.0, 0.0])
    spots = np.array([[0.08, 0.0], [0.0, 0.3], [0.0, -0.1]])
    np.testing.assert_array_equal(free_spot(spots, X_WT, around, 0.02, 1.0), [0.0, 0.3])
    assert free_spot(spots, X_WT, around, 0.3, 1.0) is None
    assert free_spot(np.empty((0, 2)), X_WT, around, 0.02, 1.0) is None
    np.testing.assert_array_equal(free_spot(spots, X_WT, [], 0.02, 1.0), spots[0])
