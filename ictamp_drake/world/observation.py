"""The primitive state matrix: what skills, P and Q see of a configuration and an action (paper, Experiments).

Eight rows, a row an object, boxes and supports alike. Row 0 is the box to grasp (pick), row 1 the box held (place), row
2 what the box stands on (pick) or the receptacle (place), and rows 3 to 7 are the others, the nearest to the action's
objects first; what does not fit is left out. Absent rows are zero and masked.

Nothing here depends on names, nor on where in the world the scene stands: all is relative to the arm's base frame B, to
the target frame K that k is expressed in (U of the box to grasp, T of the receptacle) and to the hand's frame G.
"""

import math
from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ictamp_drake.core.types import Action, Configuration, FloatArray
from ictamp_drake.models.constants import DH_PARAMETERS, FLANGE_OFFSET, GRASP_OFFSET, HAND_ANGLE
from ictamp_drake.scenes.spec import SceneSpec

ROWS = 8
"""Objects in a matrix at most."""


@dataclass(frozen=True)
class Column:
    """A column of the matrix.

    Attributes:
        name: e.g. target_x.
        unit: of what was divided by `scale`.
        scale: the value in the matrix times this is the quantity.
    """

    name: str
    unit: str
    scale: float


def _pose(frame: str, scale: float) -> tuple[Column, ...]:
    """Position of the object's centre, then the first two columns of the rotation matrix of its upright frame U."""
    turns = (Column(f"{frame}_r{row}{column}", "1", 1.0) for column in "01" for row in "012")
    return (*(Column(f"{frame}_{axis}", "m", scale) for axis in "xyz"), *turns)


def _sides(kind: str, scale: float) -> tuple[Column, ...]:
    return tuple(Column(f"{kind}_{axis}", "m", scale) for axis in "xyz")


@dataclass(frozen=True)
class Schema:
    """What the numbers of a matrix mean; belongs into the metadata of all that was trained on it.

    Columns: `base_*`, pose of U in the arm's base frame B. `target_*`, pose of U in K. `box_*`, sides along U's axes,
    zero for supports. `support_*`, sides of a support (its U is parallel to T, in its middle), zero for boxes. `is_*`
    are 0 or 1: the action's box to grasp; the held box; what the box stands on or is put on; any other object; a
    support; a box that does not stand on the face it was specified with. `hand_*`, pose of U in G, for the held box
    only.
    """

    version: int
    rows: int
    columns: tuple[Column, ...]

    @property
    def width(self) -> int:
        """Number of columns D."""
        return len(self.columns)

    @cached_property
    def _places(self) -> dict[str, int]:
        return {column.name: index for index, column in enumerate(self.columns)}

    def index(self, name: str) -> int:
        """Where the column of that name is."""
        return self._places[name]

    def group(self, prefix: str) -> slice:
        """Where the neighbouring columns are whose names begin so, e.g. "target"."""
        found = [index for index, column in enumerate(self.columns) if column.name.split("_")[0] == prefix]
        return slice(found[0], found[-1] + 1)

    @property
    def scales(self) -> FloatArray:
        """Scale of each column, shape (D,)."""
        return np.array([column.scale for column in self.columns])

    def as_dict(self) -> dict[str, Any]:
        """The same in the types of JSON."""
        return asdict(self)


ROLES = ("grasped", "held", "place", "other")
SCHEMA = Schema(
    version=1,
    rows=ROWS,
    columns=(
        *_pose("base", 0.7),
        *_pose("target", 0.3),
        *_sides("box", 0.1),
        *_sides("support", 1.0),
        *(Column(f"is_{flag}", "1", 1.0) for flag in (*ROLES, "support", "tipped")),
        *_pose("hand", 0.1),
    ),
)
"""The schema of the matrices that this version of the package makes."""

_BASE, _TARGET, _HAND = (SCHEMA.group(frame) for frame in ("base", "target", "hand"))
_BOX, _SUPPORT = SCHEMA.group("box"), SCHEMA.group("support")
_IS_SUPPORT, _IS_TIPPED = SCHEMA.index("is_support"), SCHEMA.index("is_tipped")
_ROLE = [SCHEMA.index(f"is_{role}") for role in ROLES]
_SCALES = SCHEMA.scales


class Observation(NamedTuple):
    """Primitive state matrices.

    Attributes:
        matrix: shape (..., 8, D).
        mask: True where a row holds an object, shape (..., 8).
    """

    matrix: NDArray[np.float32]
    mask: NDArray[np.bool_]


class Observer:
    """Makes the matrices of one scene; pure numpy, no Drake."""

    def __init__(self, spec: SceneSpec) -> None:
        self._boxes = sorted(spec.boxes)
        self._names = [*self._boxes, *sorted(spec.supports)]
        self._row = {name: row for row, name in enumerate(self._names)}
        self._sizes = np.array([spec.boxes[name].size for name in self._boxes])
        self._X_BW = np.linalg.inv(_matrices(spec.arm.X_WB[None])[0])
        supports = [spec.supports[name] for name in self._names[len(self._boxes) :]]
        self._supports = self._X_BW @ _matrices(np.array([support.X_WT for support in supports]))
        self._support_sizes = np.array([support.size for support in supports])
        self._supports[:, :3, 3] -= self._supports[:, :3, 2] * self._support_sizes[:, 2:] / 2

    def observe(self, c: Configuration, action: Action) -> Observation:
        """The matrix of one option, shape (8, D), and its mask, shape (8,)."""
        return self._observe(self._layout(c), action)

    def observe_all(self, options: Sequence[tuple[Configuration, Action]]) -> Observation:
        """The matrices of n options, shape (n, 8, D), and their masks, shape (n, 8).

        Options that share a configuration share most of the work.
        """
        layouts: dict[Configuration, _Layout] = {}
        matrix = np.zeros((len(options), ROWS, SCHEMA.width), dtype=np.float32)
        mask = np.zeros((len(options), ROWS), dtype=bool)
        for number, (c, action) in enumerate(options):
            if c not in layouts:
                layouts[c] = self._layout(c)
            matrix[number], mask[number] = self._observe(layouts[c], action)
        return Observation(matrix, mask)

    def _layout(self, c: Configuration) -> "_Layout":
        """All objects of c, boxes and then supports."""
        count = len(self._boxes)
        X_BU = np.empty((len(self._names), 4, 4))
        X_BU[:count], sizes, upright = _upright(
            _matrices(np.array([c.poses[name] for name in self._boxes])), self._sizes
        )
        X_BU[:count] = self._X_BW @ X_BU[:count]
        X_BU[count:] = self._supports
        columns = np.zeros((len(self._names), SCHEMA.width))
        columns[:, _BASE] = _flat(X_BU)
        columns[:count, _BOX] = sizes
        columns[count:, _SUPPORT] = self._support_sizes
        columns[count:, _IS_SUPPORT] = 1.0
        columns[:count, _IS_TIPPED] = ~upright
        held = None if c.held is None else self._row[c.held]
        return _Layout(X_BU, np.vstack([sizes, self._support_sizes]), columns, _forward(c.q[:7]), held)

    def _observe(self, layout: "_Layout", action: Action) -> Observation:
        box, place = (self._row[name] for name in action.args)
        picks = action.name == "pick"
        X_BK = layout.X_BU[box] if picks else layout.top(place)
        held = layout.held if picks else box
        special = [box if picks else None, None if picks and held == box else held, place]
        others = layout.nearest(box, place, without=[row for row in special if row is not None])
        rows = [*special, *others[: ROWS - len(special)]]
        present = np.array([row is not None for row in rows])
        chosen = [row for row in rows if row is not None]

        matrix = np.zeros((ROWS, SCHEMA.width))
        mask = np.zeros(ROWS, dtype=bool)
        mask[: len(rows)] = present
        matrix[mask] = layout.columns[chosen]
        matrix[mask, _TARGET] = _flat(_inverse(X_BK) @ layout.X_BU[chosen])
        matrix[mask, np.take(_ROLE, np.minimum(np.flatnonzero(mask), 3))] = 1.0
        if mask[1]:
            matrix[1, _HAND] = _flat(_inverse(layout.X_BG) @ layout.X_BU[rows[1]])
        return Observation((matrix / _SCALES).astype(np.float32), mask)


class _Layout(NamedTuple):
    """All objects of a configuration.

    Attributes:
        X_BU: shape (n, 4, 4).
        sizes: along U's axes, shape (n, 3) [m].
        columns: what does not depend on the action, not yet scaled, shape (n, D).
        X_BG: of the hand, shape (4, 4).
        held: row of the held box.
    """

    X_BU: FloatArray
    sizes: FloatArray
    columns: FloatArray
    X_BG: FloatArray
    held: int | None

    def top(self, row: int) -> FloatArray:
        """X_BT of an object, shape (4, 4)."""
        X_BT = self.X_BU[row].copy()
        X_BT[:3, 3] += X_BT[:3, 2] * self.sizes[row, 2] / 2
        return X_BT

    def nearest(self, box: int, place: int, without: Sequence[int]) -> list[int]:
        """All but some objects, those first whose surface is nearest to the box's centre or the place's top centre."""
        p_B = np.stack([self.X_BU[box, :3, 3], self.top(place)[:3, 3]])
        p_U = np.einsum("nji,nmj->nmi", self.X_BU[:, :3, :3], p_B[None] - self.X_BU[:, None, :3, 3])
        outside = np.maximum(np.abs(p_U) - self.sizes[:, None] / 2, 0.0)
        distance = np.sqrt(np.einsum("nmi,nmi->nm", outside, outside)).min(axis=1)
        order = np.lexsort((*self.X_BU[:, :3, 3].T, distance.round(6)))  # names decide nothing, not even between equals
        return [int(row) for row in order if row not in without]


def _matrices(poses: FloatArray) -> FloatArray:
    """Homogeneous matrices, shape (n, 4, 4), of pose arrays, shape (n, 7)."""
    w, x, y, z = (poses[:, :4] / np.linalg.norm(poses[:, :4], axis=1, keepdims=True)).T
    X = np.zeros((len(poses), 4, 4))
    X[:, 0, 0], X[:, 1, 1], X[:, 2, 2] = 1 - 2 * (y * y + z * z), 1 - 2 * (x * x + z * z), 1 - 2 * (x * x + y * y)
    X[:, 0, 1], X[:, 1, 0] = 2 * (x * y - w * z), 2 * (x * y + w * z)
    X[:, 0, 2], X[:, 2, 0] = 2 * (x * z + w * y), 2 * (x * z - w * y)
    X[:, 1, 2], X[:, 2, 1] = 2 * (y * z - w * x), 2 * (y * z + w * x)
    X[:, :3, 3], X[:, 3, 3] = poses[:, 4:], 1.0
    return X


def _inverse(X: FloatArray) -> FloatArray:
    inverse = np.eye(4)
    inverse[:3, :3] = X[:3, :3].T
    inverse[:3, 3] = -X[:3, :3].T @ X[:3, 3]
    return inverse


def _upright(X_WO: FloatArray, sizes: FloatArray) -> tuple[FloatArray, FloatArray, NDArray[np.bool_]]:
    """X_WU, the sides along U's axes, and which boxes stand upright: `frames.upright` for many boxes at once."""
    count = np.arange(len(X_WO))
    axis = np.argmax(np.abs(X_WO[:, 2, :3]), axis=1)
    sign = np.where(X_WO[count, 2, axis] > 0, 1.0, -1.0)
    order = (axis[:, None] + [1, 2, 0]) % 3
    X_WU = X_WO.copy()
    X_WU[:, :3, :3] = np.take_along_axis(X_WO[:, :3, :3], order[:, None, :], axis=2)
    X_WU[:, :3, 1:3] *= sign[:, None, None]
    return X_WU, np.take_along_axis(sizes, order, axis=1), (axis == 2) & (sign > 0)


def _flat(X: FloatArray) -> FloatArray:
    """Position and first two columns of rotation, shape (..., 4, 4) -> (..., 9)."""
    return np.concatenate([X[..., :3, 3], X[..., :3, 0], X[..., :3, 1]], axis=-1)


def _link(a: float, d: float, alpha: float, angle: float) -> FloatArray:
    """Rotation by alpha about x, shift by a along x and d along z, rotation by the angle about z."""
    ca, sa, ct, st = math.cos(alpha), math.sin(alpha), math.cos(angle), math.sin(angle)
    return np.array([[ct, -st, 0, a], [st * ca, ct * ca, -sa, -d * sa], [st * sa, ct * sa, ca, d * ca], [0, 0, 0, 1.0]])


def _forward(q: FloatArray) -> FloatArray:
    """X_BG at the arm's joint positions, shape (7,) [rad] -> (4, 4)."""
    X = np.eye(4)
    for joint, angle in zip(DH_PARAMETERS, q.tolist(), strict=True):
        X = X @ _link(*joint, angle)
    return X @ _link(0.0, FLANGE_OFFSET + GRASP_OFFSET, 0.0, HAND_ANGLE)
