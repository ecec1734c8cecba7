"""Batched poses as homogeneous matrices, without Drake: frames of boxes, and the meaning of k.

`grasps` and `level` state what k means. `skills.geometry` builds the same in Drake's types on them.
`learning.parameters` and `learning.dynamics` have it in torch, and tests compare them.
"""

import numpy as np
from numpy.typing import NDArray

from ictamp_drake.core.types import FloatArray

SAME_LENGTH = 1e-6
"""Maximum difference of lengths that count as equal [m]."""


def to_matrices(poses: FloatArray) -> FloatArray:
    """Convert pose arrays, shape (..., 7), to homogeneous matrices, shape (..., 4, 4)."""
    w, x, y, z = np.moveaxis(poses[..., :4] / np.linalg.norm(poses[..., :4], axis=-1, keepdims=True), -1, 0)
    X = np.zeros((*poses.shape[:-1], 4, 4))
    X[..., 0, 0], X[..., 1, 1], X[..., 2, 2] = 1 - 2 * (y * y + z * z), 1 - 2 * (x * x + z * z), 1 - 2 * (x * x + y * y)
    X[..., 0, 1], X[..., 1, 0] = 2 * (x * y - w * z), 2 * (x * y + w * z)
    X[..., 0, 2], X[..., 2, 0] = 2 * (x * z + w * y), 2 * (x * z - w * y)
    X[..., 1, 2], X[..., 2, 1] = 2 * (y * z - w * x), 2 * (y * z + w * x)
    X[..., :3, 3], X[..., 3, 3] = poses[..., 4:], 1.0
    return X


def inverse(X: FloatArray) -> FloatArray:
    """Inverses of homogeneous matrices, shape (n, 4, 4)."""
    X_inverse = np.zeros_like(X)
    X_inverse[:, :3, :3] = X[:, :3, :3].transpose(0, 2, 1)
    X_inverse[:, :3, 3] = -np.einsum("nji,nj->ni", X[:, :3, :3], X[:, :3, 3])
    X_inverse[:, 3, 3] = 1.0
    return X_inverse


def level(parameter: FloatArray) -> FloatArray:
    """Homogeneous matrices of frames turned about z alone, (x, y, z, yaw) of shape (n, 4) [m, rad] -> (n, 4, 4).

    Of the k of placements they are X_TB: the held box's bottom frame B in the receptacle's frame T.
    """
    X = np.zeros((len(parameter), 4, 4))
    c, s = np.cos(parameter[:, 3]), np.sin(parameter[:, 3])
    X[:, 0, 0], X[:, 0, 1], X[:, 1, 0], X[:, 1, 1] = c, -s, s, c
    X[:, :3, 3] = parameter[:, :3]
    X[:, 2, 2] = X[:, 3, 3] = 1.0
    return X


def grasps(k: FloatArray) -> FloatArray:
    """Poses of a hand that points down, shape (n, 4) [m, rad] -> (n, 4, 4). G's z points down, and its x along yaw.

    Of the k of grasps they are X_UG.
    """
    return level(k) * [1.0, -1.0, -1.0, 1.0]


def upright_frames(X_WO: FloatArray, sizes: FloatArray) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """Compute X_WU, side lengths along U's axes, and whether each box is upright.

    U's origin is the box's center, its z is the axis of O nearest to W's z, pointing up, and its x is the axis of O
    that follows. A box is upright when it is as high as it was specified, since nobody can see which of its faces are
    at the bottom and on the sides: a box on its head is upright, and so is a cube on any face.

    Args:
        X_WO: Poses of the m boxes in n states, shape (n, m, 4, 4), or in one, shape (m, 4, 4).
        sizes: Side lengths of the m boxes along O's axes, shape (m, 3) [m].
    """
    axis = np.argmax(np.abs(X_WO[..., 2, :3]), axis=-1)
    sign = np.where(np.take_along_axis(X_WO[..., 2, :3], axis[..., None], axis=-1) > 0, 1.0, -1.0)
    order = (axis[..., None] + [1, 2, 0]) % 3
    X_WU = X_WO.copy()
    X_WU[..., :3, :3] = np.take_along_axis(X_WO[..., :3, :3], order[..., None, :], axis=-1)
    X_WU[..., :3, 1:3] *= sign[..., None]
    sides = np.take_along_axis(np.broadcast_to(sizes, order.shape), order, axis=-1)
    return X_WU, sides, np.abs(sides[..., 2] - sizes[..., 2]) < SAME_LENGTH


def flat(X: FloatArray) -> FloatArray:
    """Position and first two columns of the rotation, shape (..., 4, 4) -> (..., 9)."""
    return np.concatenate([X[..., :3, 3], X[..., :3, 0], X[..., :3, 1]], axis=-1)
