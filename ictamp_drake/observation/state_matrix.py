"""The primitive state matrix: what skills, P and Q see of a configuration and an action (paper, Experiments).

Eight rows, a row an object, boxes and supports alike. Row 0 is the box to grasp (pick), row 1 the box held (place), row
2 what the box stands on (pick) or the receptacle (place), and rows 3 to 7 are the others, the nearest to the action's
objects first; what does not fit is left out. Absent rows are zero and masked.

Lengths are in metres. Networks divide each column by its scale, and nothing else does (`learning.parameters`).

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
from ictamp_drake.observation.situations import ABSENT, Numbers, Situations, Steps
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.world.matrices import flat, inverse, to_matrices, upright_frames

ROWS = 8
"""Objects in a matrix at most."""


@dataclass(frozen=True)
class Column:
    """A column of the matrix.

    Attributes:
        name: Name, e.g. target_x.
        unit: Unit of the value.
        scale: Value that networks take for 1.
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
    """Meaning of the numbers of a matrix; part of the metadata of everything that was trained on it.

    Columns: `base_*`, pose of U in the arm's base frame B. `target_*`, pose of U in K. `box_*`, sides along U's axes,
    zero for supports. `support_*`, sides of a support (its U is parallel to T, in its middle), zero for boxes. `is_*`
    are 0 or 1: the action's box to grasp; the held box; what the box stands on or is put on; any other object; a
    support; a box that is higher or lower than it was specified. `hand_*`, pose of U in G, for the held box
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
        """Index of the column of that name."""
        return self._places[name]

    def group(self, prefix: str) -> slice:
        """Slice of the adjacent columns whose names begin with a prefix, e.g. "target"."""
        found = [index for index, column in enumerate(self.columns) if column.name.split("_")[0] == prefix]
        return slice(found[0], found[-1] + 1)

    @property
    def scales(self) -> FloatArray:
        """Scale of each column, shape (D,): networks take the matrix divided by these."""
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


class Observation(NamedTuple):
    """Primitive state matrices.

    Attributes:
        matrix: Numbers, shape (..., 8, D), in the units of `SCHEMA`.
        mask: True where a row holds an object, shape (..., 8).
    """

    matrix: NDArray[np.float32]
    mask: NDArray[np.bool_]


class Observer:
    """Makes the matrices of one scene; pure numpy, no Drake."""

    def __init__(self, spec: SceneSpec) -> None:
        self._boxes = sorted(spec.boxes)
        names = [*self._boxes, *sorted(spec.supports), *sorted(spec.areas)]
        self._number = {name: number for number, name in enumerate(names)}
        self._support = np.array([self._number[spec.support_of(name)] for name in names])
        self._areas = np.array([self._number[name] for name in spec.areas], dtype=np.intp)
        self._sizes = np.array([spec.boxes[name].size for name in self._boxes])
        supports = [spec.supports[spec.support_of(name)] for name in names[len(self._boxes) :]]
        self._support_sizes = np.array([support.size for support in supports])
        from ictamp_drake.robots.robot import find_robot  # noqa: PLC0415  (loads Drake, and no help needs it)

        self._robot = find_robot(spec.robot)
        self._X_BW = np.linalg.inv(to_matrices(spec.arm.X_WB))
        self._X_BS = self._X_BW @ to_matrices(np.array([support.X_WT for support in supports]))
        for name, area in spec.areas.items():
            number = self._number[name] - len(self._boxes)
            self._support_sizes[number, :2] = area.size
            self._X_BS[number] = self._X_BS[number] @ to_matrices(area.X_TR)
        self._X_BS[:, :3, 3] -= self._X_BS[:, :3, 2] * self._support_sizes[:, 2:] / 2

    def observe(self, c: Configuration, action: Action) -> Observation:
        """The matrix of one option, shape (8, D), and its mask, shape (8,)."""
        matrix, mask = self.observe_all([(c, action)])
        return Observation(matrix[0], mask[0])

    def observe_all(self, options: Sequence[tuple[Configuration, Action]]) -> Observation:
        """The matrices of n options, shape (n, 8, D), and their masks, shape (n, 8), in one go."""
        if not options:
            return Observation(np.zeros((0, ROWS, SCHEMA.width), np.float32), np.zeros((0, ROWS), bool))
        return self.see(self.situations([c for c, _ in options]), self.steps([action for _, action in options]))

    def situations(self, configurations: Sequence[Configuration]) -> Situations:
        """Poses of all objects and of the hand in each configuration."""
        distinct = {c: number for number, c in enumerate(dict.fromkeys(configurations))}
        poses = np.array([[c.poses[name] for name in self._boxes] for c in distinct])
        X_WU, sizes, upright = upright_frames(to_matrices(poses), self._sizes)
        count, supports = len(distinct), len(self._X_BS)
        found = Situations(
            np.concatenate([self._X_BW @ X_WU, np.broadcast_to(self._X_BS, (count, supports, 4, 4))], axis=1),
            np.concatenate([sizes, np.broadcast_to(self._support_sizes, (count, supports, 3))], axis=1),
            np.concatenate([~upright, np.zeros((count, supports), bool)], axis=1),
            self._robot.forward(np.array([c.q for c in distinct])),
            np.array([ABSENT if c.held is None else self._number[c.held] for c in distinct]),
        )
        return found.select(np.array([distinct[c] for c in configurations]))

    def steps(self, actions: Sequence[Action]) -> Steps:
        """The actions in numbers."""
        box, place = np.array([[self._number[name] for name in action.args] for action in actions]).T
        return Steps(np.array([action.name == "pick" for action in actions]), box, place)

    def measure_moved_box(self, options: Sequence[tuple[Configuration, Action]], X_WO: FloatArray) -> FloatArray:
        """(x, y, z, yaw) of U of each action's box in the target frame K of c, when it is at X_WO afterwards.

        How far it is tilted against K is left out.

        Args:
            options: Configurations and actions, n of them.
            X_WO: Poses of the action's boxes afterwards, shape (n, 7).

        Returns:
            Shape (n, 4) [m, rad].
        """
        steps = self.steps([action for _, action in options])
        X_BK = self.situations([c for c, _ in options]).targets(steps)
        X_WU, _, _ = upright_frames(to_matrices(X_WO), self._sizes[steps.box])
        X_KU = inverse(X_BK) @ self._X_BW @ X_WU
        return np.column_stack([X_KU[:, :3, 3], np.arctan2(X_KU[:, 1, 0], X_KU[:, 0, 0])])

    def see(self, situations: Situations, steps: Steps) -> Observation:
        """The matrices of n situations, actual or imagined, and actions."""
        picks, box, place = steps
        held = np.where(picks & (situations.held == box), ABSENT, situations.held)
        first = np.stack([np.where(picks, box, ABSENT), np.where(picks, held, box), place], axis=1)
        order = situations.nearest(self._hidden(first, place), box, place)
        rows = np.concatenate([first, order, np.full((len(first), ROWS), ABSENT)], axis=1)[:, :ROWS]
        return self._observation(situations, rows, situations.targets(steps))

    def _hidden(self, first: Numbers, place: Numbers) -> Numbers:
        """Return the objects that no further row shows: those of the first rows, the place's support, and all areas.

        So a region or pose is seen only as the place of an action, and there it takes the place of its support.
        """
        areas = np.broadcast_to(self._areas, (len(first), len(self._areas)))
        return np.concatenate([first, self._support[place][:, None], areas], axis=1)

    def _observation(self, situations: Situations, rows: Numbers, X_BK: FloatArray) -> Observation:
        mask = rows != ABSENT
        (option, row), number = np.nonzero(mask), rows[mask]
        X_BU, sizes = situations.X_BU[option, number], situations.sizes[option, number]
        support, held = number >= len(self._boxes), row == 1
        values = np.zeros((len(number), SCHEMA.width))
        values[:, _BASE] = flat(X_BU)
        values[:, _TARGET] = flat(inverse(X_BK)[option] @ X_BU)
        values[~support, _BOX] = sizes[~support]
        values[support, _SUPPORT] = sizes[support]
        values[:, _IS_SUPPORT] = support
        values[:, _IS_TIPPED] = situations.tipped[option, number]
        values[np.arange(len(values)), np.take(_ROLE, np.minimum(row, 3))] = 1.0
        values[held, _HAND] = flat(inverse(situations.X_BG)[option[held]] @ X_BU[held])
        matrix = np.zeros((*mask.shape, SCHEMA.width), dtype=np.float32)
        matrix[mask] = values
        return Observation(matrix, mask)
