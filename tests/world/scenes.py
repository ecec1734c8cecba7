"""Small scenes for the tests of `world` and `skills`: boxes by name on a table with a rack, posed by hand."""

import numpy as np
from pydrake.math import RigidTransform, RollPitchYaw, RotationMatrix

from ictamp_drake.core.types import Configuration, FloatArray, GripperCommand, Segment
from ictamp_drake.scenes import levels
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, SupportSpec
from ictamp_drake.world.poses import to_pose, to_transform
from ictamp_drake.world.world import World

TABLE = SupportSpec("table", (0.3, 0.0, 0.0))
RACK = SupportSpec("rack", (0.44, -0.33, 0.16), yaw=90.0)
RACK_TOP = 0.16
SIZES = {name: levels.SIZES[name] for name in ("yellow_box", "red_box", "cyan_box", "blue_box")}


def box(
    name: str, position: tuple[float, float, float], rotation: tuple[float, float, float] = (0.0, 0.0, 0.0)
) -> BoxSpec:
    """A box of the packing problems, with its center at a position [m], turned by roll, pitch, yaw [deg]."""
    return BoxSpec(SIZES[name], position, rotation)


def scene(boxes: dict[str, BoxSpec]) -> SceneSpec:
    """Boxes on a table with a rack, without a relevant goal."""
    goal = f"(on {min(boxes)} table)"
    return SceneSpec(supports={"table": TABLE, "rack": RACK}, boxes=boxes, goal=goal)


def build_tower(
    *names: str, x: float = 0.5, y: float = 0.1, floor: float = 0.0, yaws: tuple[float, ...] = ()
) -> dict[str, BoxSpec]:
    """A tower of boxes, listed from the bottom up; its foot is at x, y on a floor of that height [m]; yaws in [deg]."""
    boxes = {}
    for name, yaw in zip(names, yaws or (0.0,) * len(names), strict=True):
        height = SIZES[name][2]
        boxes[name] = box(name, (x, y, floor + height / 2), (0.0, 0.0, yaw))
        floor += height
    return boxes


def pose(x: float, y: float, z: float, *, roll: float = 0.0, pitch: float = 0.0, yaw: float = 0.0) -> FloatArray:
    """Pose array of a position [m] and angles [deg]."""
    return to_pose(RigidTransform(RollPitchYaw(np.radians([roll, pitch, yaw])), [x, y, z]))


def arrange(world: World, poses: dict[str, FloatArray], held: str | None = None) -> Configuration:
    """The initial configuration, with some boxes moved."""
    c = world.initial_configuration()
    return Configuration(c.q, c.fingers, {**c.poses, **poses}, held, c.gripper)


def far_boxes() -> dict[str, BoxSpec]:
    """The four boxes, each alone on the table."""
    spots = {"yellow_box": 0.0, "red_box": 0.12, "cyan_box": 0.24, "blue_box": 0.36}
    return {name: box(name, (0.6, y, SIZES[name][2] / 2)) for name, y in spots.items()}


def stay(c: Configuration, duration: float, gripper: GripperCommand | None = None, label: str = "stay") -> Segment:
    """The arm stands still at its place in c while the hand obeys a command, by default that of c."""
    return Segment(label, duration, gripper or c.gripper, 1, np.array([0.0, duration]), c.q[None])


def way(label: str, q0: FloatArray, q1: FloatArray, duration: float, gripper: GripperCommand) -> Segment:
    """A smooth spline from rest at q0 to rest at q1, both of shape (7,) [rad]."""
    knots = np.repeat([0.0, duration], 6)
    return Segment(label, duration, gripper, 6, knots, np.array([q0, q0, q0, q1, q1, q1]))


def hold_box(world: World, box: str, roll: float = 0.0, drop: float = 0.0) -> Configuration:
    """The arm at home with the box between its fingers, `drop` [m] below the middle of the pads."""
    c = world.initial_configuration()
    world.set_configuration(c)
    X_WG = world.plant.GetFrameByName("grasp").CalcPoseInWorld(world.plant.GetMyContextFromRoot(world.context))
    R_DOWN = RotationMatrix.MakeXRotation(np.pi)
    X_GO = RigidTransform(R_DOWN.inverse() @ RotationMatrix.MakeXRotation(np.radians(roll)), [0.0, 0.0, drop])
    side = SIZES[box][1 if roll % 180 == 0 else 2]
    poses = {**c.poses, box: to_pose(X_WG @ X_GO)}
    return Configuration(c.q, np.full(2, side / 2), poses, box, GripperCommand(side, 30.0))


def p_GO(world: World, c: Configuration, name: str) -> FloatArray:
    """Position of a box's center in G [m]."""
    world.set_configuration(c)
    X_WG = world.plant.GetFrameByName("grasp").CalcPoseInWorld(world.plant.GetMyContextFromRoot(world.context))
    return np.asarray((X_WG.inverse() @ to_transform(c.poses[name])).translation())
