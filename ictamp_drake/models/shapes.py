"""SDF of the things around the robot: boxes to move, and tables and racks to put them on.

A model's only link has the model's name, so that `plant.GetBodyByName(name)` finds it. Supports of any size have the
colors of the committed ones.
"""

from collections.abc import Sequence
from itertools import product
from math import inf

import numpy as np

from ictamp_drake.core.checks import POSITIVE, check_range
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.models.contact import CONTACT_RADIUS, OBJECT, SUPPORT
from ictamp_drake.models.sdf_text import Color, Inertial, Shape, collision, document, element, inertial, visual
from ictamp_drake.models.things import read_thing

Size = tuple[float, float, float]

RACK_THICKNESS = 0.01
"""Thickness of a rack's top plate, legs and stabilizers [m]."""

_EDGE_WIDTH = 0.003
_EDGE_DEPTH = 0.0003
_EDGE_DARKNESS = 0.6


def box_inertial(size: Size, mass: float) -> Inertial:
    """Inertia of a box of uniform density about its center."""
    xx, yy, zz = (value * value * mass / 12.0 for value in size)
    return Inertial(mass, (0.0, 0.0, 0.0), (yy + zz, xx + zz, xx + yy, 0.0, 0.0, 0.0))


def box_contacts(size: Size) -> tuple[Shape, ...]:
    """Spheres at the 8 corners and the middles of the 12 edges, each touching the faces from inside."""
    places = sorted((p for p in product((-1, 0, 1), repeat=3) if p.count(0) <= 1), key=lambda p: p.count(0))
    half = [value / 2 - CONTACT_RADIUS for value in size]
    return tuple(
        Shape(f"contact_{i}", "sphere", (CONTACT_RADIUS,), (x * half[0], y * half[1], z * half[2]))
        for i, (x, y, z) in enumerate(places)
    )


def rim_contacts(size: Sequence[float], spacing: float) -> tuple[Shape, ...]:
    """Spheres along the rim of a support's top face: at its corners, and at most `spacing` [m] apart between them.

    Each touches the top face and a side from inside. The origin is the center of the top face, and the size is in [m].
    """
    half = [value / 2 - CONTACT_RADIUS for value in size[:2]]
    x, y = (np.linspace(-h, h, 1 + int(np.ceil(2 * h / spacing))).tolist() for h in half)
    places = [*product(x, (-half[1], half[1])), *product((-half[0], half[0]), y[1:-1])]
    return tuple(
        Shape(f"rim_{i}", "sphere", (CONTACT_RADIUS,), (*place, -CONTACT_RADIUS)) for i, place in enumerate(places)
    )


def _box_visuals(size: Size, color: Color) -> list[str]:
    red, green, blue = (_EDGE_DARKNESS * channel for channel in color)
    x, y, z = (value - 2 * _EDGE_DEPTH for value in size)
    faces = [tuple(size[i] if i == axis else size[i] - 2 * _EDGE_WIDTH for i in range(3)) for axis in range(3)]
    edges = visual(Shape("edges", "box", (x, y, z)), (red, green, blue))
    return [edges, *(visual(Shape(f"faces_{'xyz'[i]}", "box", face), color) for i, face in enumerate(faces))]


def _check(name: str, size: Size, least: float) -> None:
    if min(size) < least:
        expected = f"expected sides of at least {least} m, got {{value}}"
        raise IctampError(Code.OUT_OF_RANGE, expected, field=f"{name}.size", value=size)


def box_sdf(name: str, size: Size, mass: float, friction: float, color: Color) -> str:
    """A box of uniform density with its origin at the center.

    Args:
        name: Name of the model and of its link.
        size: Sides along x, y, z [m].
        mass: Mass [kg].
        friction: Coefficient of Coulomb friction.
        color: Red, green, blue in [0, 1].

    Raises:
        IctampError: A side is too short for the contact spheres, or the mass is not positive.
    """
    _check(name, size, 4 * CONTACT_RADIUS)
    check_range(f"{name}.mass", mass, POSITIVE, inf, " kg")
    surface = OBJECT._replace(friction=friction)
    children = [
        inertial(box_inertial(size, mass)),
        *(collision(shape, surface) for shape in (Shape("body", "box", size), *box_contacts(size))),
        *_box_visuals(size, color),
    ]
    return document(element("model", [element("link", children, name=name)], name=name))


def _support_sdf(name: str, shapes: tuple[Shape, ...], color: Color) -> str:
    children = [collision(shape, SUPPORT) for shape in shapes] + [visual(shape, color) for shape in shapes]
    return document(element("model", [element("link", children, name=name)], name=name))


def support_shapes(kind: str, size: Size) -> tuple[Shape, ...]:
    """Solid shapes of a table or a rack in the frame of its top face.

    Raises:
        IctampError: A side is too short for them.
    """
    return (_table_shapes if kind == "table" else _rack_shapes)(kind, size)


def _table_shapes(name: str, size: Size) -> tuple[Shape, ...]:
    _check(name, size, 1e-3)
    return (Shape("top", "box", size, (0.0, 0.0, -size[2] / 2)),)


def _rack_shapes(name: str, size: Size) -> tuple[Shape, ...]:
    _check(name, size, 3 * RACK_THICKNESS)
    x, y, z = size
    side = RACK_THICKNESS
    leg = (side, side, z - side)
    legs = tuple(
        Shape(f"leg_{i}", "box", leg, (sx * (x - side) / 2, sy * (y - side) / 2, -(z + side) / 2))
        for i, (sx, sy) in enumerate(product((-1, 1), repeat=2))
    )
    stabilisers = tuple(
        Shape(f"stabiliser_{i}", "box", (x - 2 * side, side, side), (0.0, sy * (y - side) / 2, side / 2 - z))
        for i, sy in enumerate((-1, 1))
    )
    return (Shape("top", "box", (x, y, side), (0.0, 0.0, -side / 2)), *legs, *stabilisers)


def table_sdf(name: str, size: Size) -> str:
    """A slab with its origin at the center of its top face, to be welded to the world.

    Raises:
        IctampError: A side is shorter than 1 mm.
    """
    return _support_sdf(name, _table_shapes(name, size), read_thing("table").color)


def rack_sdf(name: str, size: Size) -> str:
    """A top plate on four legs with two stabilizers at their feet. The origin is the center of the plate's top face.

    Raises:
        IctampError: A side is too short for plate and legs.
    """
    return _support_sdf(name, _rack_shapes(name, size), read_thing("rack").color)
