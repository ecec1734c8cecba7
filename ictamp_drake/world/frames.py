"""Frames that skills and predicates speak of: U, a box as it lies, and T, the top face of what things are put on."""

from dataclasses import dataclass
from functools import cached_property, lru_cache

import numpy as np
from pydrake.math import RigidTransform

from ictamp_drake.core.types import FloatArray
from ictamp_drake.world.matrices import upright_frames
from ictamp_drake.world.poses import to_transform


@dataclass(frozen=True, eq=False)
class Upright:
    """A box as it lies.

    Attributes:
        X_WU: frame at the box's centre whose z axis is the box axis nearest to W's z, pointing up.
        size: sides along U's axes, shape (3,) [m].
        is_upright: whether the box stands on the face it was specified with, and not on another one.
    """

    X_WU: RigidTransform
    size: FloatArray
    is_upright: bool

    @cached_property
    def X_WT(self) -> RigidTransform:
        """Frame in the centre of the top face, parallel to U."""
        return self.X_WU @ RigidTransform([0.0, 0.0, self.size[2] / 2])


def upright_frame(pose: FloatArray, size: tuple[float, float, float] | FloatArray) -> Upright:
    """The box as it lies, from X_WO, shape (7,), and its sides along O's axes [m].

    U = O for a box that stands upright; otherwise U's x is the O axis that follows U's z cyclically. The same as
    `matrices.upright_frames`, which does it for many boxes at once, in Drake's types.
    """
    return _upright_frame(pose.tobytes(), tuple(size))


@lru_cache(maxsize=256)
def _upright_frame(pose: bytes, size: tuple[float, ...]) -> Upright:
    """Many questions about the same few boxes come one after the other."""
    X_WO = to_transform(np.frombuffer(pose)).GetAsMatrix4()
    X_WU, sides, stands = upright_frames(X_WO[None], np.array([size]))
    sides.setflags(write=False)
    return Upright(RigidTransform(X_WU[0]), sides[0], bool(stands[0]))
