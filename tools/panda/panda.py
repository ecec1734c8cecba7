"""SDF of a Franka Emika Panda with its hand, written from the published numbers."""

import math
from collections.abc import Iterable

from ictamp_drake.models import contact
from ictamp_drake.models import panda as published
from ictamp_drake.models.panda import JointLimits
from ictamp_drake.models.sdf_text import collision, document, element, inertial, mesh_visual, numbers, pose, visual
from tools.panda import panda_collision, panda_visual

Pair = tuple[str, str]
"""Names of two links."""


def _limit(lower: float, upper: float, velocity: float, effort: float, acceleration: float | None = None) -> str:
    values = {"lower": lower, "upper": upper, "effort": effort, "velocity": velocity}
    inside = [f"<{tag}>{numbers((value,))}</{tag}>" for tag, value in values.items()]
    if acceleration is not None:
        inside.append(f"<drake:acceleration>{numbers((acceleration,))}</drake:acceleration>")
    return element("limit", inside)


def _axis(xyz: tuple[int, int, int], limit: str, damping: float) -> str:
    dynamics = f"<dynamics><damping>{numbers((damping,))}</damping></dynamics>"
    return element("axis", [f"<xyz>{numbers(xyz)}</xyz>", limit, dynamics])


def _arm_joint(number: int, limits: JointLimits) -> str:
    limit = _limit(limits.lower, limits.upper, limits.velocity, limits.effort, limits.acceleration)
    children = [
        f"<parent>panda_link{number - 1}</parent>",
        f"<child>panda_link{number}</child>",
        _axis((0, 0, 1), limit, published.JOINT_DAMPING),
    ]
    return element("joint", children, name=f"panda_joint{number}", type="revolute")


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


def _finger_joint(name: str, child: str, mimic: str) -> str:
    limit = _limit(0.0, published.MAX_OPENING / 2, published.MAX_FINGER_SPEED, published.MAX_GRIP_FORCE)
    axis = _axis((0, 1, 0), limit, published.FINGER_DAMPING)
    children = ["<parent>panda_hand</parent>", f"<child>{child}</child>", axis, mimic]
    return element("joint", children, name=name, type="prismatic")


def _collision_filter(ignored_pairs: Iterable[Pair]) -> list[str]:
    others: dict[str, list[str]] = {name: [] for name in published.INERTIALS}
    for first, second in ignored_pairs:
        others[first].append(second)
    return [
        element(
            "drake:collision_filter_group",
            [
                f"<drake:member>{name}</drake:member>",
                *(
                    f"<drake:ignored_collision_filter_group>only_{n}</drake:ignored_collision_filter_group>"
                    for n in names
                ),
            ],
            name=f"only_{name}",
        )
        for name, names in others.items()
    ]


def _frame(name: str, attached_to: str, z: float) -> str:
    return element("frame", [pose((0.0, 0.0, z))], name=name, attached_to=attached_to)


def _arm() -> list[str]:
    links = [_link(f"panda_link{i}", _arm_link_pose(i)) for i in range(8)]
    joints = [_arm_joint(number, limits) for number, limits in enumerate(published.ARM_LIMITS, start=1)]
    return [*links, *joints, _frame("panda_link8", "panda_link7", published.FLANGE_OFFSET)]


def _hand() -> list[str]:
    fixed = "<parent>panda_link7</parent><child>panda_hand</child>"
    first, second = published.FINGER_JOINTS
    mimic = element("drake:mimic", [], joint=first, multiplier="1", offset="0")
    return [
        _link("panda_hand", pose((0.0, 0.0, 0.0), (0.0, 0.0, published.HAND_ANGLE), "panda_link8")),
        element("joint", [fixed], name="panda_hand_joint", type="fixed"),
        _frame("grasp", "panda_hand", published.GRASP_OFFSET),
        _finger("panda_leftfinger", 0.0),
        _finger("panda_rightfinger", math.pi),
        _finger_joint(first, "panda_leftfinger", ""),
        _finger_joint(second, "panda_rightfinger", mimic),
    ]


def panda_sdf(ignored_pairs: Iterable[Pair]) -> str:
    """The model `panda`: base link panda_link0, flange frame panda_link8, frame `grasp` (G) between the pads.

    Args:
        ignored_pairs: Links that are never tested for collision with each other.
    """
    return document(element("model", [*_arm(), *_hand(), *_collision_filter(ignored_pairs)], name="panda"))
