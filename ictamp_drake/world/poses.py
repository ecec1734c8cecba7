"""Conversion between pose arrays of core (quaternion w, x, y, z, then position) and Drake's transforms."""

import numpy as np
from pydrake.common.eigen_geometry import Quaternion
from pydrake.math import RigidTransform

from ictamp_drake.core.types import FloatArray


def to_transform(pose: FloatArray) -> RigidTransform:
    """Convert a pose array, shape (7,), to Drake's transform."""
    return RigidTransform(Quaternion(pose[:4] / np.linalg.norm(pose[:4])), pose[4:])


def to_pose(X: RigidTransform) -> FloatArray:
    """Convert Drake's transform to a pose array, shape (7,)."""
    return np.concatenate([X.rotation().ToQuaternion().wxyz(), X.translation()])


def normalize_quaternion(pose: FloatArray) -> FloatArray:
    """Return the same pose with a unit quaternion. Integration does not preserve the length."""
    return np.concatenate([pose[:4] / np.linalg.norm(pose[:4]), pose[4:]])
