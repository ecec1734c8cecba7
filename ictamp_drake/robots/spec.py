"""A robot as frozen dataclasses, and its YAML file.

Lengths are in meters, joint positions and their limits in radians (or meters), forces in newtons. Rotations of frames
are in degrees, as in scenes.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache
from pathlib import Path
from typing import Literal

from ictamp_drake.core.checks import POSITIVE, check_different, check_range, check_vector
from ictamp_drake.core.decoding import decode
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.reading import in_file, parse
from ictamp_drake.core.types import KinematicsKind
from ictamp_drake.robots.files import read_once

Vector = tuple[float, float, float]

FOLDER = Path(__file__).parents[1] / "models" / "robots"
"""Folder of the robots that ship."""
SHIPPED = tuple(sorted(path.stem for path in FOLDER.glob("*.yaml")))
"""Names of the robots that ship."""
DEFAULT = "panda"
"""Name of the robot of scenes that name none; policies, critics and P were trained with it."""

MAX_BYTES = 2**17
"""Size of the largest robot file that is read [bytes]."""
MAX_JOINTS = 20
"""Maximum number of joints of an arm."""

PLAY = 0.005
"""Play that the fingers need around a gripped box [m]."""

_SIZES = {"box": 3, "cylinder": 2, "capsule": 2, "sphere": 1}
"""Number of dimensions of each kind of shape."""


@dataclass(frozen=True, kw_only=True)
class FrameSpec:
    """A frame on a body.

    Attributes:
        frame: Body or frame of the model that it is fixed to.
        position: Position of its origin in that frame [m].
        rotation: Roll, pitch, yaw in that frame [deg].
    """

    frame: str
    position: Vector = (0.0, 0.0, 0.0)
    rotation: Vector = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        _check_pose(self.position, self.rotation)


@dataclass(frozen=True, kw_only=True)
class ShapeSpec:
    """A collision shape of a body.

    Attributes:
        kind: Kind of shape: box, cylinder, capsule or sphere.
        size: Sides (x, y, z), or radius and length, or radius, in the order of the kinds [m].
        position: Position of its center in the body [m].
        rotation: Roll, pitch, yaw in the body [deg].
    """

    kind: Literal["box", "cylinder", "capsule", "sphere"]
    size: tuple[float, ...]
    position: Vector = (0.0, 0.0, 0.0)
    rotation: Vector = (0.0, 0.0, 0.0)

    def __post_init__(self) -> None:
        if len(self.size) != _SIZES[self.kind]:
            problem = f"expected {_SIZES[self.kind]} numbers for a {self.kind}, got {{value}}"
            raise IctampError(Code.WRONG_LENGTH, problem, field="size", value=self.size)
        check_vector("size", self.size, POSITIVE, 10, " m", count=None)
        _check_pose(self.position, self.rotation)


@dataclass(frozen=True, kw_only=True)
class PadsSpec:
    """Pads of the fingers. x of each pad's frame is along the pad, y away from the other pad, and z as in G.

    Attributes:
        first: Frame in the center of the gripping face of the finger at positive y of G. The finger is the body that
            the frame is fixed to.
        second: Frame in the center of the gripping face of the other finger.
        size: Sides of each pad; the second is its thickness, behind the gripping face [m].
    """

    first: FrameSpec
    second: FrameSpec
    size: Vector

    def __post_init__(self) -> None:
        check_vector("size", self.size, 0.004, 0.2, " m")


Outline = tuple[float, float, float]
"""Half length along G's x, half width along G's y, and height of the lower face above G [m]."""


@dataclass(frozen=True, kw_only=True)
class OutlineSpec:
    """Bounds of the hand when it points down, for geometric sampling. All lengths are in m.

    Attributes:
        finger: Half length along G's x and half width along G's y of a finger, and height of its lower end above G.
        upper: Rows of upright cylinders along G's y that contain all parts of the hand above the fingers: the first and
            last axis, the radius, and the height of the lower faces above G.
        core: Cylinders about G's z axis inside the hand: radius, height of the lower and of the upper face above G.
        disk: Such a cylinder that the fingers partly fill at every height, whatever their opening; empty if unknown.
    """

    finger: Outline
    upper: tuple[tuple[float, ...], ...]
    core: tuple[tuple[float, ...], ...] = ()
    disk: tuple[float, ...] = ()

    def __post_init__(self) -> None:
        for name, rows, count in (("upper", self.upper, 4), ("core", self.core, 3)):
            for number, row in enumerate(rows):
                _check_length(f"{name}[{number}]", row, count)
        if self.disk:
            _check_length("disk", self.disk, 3)


@dataclass(frozen=True, kw_only=True)
class GripperSpec:
    """A gripper with two fingers.

    Attributes:
        description: Maker and type.
        model: SDF, URDF or MJCF file; empty when the arm's model contains the gripper. See `RobotSpec.model`.
        mount: Body or frame of the gripper's model that is fixed to the flange, and its pose there; not used without a
            model.
        base: Body that moves with a held object.
        grasp: Grasp frame G: between the pads, x along the pads, y along the motion of the fingers towards the first
            pad, and z out of the palm.
        joints: Driven joints. Joints that mimic them follow.
        opening: Largest distance between the pads [m].
        force: Largest continuous force of each finger [N].
        speed: Speed of each finger [m/s].
        pads: Pads.
        stiffness: Stiffness of the fingers' controllers, at the pads [N/m].
        damping: Damping of the fingers' controllers, at the pads [N s/m].
        joint_damping: Viscous friction of each joint of the fingers, in place of the model's [N s/m or N m s/rad].
            Without any, a held object creeps in simulation.
        collision: Collision shapes by body, in place of those of the model.
        outlines: Bounds of the hand; worked out from its shapes by default.
    """

    description: str = ""
    model: str = ""
    mount: FrameSpec | None = None
    base: str
    grasp: FrameSpec
    joints: tuple[str, ...]
    opening: float
    force: float
    speed: float
    pads: PadsSpec
    stiffness: float = 2000.0
    damping: float = 50.0
    joint_damping: float | None = None
    collision: dict[str, tuple[ShapeSpec, ...]] = field(default_factory=dict)
    outlines: OutlineSpec | None = None

    def __post_init__(self) -> None:
        _check_joints(self.joints)
        ranges = {"opening": (0.01, 1.0), "force": (1.0, 1e4), "speed": (1e-3, 10.0), "stiffness": (1.0, 1e9)}
        for name, (low, high) in ranges.items():
            check_range(name, getattr(self, name), low, high)
        for name in ("damping", "joint_damping"):
            if (value := getattr(self, name)) is not None:
                check_range(name, value, 0, 1e9)
        if self.model and self.mount is None:
            raise IctampError(Code.MISSING_FIELD, "missing field", field="mount")

    @property
    def max_side(self) -> float:
        """Widest side of a box that is gripped: the opening minus the play that the fingers need [m]."""
        return self.opening - PLAY


@dataclass(frozen=True, kw_only=True, eq=False)
class RobotSpec:
    """An arm with a gripper.

    Limits are those of the model. Limits given here replace them, except those of positions. One number serves
    all joints.

    Attributes:
        description: Maker and type.
        model: SDF, URDF or MJCF file: a path relative to the robot file, or package://NAME/…, where NAME is a package
            that Drake knows or an installed Python package.
        base: Body or frame that is fixed where the scene's `arm` stands.
        flange: Body or frame to which the gripper is fixed.
        joints: Revolute joints from the base to the flange.
        home: Comfortable posture, with the hand pointing down in front of the base [rad].
        velocity: Velocity limits [rad/s].
        acceleration: Acceleration limits [rad/s^2].
        jerk: Jerk limits [rad/s^3].
        effort: Torque limits [N m].
        stiffness: Stiffness of the joints' position controllers [N m/rad].
        damping: Damping of the joints' position controllers [N m s/rad].
        kinematics: Kind of inverse kinematics, see `robots.choice`.
        collision: Collision shapes by body, in place of those of the model.
        touching: Pairs of bodies that always touch, or never can, and are not tested. If None, pairs that touch in all
            of many random postures are not tested. A body of the gripper whose name the arm has, too, is gripper::NAME.
        gripper: Gripper.
    """

    description: str = ""
    model: str
    base: str
    flange: str
    joints: tuple[str, ...]
    home: tuple[float, ...]
    velocity: tuple[float, ...] = ()
    acceleration: tuple[float, ...] = ()
    jerk: tuple[float, ...] = ()
    effort: tuple[float, ...] = ()
    stiffness: tuple[float, ...]
    damping: tuple[float, ...]
    kinematics: KinematicsKind = "auto"
    collision: dict[str, tuple[ShapeSpec, ...]] = field(default_factory=dict)
    touching: tuple[tuple[str, str], ...] | None = None
    gripper: GripperSpec

    def __post_init__(self) -> None:
        _check_joints(self.joints)
        _check_length("home", self.home, len(self.joints))
        check_vector("home", self.home, -100, 100, " rad", count=None)
        for name in ("velocity", "acceleration", "jerk", "effort", "stiffness", "damping"):
            values = getattr(self, name)
            if len(values) == 1:
                object.__setattr__(self, name, values * len(self.joints))
            elif values or name in ("stiffness", "damping"):
                _check_length(name, values, len(self.joints))
            check_vector(name, values, 0 if name == "damping" else POSITIVE, 1e9, count=None)


def _check_pose(position: Vector, rotation: Vector) -> None:
    check_vector("position", position, -10, 10, " m")
    check_vector("rotation", rotation, -360, 360, " deg")


def _check_length(field: str, values: Sequence[object], count: int) -> None:
    if len(values) != count:
        problem = f"expected {count} numbers, got {{value}}"
        raise IctampError(Code.WRONG_LENGTH, problem, field=field, value=values)


def _check_joints(joints: Sequence[str]) -> None:
    if not joints:
        raise IctampError(Code.EMPTY, "expected at least one", field="joints")
    if len(joints) > MAX_JOINTS:
        raise IctampError(
            Code.TOO_LARGE, f"expected at most {MAX_JOINTS}, got {{value}}", field="joints", value=len(joints)
        )
    check_different("joints", joints)


def read_robot(name: str) -> RobotSpec:
    """Read the file of a robot that ships, or another one. A file that has not changed is decoded once.

    Args:
        name: Name of a robot that ships, or the path of a YAML file.

    Raises:
        IctampError: There is no such robot, or its file is not valid, with the line, the field and its value.
    """
    path = find_file(name)
    with in_file(path):
        return _decode(read_once(path, MAX_BYTES))


@lru_cache(maxsize=32)
def _decode(text: str) -> RobotSpec:
    return decode(RobotSpec, parse(text))


def find_file(name: str) -> Path:
    """Return the file of a robot that ships, or the path itself if it looks like one."""
    if name in SHIPPED:
        return FOLDER / f"{name}.yaml"
    if not is_robot_file(name):
        advice = "or give the path of a YAML file"
        raise IctampError(
            Code.UNKNOWN_CHOICE, "{value} is not a robot", field="robot", value=name, choices=SHIPPED, advice=advice
        )
    return Path(name)


def is_robot_file(robot: str) -> bool:
    """Whether it is the path of a robot file, and not the name of a robot that ships."""
    return robot.endswith((".yaml", ".yml"))
