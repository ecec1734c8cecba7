"""From k to the hand's pose and back, and the meaning of k when objects are elsewhere."""

from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.math import RigidTransform, RotationMatrix

from ictamp_drake.core.types import Action, FloatArray
from ictamp_drake.motion.collision import CollisionScene
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.skills.config import GRID_STEP, PickConfig
from ictamp_drake.skills.geometry import (
    R_DOWN,
    grasp_parameter,
    grasp_pose,
    grip_width,
    hand_poses,
    held_bottom,
    needed_opening,
    placement_parameter,
    placement_pose,
    raise_pose,
    yaw_of,
)
from ictamp_drake.skills.grid import GraspGrid, Lines
from ictamp_drake.world.poses import to_pose, to_transform
from ictamp_drake.world.world import World
from tests.robots import small
from tests.world.scenes import RACK_TOP, SIZES, arrange, far_boxes, hold_box, pose, scene

lengths, turns = st.floats(-0.1, 0.1), st.floats(-3.1, 3.1)
parameters = st.tuples(lengths, lengths, lengths, turns).map(np.array)
moves = st.builds(
    lambda x, y, z, yaw: RigidTransform(RotationMatrix.MakeZRotation(yaw), [x, y, z]), lengths, lengths, lengths, turns
)
rolls = st.sampled_from([0.0, 90.0, 180.0, -90.0])


@pytest.fixture(scope="module")
def world() -> World:
    return World(scene(far_boxes()))


def lying_pose(roll: float, yaw: float) -> FloatArray:
    return pose(0.5, 0.1, 0.1, roll=roll, yaw=yaw)


@given(k=parameters, roll=rolls, yaw=st.floats(-180, 180), tilt=st.floats(-5, 5))
def test_grasp_parameter_is_the_inverse_of_grasp_pose(
    world: World, k: FloatArray, roll: float, yaw: float, tilt: float
) -> None:
    c = arrange(world, {"red_box": pose(0.5, 0.1, 0.1, roll=roll, pitch=tilt, yaw=yaw)})
    X_WG = grasp_pose(world, c, "red_box", k)
    np.testing.assert_allclose(grasp_parameter(world, c, "red_box", X_WG), k, atol=1e-9)


@given(k=parameters, roll=rolls, yaw=st.floats(-180, 180), tilt=st.floats(-5, 5))
def test_the_needed_opening_just_holds_the_box(
    world: World, k: FloatArray, roll: float, yaw: float, tilt: float
) -> None:
    """The corner furthest from the middle of the hand, along the fingers' direction, touches a finger."""
    c = arrange(world, {"red_box": pose(0.5, 0.1, 0.1, roll=roll, pitch=tilt, yaw=yaw)})
    X_WG = grasp_pose(world, c, "red_box", k)
    corners = np.array(np.meshgrid(*[(-side / 2, side / 2) for side in SIZES["red_box"]])).reshape(3, -1)
    p_GC = (X_WG.inverse() @ to_transform(c.poses["red_box"])).multiply(corners)
    needed = needed_opening(world, c, "red_box", X_WG)
    assert np.abs(p_GC[1]).max() == pytest.approx(needed / 2)
    assert needed >= min(SIZES["red_box"]) - 1e-9


@given(k=parameters, roll=rolls, yaw=st.floats(-180, 180))
def test_a_grasp_points_down_and_turns_about_the_vertical(world: World, k: FloatArray, roll: float, yaw: float) -> None:
    c = arrange(world, {"red_box": lying_pose(roll, yaw)})
    X_WG = grasp_pose(world, c, "red_box", k)
    R_WU = world.upright_frame(c, "red_box").X_WU.rotation()
    np.testing.assert_allclose(X_WG.rotation().matrix()[:, 2], [0, 0, -1], atol=1e-9)
    along = np.array([np.cos(k[3]), np.sin(k[3]), 0.0])
    np.testing.assert_allclose(X_WG.rotation().matrix()[:, 0], R_WU @ along, atol=1e-9)
    assert X_WG.translation()[2] == pytest.approx(0.1 + k[2])


@given(k=parameters, roll=rolls, yaw=st.floats(-180, 180), X=moves)
def test_the_same_k_at_a_moved_object_is_the_moved_grasp(
    world: World, k: FloatArray, roll: float, yaw: float, X: RigidTransform
) -> None:
    here, there = (
        arrange(world, {"red_box": p})
        for p in (lying_pose(roll, yaw), to_pose(X @ to_transform(lying_pose(roll, yaw))))
    )
    moved = X @ grasp_pose(world, here, "red_box", k)
    assert grasp_pose(world, there, "red_box", k).IsNearlyEqualTo(moved, 1e-9)


@given(k=parameters, roll=st.sampled_from([0.0, 180.0]), receptacle=st.sampled_from(["table", "rack", "cyan_box"]))
def test_placement_parameter_is_the_inverse_of_placement_pose(
    world: World, k: FloatArray, roll: float, receptacle: str
) -> None:
    c = hold_box(world, "red_box", roll, drop=0.01)
    X_WG0 = to_transform(c.poses["red_box"]) @ RigidTransform(R_DOWN, [0.003, 0.0, 0.02])
    X_GB = held_bottom(world, c, "red_box", X_WG0)
    X_WG = placement_pose(world, c, receptacle, X_GB, k)
    np.testing.assert_allclose(placement_parameter(world, c, receptacle, X_GB, X_WG), k, atol=1e-9)


@given(k=parameters, X=moves)
def test_the_same_k_at_a_moved_receptacle_is_the_moved_placement(
    world: World, k: FloatArray, X: RigidTransform
) -> None:
    here = hold_box(world, "red_box")
    there = arrange(world, {**here.poses, "cyan_box": to_pose(X @ to_transform(here.poses["cyan_box"]))}, "red_box")
    X_GB = held_bottom(world, here, "red_box", to_transform(here.poses["red_box"]) @ RigidTransform(R_DOWN, [0, 0, 0]))
    moved = X @ placement_pose(world, here, "cyan_box", X_GB, k)
    assert placement_pose(world, there, "cyan_box", X_GB, k).IsNearlyEqualTo(moved, 1e-9)


@pytest.mark.parametrize(("receptacle", "height"), [("table", 0.0), ("rack", RACK_TOP), ("cyan_box", 0.07)])
def test_k_zero_puts_the_box_in_the_middle_of_the_top_face(world: World, receptacle: str, height: float) -> None:
    c = hold_box(world, "red_box")
    X_WG0 = to_transform(c.poses["red_box"]) @ RigidTransform(R_DOWN, [0.0, 0.0, 0.01])
    X_WG = placement_pose(world, c, receptacle, held_bottom(world, c, "red_box", X_WG0), np.zeros(4))
    X_WO = X_WG @ X_WG0.inverse() @ to_transform(c.poses["red_box"])
    expected = world.X_WT(c, receptacle).translation() + [0.0, 0.0, SIZES["red_box"][2] / 2]
    np.testing.assert_allclose(X_WO.translation(), expected, atol=1e-9)
    assert expected[2] == pytest.approx(height + 0.059)


def test_the_grip_is_as_wide_as_the_side_between_the_fingers(world: World) -> None:
    c = arrange(world, {"red_box": lying_pose(90.0, 0.0)})
    x, y, _ = world.upright_frame(c, "red_box").size
    assert {x, y} == {0.05, 0.118}
    for turn, side in ((0.0, y), (np.pi, y), (np.pi / 2, x), (-np.pi / 2, x), (0.1, y), (np.pi / 2 - 0.1, x)):
        assert grip_width(world, c, "red_box", turn) == side


@given(yaw=turns, rise=lengths)
def test_raising_goes_straight_up(yaw: float, rise: float) -> None:
    X = RigidTransform(RotationMatrix.MakeZRotation(yaw), [1.0, 2.0, 3.0])
    np.testing.assert_allclose(raise_pose(X, rise).translation(), [1.0, 2.0, 3.0 + rise])
    assert yaw_of(raise_pose(X, rise).rotation()) == pytest.approx(yaw)


@pytest.fixture(scope="module")
def offset(tmp_path_factory: pytest.TempPathFactory) -> World:
    """A hand of two sliding fingers whose grasp frame is 5 mm above the middle of the pads."""
    content = small.content()
    content["gripper"]["grasp"]["position"] = [0, 0, 0.09]
    return World(replace(scene(far_boxes()), robot=str(small.write(tmp_path_factory.mktemp("offset"), content))))


def test_k_is_the_middle_of_the_pads(offset: World) -> None:
    c, k = offset.initial_configuration(), np.array([[0.01, 0.0, 0.02, 0.3]])
    X_UG = offset.upright_frame(c, "blue_box").X_WU.inverse() @ grasp_pose(offset, c, "blue_box", k[0])
    np.testing.assert_allclose(X_UG.translation(), [0.01, 0.0, 0.025], atol=1e-9)
    (many,) = hand_poses(offset, c, Action("pick", ("blue_box", "table")), k, RigidTransform())
    np.testing.assert_allclose(many, grasp_pose(offset, c, "blue_box", k[0]).GetAsMatrix4(), atol=1e-12)


def test_a_grid_of_grasps_has_all_heights_at_which_the_pads_touch_the_box(offset: World) -> None:
    lines = Lines(ArmKinematics(offset.robot, RigidTransform()), CollisionScene(offset))
    grid = GraspGrid(offset, lines, PickConfig(), offset.initial_configuration(), "blue_box")
    heights = [height for (height,) in grid.variants]
    half = SIZES["blue_box"][2] / 2
    assert max(heights) > half + 0.01 + 0.005 - GRID_STEP
    assert min(heights) < -half + 0.005 + GRID_STEP


@given(k=st.lists(parameters, min_size=1, max_size=3).map(np.array), receptacle=st.sampled_from(["rack", "cyan_box"]))
def test_many_hand_poses_at_once_are_those_of_each_k(world: World, k: FloatArray, receptacle: str) -> None:
    c = hold_box(world, "red_box", drop=0.01)
    X_WG = to_transform(c.poses["red_box"]) @ RigidTransform(R_DOWN, [0.003, 0.0, 0.02])
    X_GB = held_bottom(world, c, "red_box", X_WG)
    put = hand_poses(world, c, Action("place", ("red_box", receptacle)), k, X_WG)
    grasped = hand_poses(world, c, Action("pick", ("blue_box", "table")), k, X_WG)
    for number, each in enumerate(k):
        alone = placement_pose(world, c, receptacle, X_GB, each).GetAsMatrix4()
        np.testing.assert_allclose(put[number], alone, atol=1e-12)
        alone = grasp_pose(world, c, "blue_box", each).GetAsMatrix4()
        np.testing.assert_allclose(grasped[number], alone, atol=1e-12)
