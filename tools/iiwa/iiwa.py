"""SDF of a KUKA LBR iiwa 14 R820, written from published numbers.

Lengths, ranges of the axes, speeds, torques and the weight of 29.9 kg are those of KUKA's brochure "Sensitive robotics:
LBR iiwa" (technical data of the LBR iiwa 14 R820). KUKA publishes no masses of links. Masses and centers of mass are
those of Lachner, Nah, Stramigioli and Hogan, "Exp[licit]: An Educational Robot Modeling Software based on Exponential
Maps", 2022 (documentation, page "Kuka LBR iiwa14"); the base has the rest of the weight. The moments of inertia given
there belong to no rigid body (link 3), so inertias are computed: those of the links' visible bodies, filled evenly.
"""

import math
from collections.abc import Iterable
from typing import NamedTuple

import numpy as np

from ictamp_drake.core.types import FloatArray
from ictamp_drake.models import contact
from ictamp_drake.models.sdf_text import Inertial, collision, document, element, inertial, mesh_visual, pose, visual
from tools.iiwa import iiwa_collision
from tools.iiwa.iiwa_visual import LOOKS, Look
from tools.sdf_parts import Pair, axis, collision_filter, joint, limit

Vector = tuple[float, float, float]


class Joint(NamedTuple):
    """A joint of the upright arm.

    Attributes:
        height: Height of the joint's and the next link's origin above the base [m].
        axis: Axis along the base's axes, for positive turns as on the real arm.
        reach: Largest angle to both sides [deg].
        speed: Largest speed [deg/s].
        torque: Largest torque [Nm].
    """

    height: float
    axis: tuple[int, int, int]
    reach: float
    speed: float
    torque: float


SHOULDER = 0.36
ELBOW = SHOULDER + 0.42
WRIST = ELBOW + 0.4
FLANGE = WRIST + 0.126
"""Heights of the centers of shoulder, elbow and wrist, and of the flange's face [m]."""

JOINTS = (
    Joint(SHOULDER, (0, 0, 1), 170, 85, 320),
    Joint(SHOULDER, (0, 1, 0), 120, 85, 320),
    Joint(ELBOW, (0, 0, 1), 170, 100, 176),
    Joint(ELBOW, (0, -1, 0), 120, 75, 176),
    Joint(WRIST, (0, 0, 1), 170, 130, 110),
    Joint(WRIST, (0, 1, 0), 120, 135, 40),
    Joint(FLANGE, (0, 0, 1), 175, 135, 40),
)
"""Joints from the base to the flange. The origin of the last link is the middle of the flange's face."""
DAMPING = 0.5
"""Viscous friction of the joints, not published [Nm s/rad]."""

WEIGHT = 29.9
"""Mass of the arm [kg]."""
MASSES: tuple[tuple[float, Vector], ...] = (
    (6.404, (0.0, -0.014, 0.2545)),
    (7.89, (0.0, 0.003, 0.424)),
    (2.54, (0.0, 0.019, 0.6905)),
    (4.82, (0.0, -0.009, 0.866)),
    (1.76, (0.0, -0.013, 1.0585)),
    (2.5, (0.0, -0.002, 1.196)),
    (0.42, (0.0, 0.0, 1.2706)),
)
"""Mass [kg] and center of mass of each moving link, in the base's frame when the arm stands upright [m]."""

LINKS = tuple(f"iiwa_link_{number}" for number in range(len(JOINTS) + 1))

_GRID = 0.004
"""Side of the cells in which the inertia is summed up [m]."""


def _filled(look: Look) -> tuple[FloatArray, FloatArray]:
    """Center of the evenly filled body [m], and its inertia about it for a mass of 1 kg, shapes (3,) and (3, 3)."""
    cells = [np.arange(low // _GRID, high // _GRID + 1) for low, high in zip(look.lower, look.upper, strict=True)]
    axes = [(numbers + 0.5) * _GRID for numbers in cells]
    points = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1).reshape(-1, 3)
    points = points[look.body(points) < 0.0]
    center = points.mean(axis=0)
    covariance = np.cov(points.T, bias=True) + _GRID**2 / 12 * np.eye(3)
    return center, np.trace(covariance) * np.eye(3) - covariance


def _inertial(number: int) -> Inertial:
    center, unit = _filled(LOOKS[number])
    if number == 0:
        mass = round(WEIGHT - sum(mass for mass, _ in MASSES), 3)
        x, y, z = (round(float(value), 3) for value in center)
    else:
        mass, (x, y, z) = MASSES[number - 1]
        z = round(z - JOINTS[number - 1].height, 4)
    xx, yy, zz, xy, xz, yz = (
        round(mass * float(unit[row]), 5) for row in ((0, 0), (1, 1), (2, 2), (0, 1), (0, 2), (1, 2))
    )
    return Inertial(mass, (x, y, z), (xx, yy, zz, xy, xz, yz))


def _link(number: int) -> str:
    height = JOINTS[number - 1].height if number else 0.0
    children = [pose((0.0, 0.0, height)), inertial(_inertial(number))]
    children += [collision(shape, contact.BODY) for shape in iiwa_collision.LINKS[number]]
    children += [visual(accent, color) for accent, color in LOOKS[number].accents]
    children.append(mesh_visual(f"package://ictamp_drake/sdf/iiwa_link_{number}.gltf"))
    return element("link", children, name=LINKS[number])


def _joint(number: int) -> str:
    of = JOINTS[number - 1]
    reach, speed = math.radians(of.reach), math.radians(of.speed)
    about = axis(of.axis, limit(-reach, reach, speed, of.torque), DAMPING)
    return joint(f"iiwa_joint_{number}", "revolute", LINKS[number - 1], LINKS[number], about)


def iiwa_sdf(ignored_pairs: Iterable[Pair]) -> str:
    """The model `iiwa14`: base link iiwa_link_0, flange iiwa_link_7.

    Args:
        ignored_pairs: Links that are never tested for collision with each other.
    """
    links = [_link(number) for number in range(len(LINKS))]
    joints = [_joint(number) for number in range(1, len(LINKS))]
    return document(element("model", [*links, *joints, *collision_filter(LINKS, ignored_pairs)], name="iiwa14"))
