"""Functions of many poses at once agree with Drake for each pose."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from pydrake.math import RigidTransform, RotationMatrix

from ictamp_drake.core.types import FloatArray
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.robots.panda import forward
from ictamp_drake.world.frames import upright_frame
from ictamp_drake.world.matrices import flat, grasps, inverse, level, to_matrices, upright_frames
from ictamp_drake.world.poses import to_transform
from tests.panda import LOWER, PANDA, UPPER

seeds = st.integers(0, 2**32 - 1)


def poses(seed: int) -> FloatArray:
    """Four random poses, with quaternions of any length."""
    return np.random.default_rng(seed).normal(size=(4, 7))


@given(seeds)
def test_matrices_of_poses(seed: int) -> None:
    for pose, X in zip(poses(seed), to_matrices(poses(seed)), strict=True):
        np.testing.assert_allclose(X, to_transform(pose).GetAsMatrix4(), atol=1e-12)


@given(seeds)
def test_a_matrix_and_its_inverse_cancel(seed: int) -> None:
    X = to_matrices(poses(seed))
    np.testing.assert_allclose(inverse(X) @ X, np.broadcast_to(np.eye(4), X.shape), atol=1e-12)


@given(seeds)
def test_frames_turned_about_the_vertical_and_the_hand_pointing_down(seed: int) -> None:
    k = np.random.default_rng(seed).normal(size=(4, 4))
    for each, X, X_UG in zip(k, level(k), grasps(k), strict=True):
        turned = RigidTransform(RotationMatrix.MakeZRotation(each[3]), each[:3])
        np.testing.assert_allclose(X, turned.GetAsMatrix4(), atol=1e-12)
        down = turned @ RigidTransform(RotationMatrix.MakeXRotation(np.pi), np.zeros(3))
        np.testing.assert_allclose(X_UG, down.GetAsMatrix4(), atol=1e-12)


@given(seeds)
def test_boxes_lie_as_one_by_one(seed: int) -> None:
    sizes = np.random.default_rng(seed).uniform(0.03, 0.1, (4, 3))
    X_WU, along, stands = upright_frames(to_matrices(poses(seed))[None], sizes)
    for number, pose in enumerate(poses(seed)):
        lying = upright_frame(pose, sizes[number])
        np.testing.assert_allclose(X_WU[0, number], lying.X_WU.GetAsMatrix4(), atol=1e-12)
        np.testing.assert_array_equal(along[0, number], lying.size)
        assert stands[0, number] == lying.is_upright


def test_the_hand_is_where_the_arm_model_has_it() -> None:
    arm = ArmKinematics(PANDA, RigidTransform())
    q = np.random.default_rng(0).uniform(LOWER, UPPER, (50, 7))
    expected = np.array([arm.forward(each).GetAsMatrix4() for each in q])
    np.testing.assert_allclose(forward(q), expected, atol=1e-9)


def test_flat_is_position_and_two_columns() -> None:
    X = to_matrices(poses(0))
    np.testing.assert_array_equal(flat(X), np.hstack([X[:, :3, 3], X[:, :3, 0], X[:, :3, 1]]))
