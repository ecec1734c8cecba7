"""Situations, actual and imagined: where all objects of a scene and the hand are, many times at once, without Drake."""

from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ictamp_drake.core.types import FloatArray
from ictamp_drake.world.matrices import grasps, inverse, level

ABSENT = -1
"""Number of no object."""
LIFT = 0.04
"""Rise of the hand with a box it has grasped, in what networks have learned from and by default in ψ_pick [m]."""

Numbers = NDArray[np.intp]


class Steps(NamedTuple):
    """n actions in the numbers of their objects.

    Attributes:
        picks: True for a pick, False for a placement, shape (n,).
        box: Box of the action, shape (n,).
        place: Support or box that it stands on or is put on, shape (n,).
    """

    picks: NDArray[np.bool_]
    box: Numbers
    place: Numbers


class Situations(NamedTuple):
    """All m objects, boxes and then supports, and the hand, n times.

    Attributes:
        X_BU: Poses of the objects' upright frames in the arm's base frame, shape (n, m, 4, 4).
        sizes: Sides along U's axes, shape (n, m, 3) [m].
        tipped: Whether a box is higher or lower than it was specified, shape (n, m).
        X_BG: Pose of the hand in the arm's base frame, shape (n, 4, 4).
        held: Number of the held box, shape (n,).
    """

    X_BU: FloatArray
    sizes: FloatArray
    tipped: NDArray[np.bool_]
    X_BG: FloatArray
    held: Numbers

    def select(self, numbers: Numbers) -> "Situations":
        """Some of the situations, maybe repeatedly."""
        X_BU, sizes, tipped, X_BG, held = self
        return Situations(X_BU[numbers], sizes[numbers], tipped[numbers], X_BG[numbers], held[numbers])

    def tops(self, number: Numbers) -> FloatArray:
        """X_BT of one object of each situation, shape (n, 4, 4)."""
        X_BT = self.X_BU[_index_rows(number), number].copy()
        X_BT[:, :3, 3] += X_BT[:, :3, 2] * self.sizes[_index_rows(number), number, 2:] / 2
        return X_BT

    def targets(self, steps: Steps) -> FloatArray:
        """X_BK of each action's target frame: U of the box to grasp, T of the receptacle, shape (n, 4, 4)."""
        grasped = self.X_BU[_index_rows(steps.box), steps.box]
        return np.where(steps.picks[:, None, None], grasped, self.tops(steps.place))

    def predict_after(self, steps: Steps, k: FloatArray, moved: FloatArray) -> "Situations":
        """Imagine the situations after the actions; all objects but the action's box stay.

        The hand is where it lifted the box to, or where it let go of it: its retreat makes no difference, since an
        empty hand is not seen.

        Args:
            steps: Actions.
            k: Parameters of the actions, shape (n, 4).
            moved: (x, y, z, yaw) of U of the action's box afterwards in the target frame K, shape (n, 4) [m, rad].
        """
        picks, box, _ = steps
        X_BK, X_BU = self.targets(steps), self.X_BU.copy()
        X_BU[_index_rows(box), box] = X_BK @ level(moved)
        lifted = X_BK @ grasps(k)
        lifted[:, 2, 3] += LIFT
        let_go = X_BU[_index_rows(box), box] @ inverse(self.X_BU[_index_rows(box), box]) @ self.X_BG
        X_BG = np.where(picks[:, None, None], lifted, let_go)
        return self._replace(X_BU=X_BU, X_BG=X_BG, held=np.where(picks, box, ABSENT))

    def nearest(self, first: Numbers, box: Numbers, place: Numbers) -> Numbers:
        """Numbers of all objects, the nearest first, without those in `first`: shape (n, 3) -> (n, m).

        An object is as near as its surface is to the box's centre or to the centre of the place's top.
        """
        p_B = np.stack([self.X_BU[_index_rows(box), box, :3, 3], self.tops(place)[:, :3, 3]], axis=1)
        offset = p_B[:, None] - self.X_BU[:, :, None, :3, 3]
        p_U = np.einsum("nmji,nmkj->nmki", self.X_BU[..., :3, :3], offset)
        outside = np.maximum(np.abs(p_U) - self.sizes[:, :, None] / 2, 0.0)
        distance = np.sqrt(np.einsum("nmki,nmki->nmk", outside, outside)).min(axis=2).round(6)
        option, column = np.nonzero(first != ABSENT)
        distance[option, first[option, column]] = np.inf
        order = np.lexsort((*np.moveaxis(self.X_BU[..., :3, 3], 2, 0), distance))  # names decide nothing, not even ties
        order[np.isinf(np.take_along_axis(distance, order, axis=1))] = ABSENT
        return order


def _index_rows(numbers: Numbers) -> Numbers:
    return np.arange(len(numbers))
