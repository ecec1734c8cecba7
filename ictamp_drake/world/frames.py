"""Frames of skills and predicates: U, a box as it lies, and T, the top face of a receptacle."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix

from ictamp_drake.core.types import FloatArray
from ictamp_drake.world.poses import to_transform


@dataclass(frozen=True, eq=False)
class Upright:
    """Frame and size of a box as it lies.

    Attributes:
        X_WU: Pose of U in W. U's origin is the box's center, and its z is the box axis nearest to W's z, pointing up.
        size: Side lengths along U's axes, shape (3,) [m].
        axis: Index of the axis of O that is U's z: 0, 1 or 2.
        sign: Direction of that axis: 1 when it points up, -1 when it points down.
    """

    X_WU: RigidTransform
    size: FloatArray
    axis: int
    sign: int

    @cached_property
    def X_WT(self) -> RigidTransform:
        """Frame in the center of the top face, parallel to U."""
        return self.X_WU @ RigidTransform([0.0, 0.0, self.size[2] / 2])

    @property
    def is_upright(self) -> bool:
        """Whether the box stands on the face that its specification puts at the bottom."""
        return self.axis == 2 and self.sign == 1


def upright_frame(pose: FloatArray, size: tuple[float, float, float] | FloatArray) -> Upright:
    """Return the box as it lies, from X_WO, shape (7,), and its side lengths along O's axes [m].

    U = O for a box that stands upright. Otherwise U's x is the axis of O that follows U's z cyclically.
    """
    return _upright_frame(pose.tobytes(), tuple(size))


@lru_cache(maxsize=256)
def _upright_frame(pose: bytes, size: tuple[float, ...]) -> Upright:
    """Compute `upright_frame` with a cache, since callers ask about the same few boxes again and again."""
    X_WO = to_transform(np.frombuffer(pose))
    vertical = X_WO.rotation().matrix()[2]
    axis = int(np.argmax(np.abs(vertical)))
    sign = 1 if vertical[axis] > 0 else -1
    order = [(axis + 1) % 3, (axis + 2) % 3, axis]
    R_OU = np.zeros((3, 3))
    R_OU[order, range(3)] = [1, sign, sign]
    sides = np.array(size)[order]
    sides.setflags(write=False)
    return Upright(X_WO @ RigidTransform(RotationMatrix(R_OU), np.zeros(3)), sides, axis, sign)
