"""Core's pose arrays (quaternion w, x, y, z, then position) to and from Drake's transforms."""

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RigidTransform

from ictamp_drake.core.types import FloatArray


def to_transform(pose: FloatArray) -> RigidTransform:
    """Drake's transform of a pose array, shape (7,)."""
    return RigidTransform(Quaternion(pose[:4] / np.linalg.norm(pose[:4])), pose[4:])


def to_pose(X: RigidTransform) -> FloatArray:
    """Pose array of Drake's transform, shape (7,)."""
    return np.concatenate([X.rotation().ToQuaternion().wxyz(), X.translation()])


def normalize_quaternion(pose: FloatArray) -> FloatArray:
    """The same pose with a quaternion of length one, which integration does not keep."""
    return np.concatenate([pose[:4] / np.linalg.norm(pose[:4]), pose[4:]])
