"""Frames of skills and predicates: U, a box as it lies, and T, the top face of a receptacle."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from pydrake.math import RigidTransform

from ictamp_drake.core.types import FloatArray
from ictamp_drake.world.matrices import upright_frames
from ictamp_drake.world.poses import to_transform


@dataclass(frozen=True, eq=False)
class Upright:
    """Frame and size of a box as it lies.

    Attributes:
        X_WU: Pose of U in W. U's origin is the box's center, and its z is the box axis nearest to W's z, pointing up.
        size: Side lengths along U's axes, shape (3,) [m].
        is_upright: Whether the box is as high as it was specified.
    """

    X_WU: RigidTransform
    size: FloatArray
    is_upright: bool

    @cached_property
    def X_WT(self) -> RigidTransform:
        """Frame in the center of the top face, parallel to U."""
        return self.X_WU @ RigidTransform([0.0, 0.0, self.size[2] / 2])


def upright_frame(pose: FloatArray, size: tuple[float, float, float] | FloatArray) -> Upright:
    """Return the box as it lies, from X_WO, shape (7,), and its side lengths along O's axes [m].

    U = O for a box whose z axis points up. Otherwise U's x is the axis of O that follows U's z cyclically. This is
    `matrices.upright_frames` for one box, in Drake's types.
    """
    return _upright_frame(pose.tobytes(), tuple(size))


@lru_cache(maxsize=256)
def _upright_frame(pose: bytes, size: tuple[float, ...]) -> Upright:
    """Compute `upright_frame` with a cache, since callers ask about the same few boxes again and again."""
    X_WO = to_transform(np.frombuffer(pose)).GetAsMatrix4()
    X_WU, sides, stands = upright_frames(X_WO[None], np.array([size]))
    sides.setflags(write=False)
    return Upright(RigidTransform(X_WU[0]), sides[0], bool(stands[0]))
