"""Things around a place where something is grasped or put."""

from collections.abc import Collection
from typing import NamedTuple

import numpy as np
from pydrake.math import RigidTransform

from ictamp_drake.core.types import Configuration, FloatArray
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World


class Neighbour(NamedTuple):
    """Outline of a box or support, seen from above.

    Attributes:
        X_WU: Frame in the center of the outline, z up.
        half: Half sides of the outline along U's x and y, shape (2,) [m].
        top: Height of the top in W [m].
    """

    X_WU: RigidTransform
    half: FloatArray
    top: float

    @property
    def radius(self) -> float:
        """Radius of the largest circle inside the outline [m]: no point outside is nearer to the center."""
        return float(np.min(self.half))

    def distance(self, p_W: FloatArray) -> FloatArray:
        """Horizontal distance of points from the outline, 0 inside; shape (m, 3) -> (m,) [m]."""
        p_U = (self.X_WU.inverse() @ p_W.T)[:2].T
        return np.linalg.norm(np.maximum(np.abs(p_U) - self.half, 0.0), axis=1)


def neighbours(world: World, c: Configuration, without: Collection[str], height: float) -> list[Neighbour]:
    """All boxes and supports that reach above `height` [m], except the ones named in `without`."""
    found = []
    for name in world.spec.boxes:
        lying = world.upright_frame(c, name)
        top = float(lying.X_WT.translation()[2])
        if name not in without and top > height + 1e-3:
            found.append(Neighbour(lying.X_WU, lying.size[:2] / 2, top))
    for name, support in world.spec.supports.items():
        X_WT = to_transform(support.X_WT)
        top = float(X_WT.translation()[2])
        if name not in without and top > height + 1e-3:
            found.append(Neighbour(X_WT, np.array(support.size[:2]) / 2, top))
    return found


def is_covered(world: World, c: Configuration, box: str) -> bool:
    """Whether a support is above some of the box; 25 points of its outline are tested."""
    lying = world.upright_frame(c, box)
    halves = np.linspace(-0.5, 0.5, 5)
    spots = np.array([(x, y, 0.0) for x in halves for y in halves]) * lying.size
    above = neighbours(world, c, world.spec.boxes, float(lying.X_WT.translation()[2]))
    return any(bool(np.any(each.distance((lying.X_WU @ spots.T).T) == 0)) for each in above)


def free_spot(
    spots: FloatArray, X_WT: RigidTransform, around: Collection[Neighbour], needed: float, room: float
) -> FloatArray | None:
    """The spot with the most room among those with at least `needed` [m], or None.

    Args:
        spots: Candidates in T, shape (m, 2) [m].
        X_WT: Frame of the top face.
        around: Outlines of the neighbors.
        needed: Minimum distance to any outline [m].
        room: Room beyond `needed` above which spots count as equal [m].
    """
    if not len(spots):
        return None
    p_W = (X_WT @ np.column_stack([spots, np.zeros(len(spots))]).T).T
    distance = np.min([np.full(len(spots), needed + room), *(n.distance(p_W) for n in around)], axis=0)
    best = int(np.argmax(distance))
    return spots[best] if distance[best] >= needed else None
