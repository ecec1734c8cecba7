"""SDF of a Schunk WSG 50 with its standard fingers, written from published numbers.

Outline and mass of the body are those of Schunk's product data of the WSG 050-110; stroke, force and speed those of its
assembly and operating manual (389474). The fingers' outline follows the drawing of the standard finger in Schunk's
catalog, with simpler shapes; their mass is that of these shapes in aluminum.
"""

import math
from collections.abc import Iterable

from ictamp_drake.models import contact
from ictamp_drake.models.contact import CONTACT_RADIUS, PAD_CONTACT_PROUD
from ictamp_drake.models.sdf_text import Color, Inertial, Shape, collision, document, element, inertial, pose, visual
from tools.sdf_parts import Pair, axis, collision_filter, frame, joint, limit, mimic

STROKE = 0.055
"""Stroke of each finger [m]."""
FORCE = 80.0
"""Largest force of each finger [N]."""
SPEED = 0.42
"""Largest speed of each finger [m/s]."""
DAMPING = 5.0
"""Viscous friction of the fingers, not published [N s/m]."""

BODY = (0.05, 0.146, 0.0725)
"""Sides of the body: thickness, along the fingers' motion, and from the mounting face to the fingers [m]."""
BODY_MASS = 1.2
"""Mass of the gripper without fingers [kg]."""
ADAPTER = (0.0315, 0.02)
"""Radius and thickness of the plate between the flange and the body [m]."""

FINGER_LENGTH = 0.082
FINGER_DEPTH = 0.015
"""Thickness of the finger behind the gripping face [m]."""
PAD = (0.02, 0.02)
"""Width and height of the gripping face [m]."""
PAD_HEIGHT = FINGER_LENGTH - PAD[1] / 2
"""Height of its center above the finger's root [m]."""
ALUMINUM = 2700.0
"""Density [kg/m^3]."""

GREY: Color = (0.62, 0.63, 0.65)
DARK: Color = (0.2, 0.2, 0.21)

LINKS = ("wsg_body", "wsg_left_finger", "wsg_right_finger")
JOINTS = ("wsg_left_joint", "wsg_right_joint")

BODY_SHAPES = (
    Shape("body", "box", BODY, (0.0, 0.0, BODY[2] / 2)),
    Shape("adapter", "cylinder", ADAPTER, (0.0, 0.0, -ADAPTER[1] / 2)),
)


def _slab(name: str, width: float, back: float, bottom: float, top: float) -> Shape:
    """A piece of the finger, from 3 mm behind the gripping face to its back."""
    center = (0.0, round((0.003 + back) / 2, 5), round((bottom + top) / 2, 5))
    return Shape(name, "box", (width, round(back - 0.003, 4), round(top - bottom, 4)), center)


FINGER_SHAPES = (
    _slab("root", 0.03, 0.023, 0.0, 0.041),
    _slab("stem", 0.02, 0.0175, 0.041, FINGER_LENGTH - PAD[1]),
)
PAD_SHAPE = Shape("pad", "box", (PAD[0], FINGER_DEPTH, PAD[1]), (0.0, FINGER_DEPTH / 2, PAD_HEIGHT))
PAD_CONTACTS = tuple(
    Shape(
        f"pad_contact_{2 * i + j}",
        "sphere",
        (CONTACT_RADIUS,),
        (
            x * (PAD[0] / 2 - CONTACT_RADIUS),
            CONTACT_RADIUS - PAD_CONTACT_PROUD,
            PAD_HEIGHT + z * (PAD[1] / 2 - CONTACT_RADIUS),
        ),
    )
    for i, x in enumerate((-1.0, 1.0))
    for j, z in enumerate((-1.0, 1.0))
)


def _box_inertia(mass: float, size: tuple[float, ...]) -> tuple[float, float, float]:
    x, y, z = (side**2 for side in size)
    return mass / 12 * (y + z), mass / 12 * (x + z), mass / 12 * (x + y)


def _body() -> str:
    center = (0.0, 0.0, BODY[2] / 2)
    value = Inertial(BODY_MASS, center, (*_box_inertia(BODY_MASS, BODY), 0.0, 0.0, 0.0))
    children = [
        inertial(value),
        *(collision(shape, contact.BODY) for shape in BODY_SHAPES),
        *(visual(shape, color) for shape, color in zip(BODY_SHAPES, (GREY, DARK), strict=True)),
        visual(Shape("rail", "box", (0.03, 0.14, 0.003), (0.0, 0.0, BODY[2])), DARK),
    ]
    return element("link", children, name=LINKS[0])


def finger_inertial() -> Inertial:
    """The inertia of an aluminum finger: that of its pieces."""
    pieces = [(math.prod(shape.size) * ALUMINUM, shape) for shape in (*FINGER_SHAPES, PAD_SHAPE)]
    mass = sum(piece for piece, _ in pieces)
    y, z = (sum(piece * shape.xyz[i] for piece, shape in pieces) / mass for i in (1, 2))
    xx = yy = zz = yz = 0.0
    for piece, shape in pieces:
        dy, dz = shape.xyz[1] - y, shape.xyz[2] - z
        own = _box_inertia(piece, shape.size)
        xx, yy, zz = xx + own[0] + piece * (dy**2 + dz**2), yy + own[1] + piece * dz**2, zz + own[2] + piece * dy**2
        yz -= piece * dy * dz
    xx, yy, zz, yz = (round(value, 8) for value in (xx, yy, zz, yz))
    return Inertial(round(mass, 4), (0.0, round(y, 4), round(z, 4)), (xx, yy, zz, 0.0, 0.0, yz))


def _finger(name: str, yaw: float) -> str:
    children = [
        pose((0.0, 0.0, BODY[2]), (0.0, 0.0, yaw), LINKS[0]),
        inertial(finger_inertial()),
        *(collision(shape, contact.BODY) for shape in FINGER_SHAPES),
        *(collision(shape, contact.PAD) for shape in (PAD_SHAPE, *PAD_CONTACTS)),
        *(visual(shape, DARK) for shape in (*FINGER_SHAPES, PAD_SHAPE)),
    ]
    return element("link", children, name=name)


def _finger_joint(name: str, child: str, *inside: str) -> str:
    along_y = axis((0, 1, 0), limit(0.0, STROKE, SPEED, FORCE), DAMPING)
    return joint(name, "prismatic", LINKS[0], child, along_y, *inside)


def wsg_sdf(ignored_pairs: Iterable[Pair]) -> str:
    """The model `wsg50`: base wsg_body, its origin on the body's mounting face; frame `grasp` (G) between the pads.

    The fingers' gripping faces are the planes y = 0 of their frames, and meet at the joints' zero.

    Args:
        ignored_pairs: Links that are never tested for collision with each other.
    """
    first, second = JOINTS
    children = [
        _body(),
        frame("grasp", LINKS[0], BODY[2] + PAD_HEIGHT),
        _finger(LINKS[1], 0.0),
        _finger(LINKS[2], math.pi),
        _finger_joint(first, LINKS[1]),
        _finger_joint(second, LINKS[2], mimic(first)),
        *collision_filter(LINKS, ignored_pairs),
    ]
    return document(element("model", children, name="wsg50"))
