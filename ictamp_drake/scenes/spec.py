"""A scene as frozen dataclasses, and its YAML file.

Angles are in degrees in the file and in the specs, since people write them. Poses (`X_W…`) are core's arrays of seven.
The rooms `world` and `symbolic` check whether boxes overlap or float, and what the goal means.
"""

import dataclasses
from dataclasses import dataclass, field, replace
from functools import cached_property
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
from ictamp_drake.models.things import SUPPORTS, read_thing
from ictamp_drake.robots.spec import DEFAULT, is_robot_file, read_robot
from ictamp_drake.scenes.regions import Area, PoseSpec, RegionSpec, check_areas

if TYPE_CHECKING:
    from scipy.spatial.transform import Rotation

Vector = tuple[float, float, float]

SUPPORT_SIZES: dict[str, Vector] = {kind: read_thing(kind).size for kind in SUPPORTS}
"""Default size (x, y, z) of each kind of support [m]."""

SUPPORT_SIDES = {"table": 0.01, "rack": 0.03}
"""Shortest side of each kind of support [m]; a rack's legs and stabilizers need room."""

MAX_BYTES = 2**17
"""Size of the largest scene file that is read [bytes]."""

MAX_VALUES = 20_000
"""Maximum number of values in a scene file, ten times as many as the largest scene has."""

MAX_BOXES = 50
"""Maximum number of boxes; to prepare a scene of so many takes 2 s, and time grows with the square of their number."""

MAX_SUPPORTS = 20
"""Maximum number of supports."""

INTERFERENCES = ("stacked", "behind", "tipped")
"""Kinds of interference of boxes outside the goal (paper, Experiments)."""


@dataclass(frozen=True)
class ArmSpec:
    """Mounting pose of the arm.

    Attributes:
        position: Position of the base frame B in W [m].
        yaw: Rotation about W's z axis [deg].
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
        kind: Kind of support: table or rack.
        position: Center of the TOP face in W [m], the origin of the receptacle's frame T.
        yaw: Rotation about W's z axis [deg].
        size: Sides along x, y, z of T [m]. If empty, the kind's default is filled in.
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
    """A movable box.

    Attributes:
        size: Sides along x, y, z of the box's frame O [m].
        position: Center in W [m].
        rotation: Roll, pitch, yaw of O in W [deg]: R_WO = Rz(yaw) Ry(pitch) Rx(roll).
        mass: Mass [kg].
        friction: Coefficient of Coulomb friction, static and dynamic.
        color: Red, green, blue, each in [0, 1].
    """

    size: Vector
    position: Vector
    rotation: Vector = (0.0, 0.0, 0.0)
    mass: float = 0.1
    friction: float = 0.6
    color: Vector = (0.6, 0.6, 0.6)

    def __post_init__(self) -> None:
        check_vector("size", self.size, 0.008, 1, " m")
        check_vector("position", self.position, -10, 10, " m")
        check_vector("rotation", self.rotation, -360, 360, " deg")
        check_range("mass", self.mass, 0.001, 3, " kg")
        check_range("friction", self.friction, 0.05, 2)
        check_vector("color", self.color, 0, 1)

    @property
    def is_tipped(self) -> bool:
        """Whether its rotation makes it higher or lower."""
        return self.size[self._upright_axis] != self.size[2]

    @property
    def _upright_axis(self) -> int:
        return int(np.argmax(np.abs(_rotation(self.rotation).as_matrix()[2])))

    @property
    def width(self) -> float:
        """Shortest horizontal side [m]."""
        return min(side for axis, side in enumerate(self.size) if axis != self._upright_axis)

    @property
    def X_WO(self) -> FloatArray:
        """Pose of the box's center, shape (7,)."""
        return _pose(self.rotation, self.position)


@dataclass(frozen=True)
class StartSpec:
    """State of the arm when planning begins.

    Attributes:
        joints: Positions of the arm's joints, base first [rad]. If empty, the arm is in its home posture.
        held: Name of the box between the fingers, at its pose in `boxes`. If empty, the hand is open and empty.
    """

    joints: tuple[float, ...] = ()
    held: str = ""

    def __post_init__(self) -> None:
        check_vector("joints", self.joints, -100, 100, " rad", count=None)


@dataclass(frozen=True, kw_only=True)
class SceneSpec:
    """A complete planning problem.

    Attributes:
        robot: Name of a robot that ships, or the path of a robot file; in a scene file, a path relative to it.
        arm: Mounting pose of the arm.
        supports: Supports by name, at least one.
        boxes: Boxes by name, at least one.
        regions: Rectangles on supports, by name, that are places of their own.
        poses: Places on supports, by name, each for one box with its yaw.
        goal: PDDL formula, e.g. (and (on cyan_box rack) (on yellow_box cyan_box)).
        start: Posture of the arm at the beginning, and what it holds.
        seed: Random seed of the problem.
        interference: Kinds of interference of a packing problem. Empty in other scenes.
        description: One sentence for people.
    """

    robot: str = DEFAULT
    arm: ArmSpec = ArmSpec()
    supports: dict[str, SupportSpec]
    boxes: dict[str, BoxSpec]
    regions: dict[str, RegionSpec] = field(default_factory=dict)
    poses: dict[str, PoseSpec] = field(default_factory=dict)
    goal: str
    start: StartSpec = StartSpec()
    seed: int = 0
    interference: tuple[str, ...] = ()
    description: str = ""

    def __post_init__(self) -> None:
        for section, most in (("supports", MAX_SUPPORTS), ("boxes", MAX_BOXES)):
            if not getattr(self, section):
                raise IctampError(Code.EMPTY, "expected at least one", field=section)
            if (count := len(getattr(self, section))) > most:
                problem = f"expected at most {most}, got {{value}}"
                raise IctampError(Code.TOO_LARGE, problem, field=section, value=count)
        check_names(supports=self.supports, boxes=self.boxes, regions=self.regions, poses=self.poses)
        sizes = {name: support.size for name, support in self.supports.items()}
        check_areas({"regions": self.regions, "poses": self.poses}, sizes)
        if self.start.held:
            check_choice("start.held", self.start.held, self.boxes)
        if not self.goal.strip():
            problem = "expected a PDDL formula, e.g. (on red_box table), got {value}"
            raise IctampError(Code.EMPTY, problem, field="goal", value=self.goal)
        check_range("seed", self.seed, 0, 2**63 - 1)
        for kind in self.interference:
            check_choice("interference", kind, INTERFERENCES)

    @cached_property
    def areas(self) -> dict[str, Area]:
        """Regions and poses by name."""
        return {**self.regions, **self.poses}

    @cached_property
    def places(self) -> dict[str, SupportSpec | Area]:
        """Supports, regions and poses by name."""
        return {**self.supports, **self.areas}

    def support_of(self, place: str) -> str:
        """Return the support that a region or pose is on; any other name is returned unchanged."""
        return self.areas[place].on if place in self.areas else place


def load_scene(path: Path | str, robot: str | None = None) -> SceneSpec:
    """Read a scene file.

    Args:
        path: Scene file.
        robot: Robot that replaces that of the scene, see `replace_robot`.

    Raises:
        IctampError: The file cannot be read or is not a scene, with the line, the field and its value; or there is no
            such robot.
    """
    with in_file(path):
        spec = decode(SceneSpec, parse(read_text(path, MAX_BYTES), MAX_VALUES))
        spec = replace(spec, robot=locate_robot(spec.robot, Path(path).parent))
    if robot is not None:
        spec = replace_robot(spec, robot)
    with in_file(path):
        check_widths(spec)
    return spec


def check_widths(spec: SceneSpec) -> None:
    """Raise IctampError unless every box has a horizontal side that fits between the fingers of the robot."""
    widest = read_robot(spec.robot).gripper.max_side
    for name, box in spec.boxes.items():
        if box.width > widest:
            problem = f"expected a horizontal side of at most {widest:g} m for the gripper, got {{value}}"
            raise IctampError(Code.TOO_WIDE, problem, field=f"boxes.{name}.size", value=box.size)


def locate_robot(robot: str, folder: Path) -> str:
    """Return the name of a robot that ships unchanged, and the path of a robot file as seen from the folder."""
    return str(folder / robot) if is_robot_file(robot) else robot


def replace_robot(spec: SceneSpec, robot: str) -> SceneSpec:
    """Return the scene with another robot.

    Args:
        spec: Scene.
        robot: Name of a robot that ships, or the path of a robot file.

    Raises:
        IctampError: There is no such robot, or its file or models are not valid.
    """
    from ictamp_drake.robots.robot import find_robot  # noqa: PLC0415  (loads Drake, and no help needs it)

    name = locate_robot(robot, Path.cwd())
    find_robot(name)
    return replace(spec, robot=name)


def save_scene(spec: SceneSpec, path: Path | str) -> None:
    """Write a scene file that `load_scene` reads back exactly; it appears whole or not at all.

    Raises:
        IctampError: The file cannot be written.
    """
    write_whole(path, to_yaml(spec))


def to_dict(spec: SceneSpec) -> dict[str, Any]:
    """The scene in the types of YAML and JSON. `robot`, `start`, `regions` and `poses` are left out by default."""
    values: dict[str, Any] = _to_plain(dataclasses.asdict(spec))
    if spec.robot == DEFAULT:
        del values["robot"]
    else:
        values["robot"] = str(Path(spec.robot).resolve()) if is_robot_file(spec.robot) else spec.robot
    if spec.start == StartSpec():
        del values["start"]
    for section in ("regions", "poses"):
        if not values[section]:
            del values[section]
    return values


class _Dumper(yaml.SafeDumper):
    """PyYAML's safe dumper, which also quotes text with line breaks of Unicode; otherwise they are read as blanks."""

    def represent_str(self, text: str) -> yaml.ScalarNode:
        style = '"' if any(character in text for character in "\x85\u2028\u2029") else None
        return self.represent_scalar("tag:yaml.org,2002:str", text, style)


_Dumper.add_representer(str, _Dumper.represent_str)


def to_yaml(spec: SceneSpec) -> str:
    """Text of the scene's file."""
    text = yaml.dump(
        to_dict(spec), Dumper=_Dumper, sort_keys=False, default_flow_style=None, width=120, allow_unicode=True
    )
    return str(text)


def _to_plain(value: Any) -> Any:
    if isinstance(value, dict):
        return {key: _to_plain(item) for key, item in value.items()}
    if isinstance(value, tuple):
        return [_to_plain(item) for item in value]
    return value.item() if isinstance(value, np.generic) else value


def _pose(rotation: Vector, position: Vector) -> FloatArray:
    return np.concatenate([_rotation(rotation).as_quat(canonical=True, scalar_first=True), position])


def _rotation(rotation: Vector) -> "Rotation":
    from scipy.spatial.transform import Rotation  # noqa: PLC0415  (takes long to load, and no help needs it)

    return Rotation.from_euler("xyz", rotation, degrees=True)
