"""U, the upright frame of a box: the promises of `frames.upright_frame` for every way that a box can lie."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix
from scipy.spatial.transform import Rotation

from ictamp_drake.world.frames import upright_frame
from ictamp_drake.world.poses import normalize_quaternion, to_pose, to_transform

SIZE = (0.04, 0.06, 0.1)
ORIENTATIONS = [rotation.as_matrix() for rotation in Rotation.create_group("O")]

angles = st.floats(-np.pi, np.pi)
small = st.floats(-0.3, 0.3)
places = st.tuples(*3 * [st.floats(-1, 1)])


def test_a_box_can_lie_in_24_ways() -> None:
    assert len({tuple(R.ravel().round()) for R in ORIENTATIONS}) == 24


@pytest.mark.parametrize("R_WO", ORIENTATIONS)
def test_z_points_up_and_sizes_belong_to_the_axes(R_WO: np.ndarray) -> None:
    X_WO = RigidTransform(RotationMatrix(R_WO), [0.1, 0.2, 0.3])
    found = upright_frame(to_pose(X_WO), SIZE)
    R_WU = found.X_WU.rotation().matrix()
    np.testing.assert_allclose(R_WU[:, 2], [0, 0, 1], atol=1e-12)
    np.testing.assert_allclose(found.X_WU.translation(), [0.1, 0.2, 0.3])
    np.testing.assert_allclose(np.abs(R_WU) @ found.size, np.abs(R_WO) @ SIZE, atol=1e-12)
    np.testing.assert_allclose(found.X_WT.translation(), [0.1, 0.2, 0.3 + found.size[2] / 2], atol=1e-12)
    assert found.is_upright == (abs(R_WO[2, 2]) > 0.5)


@pytest.mark.parametrize("R_WO", ORIENTATIONS)
@pytest.mark.parametrize("size", [(0.05, 0.05, 0.05), (0.04, 0.06, 0.06)])
def test_a_box_that_is_as_high_as_before_is_upright(R_WO: np.ndarray, size: tuple[float, float, float]) -> None:
    found = upright_frame(to_pose(RigidTransform(RotationMatrix(R_WO), np.zeros(3))), size)
    assert found.is_upright == (found.size[2] == size[2])


@given(angles, angles, angles, places)
def test_axes_are_the_box_s_and_right_handed(roll: float, pitch: float, yaw: float, p: tuple[float, ...]) -> None:
    X_WO = RigidTransform(RollPitchYaw(roll, pitch, yaw), p)
    found = upright_frame(to_pose(X_WO), SIZE)
    R_OU = (X_WO.rotation().inverse() @ found.X_WU.rotation()).matrix()
    np.testing.assert_allclose(np.abs(R_OU), np.abs(R_OU).round(), atol=1e-9)
    assert np.linalg.det(R_OU) == pytest.approx(1.0)
    assert sorted(found.size) == sorted(SIZE)
    np.testing.assert_allclose(np.abs(R_OU.round()) @ found.size, SIZE)
    assert found.X_WU.rotation().matrix()[2, 2] >= np.sqrt(1 / 3) - 1e-9


@given(small, small, angles, places)
def test_u_is_o_for_a_box_that_stands(roll: float, pitch: float, yaw: float, p: tuple[float, ...]) -> None:
    X_WO = RigidTransform(RollPitchYaw(roll, pitch, yaw), p)
    found = upright_frame(to_pose(X_WO), SIZE)
    assert found.is_upright
    assert found.X_WU.IsNearlyEqualTo(X_WO, 1e-12)
    np.testing.assert_array_equal(found.size, SIZE)


@given(angles, angles, angles, places, st.floats(0.5, 2.0))
def test_poses_go_to_transforms_and_back(
    roll: float, pitch: float, yaw: float, p: tuple[float, ...], length: float
) -> None:
    X = RigidTransform(RollPitchYaw(roll, pitch, yaw), p)
    pose = to_pose(X)
    assert to_transform(pose).IsNearlyEqualTo(X, 1e-12)
    stretched = np.append(length * pose[:4], pose[4:])
    assert to_transform(stretched).IsNearlyEqualTo(X, 1e-12)
    np.testing.assert_allclose(normalize_quaternion(stretched), pose, atol=1e-12)


@given(angles, angles, angles, places)
def test_the_same_box_is_the_same_however_often_it_is_looked_at(
    roll: float, pitch: float, yaw: float, p: tuple[float, ...]
) -> None:
    pose = to_pose(RigidTransform(RollPitchYaw(roll, pitch, yaw), p))
    first, turned, again = (
        upright_frame(pose, SIZE),
        upright_frame(pose, SIZE[::-1]),
        upright_frame(pose.copy(), np.array(SIZE)),
    )
    np.testing.assert_array_equal(first.X_WT.GetAsMatrix4(), again.X_WT.GetAsMatrix4())
    np.testing.assert_array_equal(first.size, again.size)
    assert turned.size[2] == SIZE[::-1][SIZE.index(first.size[2])]
    assert not first.size.flags.writeable
    moved = upright_frame(pose + [0, 0, 0, 0, 0, 0, 1e-3], SIZE)
    assert moved.X_WT.translation()[2] == pytest.approx(first.X_WT.translation()[2] + 1e-3)
