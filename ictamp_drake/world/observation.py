"""The primitive state matrix: what skills, P and Q see of a configuration and an action (paper, Experiments).

Eight rows, a row an object, boxes and supports alike. Row 0 is the box to grasp (pick), row 1 the box held (place), row
2 what the box stands on (pick) or the receptacle (place), and rows 3 to 7 are the others, the nearest to the action's
objects first; what does not fit is left out. Absent rows are zero and masked.

Nothing here depends on names, nor on where in the world the scene stands: all is relative to the arm's base frame B, to
the target frame K that k is expressed in (U of the box to grasp, T of the receptacle) and to the hand's frame G.
"""

from collections.abc import Sequence
from dataclasses import asdict, dataclass
from functools import cached_property
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from ictamp_drake.core.types import Action, Configuration, FloatArray
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.world.matrices import all_upright, flat, forward, inverse, to_matrices

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


ABSENT = -1
"""Number of no object."""

Numbers = NDArray[np.intp]


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
        names = [*self._boxes, *sorted(spec.supports)]
        self._number = {name: number for number, name in enumerate(names)}
        self._sizes = np.array([spec.boxes[name].size for name in self._boxes])
        supports = [spec.supports[name] for name in names[len(self._boxes) :]]
        self._support_sizes = np.array([support.size for support in supports])
        self._X_BW = np.linalg.inv(to_matrices(spec.arm.X_WB))
        self._X_BS = self._X_BW @ to_matrices(np.array([support.X_WT for support in supports]))
        self._X_BS[:, :3, 3] -= self._X_BS[:, :3, 2] * self._support_sizes[:, 2:] / 2

    def observe(self, c: Configuration, action: Action) -> Observation:
        """The matrix of one option, shape (8, D), and its mask, shape (8,)."""
        matrix, mask = self.observe_all([(c, action)])
        return Observation(matrix[0], mask[0])

    def observe_all(self, options: Sequence[tuple[Configuration, Action]]) -> Observation:
        """The matrices of n options, shape (n, 8, D), and their masks, shape (n, 8), in one go."""
        if not options:
            return Observation(np.zeros((0, ROWS, SCHEMA.width), np.float32), np.zeros((0, ROWS), bool))
        distinct = {c: number for number, c in enumerate(dict.fromkeys(c for c, _ in options))}
        layout = self._layout(list(distinct)).at([distinct[c] for c, _ in options])
        picks = np.array([action.name == "pick" for _, action in options])
        box, place = np.array([[self._number[name] for name in action.args] for _, action in options]).T
        first = np.stack([box, layout.held, place], axis=1)
        first[~picks, :2] = np.stack([np.full_like(box, ABSENT), box], axis=1)[~picks]
        first[picks & (first[:, 1] == box), 1] = ABSENT
        rows = layout.rows(first, np.where(picks, box, first[:, 1]), place)
        X_BK = np.where(picks[:, None, None], layout.X_BU[_all(box), box], layout.tops(place))
        return _observation(layout, rows, X_BK)

    def _layout(self, configurations: Sequence[Configuration]) -> "_Layout":
        """All objects, boxes and then supports, of each configuration."""
        count, boxes = len(configurations), len(self._boxes)
        poses = np.array([[c.poses[name] for name in self._boxes] for c in configurations])
        X_WU, sizes, upright = all_upright(to_matrices(poses), self._sizes)
        X_BU = np.concatenate([self._X_BW @ X_WU, np.broadcast_to(self._X_BS, (count, *self._X_BS.shape))], axis=1)
        support_sizes = np.broadcast_to(self._support_sizes, (count, *self._support_sizes.shape))
        columns = np.zeros((*X_BU.shape[:2], SCHEMA.width))
        columns[..., _BASE] = flat(X_BU)
        columns[:, :boxes, _BOX] = sizes
        columns[:, boxes:, _SUPPORT] = support_sizes
        columns[:, boxes:, _IS_SUPPORT] = 1.0
        columns[:, :boxes, _IS_TIPPED] = ~upright
        return _Layout(
            X_BU,
            np.concatenate([sizes, support_sizes], axis=1),
            columns,
            forward(np.array([c.q[:7] for c in configurations])),
            np.array([ABSENT if c.held is None else self._number[c.held] for c in configurations]),
        )


class _Layout(NamedTuple):
    """All m objects of n configurations.

    Attributes:
        X_BU: shape (n, m, 4, 4).
        sizes: along U's axes, shape (n, m, 3) [m].
        columns: what does not depend on the action, not yet scaled, shape (n, m, D).
        X_BG: of the hand, shape (n, 4, 4).
        held: number of the held box, shape (n,).
    """

    X_BU: FloatArray
    sizes: FloatArray
    columns: FloatArray
    X_BG: FloatArray
    held: Numbers

    def at(self, numbers: Sequence[int]) -> "_Layout":
        """Some of the configurations, maybe repeatedly."""
        X_BU, sizes, columns, X_BG, held = self
        return _Layout(X_BU[numbers], sizes[numbers], columns[numbers], X_BG[numbers], held[numbers])

    def tops(self, number: Numbers) -> FloatArray:
        """X_BT of one object of each configuration, shape (n, 4, 4)."""
        X_BT = self.X_BU[_all(number), number].copy()
        X_BT[:, :3, 3] += X_BT[:, :3, 2] * self.sizes[_all(number), number, 2:] / 2
        return X_BT

    def rows(self, first: Numbers, box: Numbers, place: Numbers) -> Numbers:
        """Numbers of the objects in each row, shape (n, 8): the first three as given, then the nearest others.

        An object is as near as its surface is to the box's centre or to the centre of the place's top.
        """
        p_B = np.stack([self.X_BU[_all(box), box, :3, 3], self.tops(place)[:, :3, 3]], axis=1)
        offset = p_B[:, None] - self.X_BU[:, :, None, :3, 3]
        p_U = np.einsum("nmji,nmkj->nmki", self.X_BU[..., :3, :3], offset)
        outside = np.maximum(np.abs(p_U) - self.sizes[:, :, None] / 2, 0.0)
        distance = np.sqrt(np.einsum("nmki,nmki->nmk", outside, outside)).min(axis=2).round(6)
        option, column = np.nonzero(first != ABSENT)
        distance[option, first[option, column]] = np.inf
        order = np.lexsort((*np.moveaxis(self.X_BU[..., :3, 3], 2, 0), distance))  # names decide nothing, not even ties
        order[np.isinf(np.take_along_axis(distance, order, axis=1))] = ABSENT
        return np.concatenate([first, order, np.full((len(first), ROWS), ABSENT)], axis=1)[:, :ROWS]


def _observation(layout: _Layout, rows: Numbers, X_BK: FloatArray) -> Observation:
    mask = rows != ABSENT
    option, row = np.nonzero(mask)
    chosen = rows[mask]
    values = layout.columns[option, chosen]
    X_BU = layout.X_BU[option, chosen]
    values[:, _TARGET] = flat(inverse(X_BK)[option] @ X_BU)
    values[np.arange(len(values)), np.take(_ROLE, np.minimum(row, 3))] = 1.0
    held = row == 1
    values[held, _HAND] = flat(inverse(layout.X_BG)[option[held]] @ X_BU[held])
    matrix = np.zeros((*mask.shape, SCHEMA.width), dtype=np.float32)
    matrix[mask] = values / _SCALES
    return Observation(matrix, mask)


def _all(numbers: Numbers) -> Numbers:
    return np.arange(len(numbers))
