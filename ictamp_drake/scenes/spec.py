"""A scene as frozen dataclasses, and their YAML file.

Angles are degrees in the file and in the specs, since people write them; poses (`X_W…`) are core's arrays of seven.
Whether boxes overlap or float, and what the goal means, is checked in the rooms `world` and `symbolic`.
"""

import dataclasses
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import yaml

from ictamp_drake.core.checks import check_choice, check_names, check_range, check_vector
from ictamp_drake.core.decoding import decode
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.files import write_whole
from ictamp_drake.core.reading import in_file, parse, read_text
from ictamp_drake.core.types import FloatArray
from ictamp_drake.models.hand import MAX_SIDE
from ictamp_drake.models.things import SUPPORTS, read_thing

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

Vector = tuple[float, float, float]

SUPPORT_SIZES: dict[str, Vector] = {kind: read_thing(kind).size for kind in SUPPORTS}
"""Default size (x, y, z) of each kind of support [m]."""

SUPPORT_SIDES = {"table": 0.01, "rack": 0.03}
"""Shortest side of each kind of support [m]; a rack's legs and stabilisers need room."""

INTERFERENCES = ("stacked", "behind", "tipped")
"""Kinds of interference of boxes outside the goal (paper, Experiments)."""


@dataclass(frozen=True)
class ArmSpec:
    """Where the arm is mounted.

    Attributes:
        position: base frame B in W [m].
        yaw: about W's z axis [deg].
    """

    position: Vector = (0.0, 0.0, 0.0)
    yaw: float = 0.0

    def __post_init__(self) -> None:
        check_vector("position", self.position, -10, 10, " m")
        check_range("yaw", self.yaw, -360, 360, " deg")

    @property
    def X_WB(self) -> FloatArray:
        """Pose of the arm's base, shape (7,)."""
        return _pose((0.0, 0.0, self.yaw), self.position)


@dataclass(frozen=True)
class SupportSpec:
    """A table (a slab) or a rack (a plate on legs) that never moves.

    Attributes:
        kind: table or rack.
        position: centre of the TOP face in W [m], the origin of the receptacle's frame T.
        yaw: about W's z axis [deg].
        size: x, y, z in T [m]; empty for the kind's default, which is filled in.
    """

    kind: str
    position: Vector
    yaw: float = 0.0
    size: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        check_choice("kind", self.kind, SUPPORT_SIZES)
        object.__setattr__(self, "size", self.size or SUPPORT_SIZES[self.kind])
        check_vector("size", self.size, SUPPORT_SIDES[self.kind], 5, " m")
        check_vector("position", self.position, -10, 10, " m")
        check_range("yaw", self.yaw, -360, 360, " deg")

    @property
    def X_WT(self) -> FloatArray:
        """Pose of the top face's frame, shape (7,)."""
        return _pose((0.0, 0.0, self.yaw), self.position)


@dataclass(frozen=True)
class BoxSpec:
    """A box that can be moved.

    Attributes:
        size: x, y, z in the box's frame O [m].
        position: centre in W [m].
        rotation: roll, pitch, yaw of O in W [deg]: R_WO = Rz(yaw) Ry(pitch) Rx(roll).
        mass: [kg].
        friction: coefficient of Coulomb friction, static and dynamic.
        colour: red, green, blue, each in [0, 1].
    """

    size: Vector
    position: Vector
    rotation: Vector = (0.0, 0.0, 0.0)
    mass: float = 0.1
    friction: float = 0.6
    colour: Vector = (0.6, 0.6, 0.6)

    def __post_init__(self) -> None:
        check_vector("size", self.size, 0.008, 1, " m")
        check_vector("position", self.position, -10, 10, " m")
        check_vector("rotation", self.rotation, -360, 360, " deg")
        check_range("mass", self.mass, 0.001, 3, " kg")
        check_range("friction", self.friction, 0.05, 2)
        check_vector("colour", self.colour, 0, 1)
        self._check_width()

    def _check_width(self) -> None:
        upright = int(np.argmax(np.abs(_rotation(self.rotation).as_matrix()[2])))
        width = min(side for axis, side in enumerate(self.size) if axis != upright)
        if width > MAX_SIDE:
            problem = f"expected a horizontal side of at most {MAX_SIDE} m for the gripper, got {{value}}"
            raise IctampError(Code.TOO_WIDE, problem, field="size", value=self.size)

    @property
    def X_WO(self) -> FloatArray:
        """Pose of the box's centre, shape (7,)."""
        return _pose(self.rotation, self.position)


@dataclass(frozen=True)
class StartSpec:
    """How the arm stands when planning begins, and what it holds.

    Attributes:
        joints: positions of the arm's joints, base first [rad]; empty for the arm's home posture.
        held: name of the box between the fingers, where `boxes` says that it is; empty for an open, empty hand.
    """

    joints: tuple[float, ...] = ()
    held: str = ""

    def __post_init__(self) -> None:
        check_vector("joints", self.joints, -100, 100, " rad", count=None)


@dataclass(frozen=True, kw_only=True)
class SceneSpec:
    """Everything that a planning problem consists of.

    Attributes:
        arm: where the arm is mounted.
        supports: by name, at least one.
        boxes: by name, at least one.
        goal: PDDL formula, e.g. (and (on cyan_box rack) (on yellow_box cyan_box)).
        start: how the arm stands at the beginning, and what it holds.
        seed: of everything random in the problem.
        interference: kinds of interference of a packing problem; empty in other scenes.
        description: one sentence for people.
    """

    arm: ArmSpec = ArmSpec()
    supports: dict[str, SupportSpec]
    boxes: dict[str, BoxSpec]
    goal: str
    start: StartSpec = StartSpec()
    seed: int = 0
    interference: tuple[str, ...] = ()
    description: str = ""

    def __post_init__(self) -> None:
        for section in ("supports", "boxes"):
            if not getattr(self, section):
                raise IctampError(Code.EMPTY, "expected at least one", field=section)
        check_names(supports=self.supports, boxes=self.boxes)
        if self.start.held:
            check_choice("start.held", self.start.held, self.boxes)
        if not self.goal.strip():
            problem = "expected a PDDL formula, e.g. (on red_box table), got {value}"
            raise IctampError(Code.EMPTY, problem, field="goal", value=self.goal)
        check_range("seed", self.seed, 0, 2**63 - 1)
        for kind in self.interference:
            check_choice("interference", kind, INTERFERENCES)


def load_scene(path: Path | str) -> SceneSpec:
    """Read a scene file.

    Raises:
        IctampError: The file cannot be read or is not a scene, with the line, the field and its value.
    """
    with in_file(path):
        return decode(SceneSpec, parse(read_text(path)))


def save_scene(spec: SceneSpec, path: Path | str) -> None:
    """Write a scene file that `load_scene` reads back exactly; it appears whole or not at all.

    Raises:
        OSError: when the folder is not there or cannot be written.
    """
    write_whole(path, to_yaml(spec))


def to_dict(spec: SceneSpec) -> dict[str, Any]:
    """The scene in the types of YAML and JSON; `start` is left out where it says nothing."""
    values: dict[str, Any] = _to_plain(dataclasses.asdict(spec))
    if spec.start == StartSpec():
        del values["start"]
    return values


def to_yaml(spec: SceneSpec) -> str:
    """Text of the scene's file."""
    text = yaml.safe_dump(to_dict(spec), sort_keys=False, default_flow_style=None, width=120, allow_unicode=True)
    return str(text)


def _to_plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _to_plain(item) for key, item in value.items()}
    return list(value) if isinstance(value, tuple) else value


def _pose(rotation: Vector, position: Vector) -> FloatArray:
    return np.concatenate([_rotation(rotation).as_quat(canonical=True, scalar_first=True), position])


def _rotation(rotation: Vector) -> "Rotation":
    from scipy.spatial.transform import Rotation  # noqa: PLC0415  (takes long to load, and no help needs it)

    return Rotation.from_euler("xyz", rotation, degrees=True)
