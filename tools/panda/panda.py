"""SDF of a Franka Emika Panda with its hand, written from the published numbers."""

import math
from collections.abc import Iterable

from ictamp_drake.models import contact
from ictamp_drake.models import panda as published
from ictamp_drake.models.panda import JointLimits
from ictamp_drake.models.sdf_text import collision, document, element, inertial, mesh_visual, pose, visual
from tools.panda import panda_collision, panda_visual
from tools.sdf_parts import Pair, axis, collision_filter, frame, joint, limit, mimic


def _arm_joint(number: int, limits: JointLimits) -> str:
    bounds = limit(limits.lower, limits.upper, limits.velocity, limits.effort, limits.acceleration)
    about_z = axis((0, 0, 1), bounds, published.JOINT_DAMPING)
    parent, child = f"panda_link{number - 1}", f"panda_link{number}"
    return joint(f"panda_joint{number}", "revolute", parent, child, about_z)


def _arm_link_pose(number: int) -> str:
    if number == 0:
        return ""
    a, d, alpha = published.DH_PARAMETERS[number - 1]
    xyz = (a, -d * math.sin(alpha), d * math.cos(alpha))
    return pose(xyz, (alpha, 0.0, 0.0), f"panda_link{number - 1}")


def _link(name: str, placement: str) -> str:
    shapes = panda_collision.LINKS[name]
    children = [placement, inertial(published.INERTIALS[name])]
    children += [collision(shape, contact.BODY) for shape in shapes]
    children += [visual(accent, color) for accent, color in panda_visual.LINKS[name].accents]
    children.append(mesh_visual(f"package://ictamp_drake/sdf/{name}.gltf"))
    return element("link", children, name=name)


def _finger(name: str, yaw: float) -> str:
    children = [
        pose((0.0, 0.0, published.FINGER_OFFSET), (0.0, 0.0, yaw), "panda_hand"),
        inertial(published.INERTIALS[name]),
        *(collision(shape, contact.BODY) for shape in panda_collision.FINGER),
        *(collision(shape, contact.PAD) for shape in (panda_collision.PAD, *panda_collision.PAD_CONTACTS)),
        *(visual(shape, panda_visual.DARK) for shape in (*panda_collision.FINGER, panda_collision.PAD)),
    ]
    return element("link", children, name=name)


def _finger_joint(name: str, child: str, *inside: str) -> str:
    bounds = limit(0.0, published.MAX_OPENING / 2, published.MAX_FINGER_SPEED, published.MAX_GRIP_FORCE)
    along_y = axis((0, 1, 0), bounds, published.FINGER_DAMPING)
    return joint(name, "prismatic", "panda_hand", child, along_y, *inside)


def _arm() -> list[str]:
    links = [_link(f"panda_link{i}", _arm_link_pose(i)) for i in range(8)]
    joints = [_arm_joint(number, limits) for number, limits in enumerate(published.ARM_LIMITS, start=1)]
    return [*links, *joints, frame("panda_link8", "panda_link7", published.FLANGE_OFFSET)]


def _hand() -> list[str]:
    first, second = published.FINGER_JOINTS
    return [
        _link("panda_hand", pose((0.0, 0.0, 0.0), (0.0, 0.0, published.HAND_ANGLE), "panda_link8")),
        joint("panda_hand_joint", "fixed", "panda_link7", "panda_hand"),
        frame("grasp", "panda_hand", published.GRASP_OFFSET),
        _finger("panda_leftfinger", 0.0),
        _finger("panda_rightfinger", math.pi),
        _finger_joint(first, "panda_leftfinger"),
        _finger_joint(second, "panda_rightfinger", mimic(first)),
    ]


def panda_sdf(ignored_pairs: Iterable[Pair]) -> str:
    """The model `panda`: base link panda_link0, flange frame panda_link8, frame `grasp` (G) between the pads.

    Args:
        ignored_pairs: Links that are never tested for collision with each other.
    """
    filters = collision_filter(published.INERTIALS, ignored_pairs)
    return document(element("model", [*_arm(), *_hand(), *filters], name="panda"))
