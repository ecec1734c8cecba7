"""Descriptions in plan.yaml of robot, contact and bodies, which follow from the scene, and of a configuration."""

from typing import Any

import numpy as np
from pydrake.math import RigidTransform, RollPitchYaw

from ictamp_drake.core.types import Configuration, GripperCommand, State
from ictamp_drake.models.contact import BODY, PAD, SUPPORT
from ictamp_drake.models.sdf_text import Shape
from ictamp_drake.models.shapes import support_shapes
from ictamp_drake.robots.gripper import Gripper
from ictamp_drake.robots.robot import find_robot
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.tamp.plan_origin import Timing
from ictamp_drake.world.commands import FORCE_RAMP
from ictamp_drake.world.poses import to_pose, to_transform

_LIMITS = ("lower", "upper", "velocity", "acceleration", "jerk", "effort")

UNITS = {
    "length": "m",
    "angle": "rad",
    "angle in scene": "deg",
    "time": "s",
    "mass": "kg",
    "force": "N",
    "torque": "N m",
}


def describe_robot(spec: SceneSpec, timing: Timing | None) -> dict[str, Any]:
    """Return names, limits and place of the arm, and geometry and limits of its hand."""
    robot = find_robot(spec.robot)
    gripper, joints = robot.gripper, []
    for number, name in enumerate(robot.joints):
        limits = {key: float(getattr(robot, key)[number]) for key in _LIMITS}
        fractions = {} if timing is None else vars(timing)
        used = {key: fraction * limits[key] for key, fraction in fractions.items()}
        joints.append({"name": name, **limits, "timed_for": used or None})
    return {
        "name": robot.spec.description or robot.name,
        "base": spec.arm.X_WB.tolist(),
        "joints": joints,
        "flange": robot.spec.flange,
        "gripper": {
            "name": gripper.spec.description,
            "type": "parallel" if gripper.shares is not None else "linkage",
            "joints": list(gripper.joints),
            "max_width": gripper.opening,
            "max_force": gripper.force,
            "finger_speed": gripper.speed,
            "force_ramp": FORCE_RAMP,
            "grasp_frame": to_pose(robot.X_FG).tolist(),
            "pads": [_describe_pad(gripper, finger) for finger in (0, 1)],
            **({} if gripper.shares is not None else {"travel": _describe_travel(gripper)}),
        },
    }


def _describe_pad(gripper: Gripper, finger: int) -> dict[str, Any]:
    side, joint = (1.0, -1.0)[finger], gripper.joints[gripper.movers[finger]]
    x, y, z = gripper.spec.pads.size
    shape = Shape("pad", "box", (x, y, z), (0.0, side * y / 2, gripper.rise(0.0)))
    return {"joint": joint, "opens_along": [0.0, side, 0.0], "shapes": [_describe_shape(shape)]}


def _describe_travel(gripper: Gripper) -> dict[str, Any]:
    """Return positions of the joints, and of the pads along G's z axis, at some widths."""
    widths = np.linspace(0.0, gripper.opening, 11)
    return {
        "widths": widths.tolist(),
        "positions": [gripper.positions(width).tolist() for width in widths],
        "rises": [gripper.rise(width) for width in widths],
    }


def describe_contact() -> dict[str, Any]:
    """Return the coefficients of friction that are not a body's own, and the rule that combines two of them."""
    friction = {"pads": PAD.friction, "robot": BODY.friction}
    return {"friction_of_a_pair": "2 a b / (a + b)", "friction": friction}


def describe_bodies(spec: SceneSpec) -> dict[str, Any]:
    """Return mass, friction and shapes of supports and boxes by name; supports with their poses in W and B."""
    X_BW = to_transform(spec.arm.X_WB).inverse()
    bodies: dict[str, Any] = {}
    for name, support in sorted(spec.supports.items()):
        x, y, z = support.size
        bodies[name] = {
            "moves": False,
            "pose": support.X_WT.tolist(),
            "pose_in_base": to_pose(X_BW @ to_transform(support.X_WT)).tolist(),
            "friction": SUPPORT.friction,
            "shapes": [_describe_shape(shape) for shape in support_shapes(support.kind, (x, y, z))],
        }
    for name, box in sorted(spec.boxes.items()):
        shape = Shape("body", "box", box.size)
        mass = {"mass": box.mass, "center_of_mass": [0.0, 0.0, 0.0], "friction": box.friction}
        bodies[name] = {"moves": True, **mass, "shapes": [_describe_shape(shape)]}
    return bodies


def _describe_shape(shape: Shape) -> dict[str, Any]:
    pose = to_pose(RigidTransform(RollPitchYaw(*shape.rpy), np.array(shape.xyz)))
    return {"kind": shape.kind, "size": list(shape.size), "pose": pose.tolist()}


def describe_configuration(spec: SceneSpec, c: Configuration, atoms: State) -> dict[str, Any]:
    """Return positions of joints and bodies, the hand's width, what it holds, and the atoms that hold."""
    X_BW = to_transform(spec.arm.X_WB).inverse()
    return {
        "q": [*c.q.tolist(), *c.fingers.tolist()],
        "width": find_robot(spec.robot).gripper.width(c.fingers),
        "held": c.held,
        "load": _describe_load(spec, c),
        "poses": {name: pose.tolist() for name, pose in c.poses.items()},
        "poses_in_base": {name: to_pose(X_BW @ to_transform(pose)).tolist() for name, pose in c.poses.items()},
        "atoms": sorted(map(str, atoms)),
    }


def _describe_load(spec: SceneSpec, c: Configuration) -> dict[str, Any] | None:
    """Return mass, sides and pose in the flange's frame of the held box; None when nothing is held."""
    if c.held is None:
        return None
    box = spec.boxes[c.held]
    robot = find_robot(spec.robot)
    X_WF = to_transform(spec.arm.X_WB) @ RigidTransform(robot.forward(c.q[None])[0]) @ robot.X_FG.inverse()
    X_FO = X_WF.inverse() @ to_transform(c.poses[c.held])
    return {"body": c.held, "mass": box.mass, "extent": list(box.size), "pose_in_flange": to_pose(X_FO).tolist()}


def describe_command(gripper: GripperCommand) -> dict[str, float]:
    """Return a command to the hand."""
    return {"width": float(gripper.width), "force": float(gripper.force)}
