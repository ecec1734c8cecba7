"""Appearance of the LBR iiwa 14: silver limbs, each a blend of domes, with orange bands and a dark flange.

Axes and origins are those of `iiwa_collision`. The bodies also give the links their inertias.
"""

import math
from typing import NamedTuple

from ictamp_drake.models.sdf_text import Color, Shape
from tools.gltf import gltf
from tools.surface import Distance, Vector, blend, cylinder, dome, rounded_box, triangulate

SILVER: Color = (0.72, 0.73, 0.75)
ORANGE: Color = (0.95, 0.42, 0.08)
DARK: Color = (0.2, 0.2, 0.21)

EDGE = 0.01
"""Radius of the rims [m]."""
STEP = 0.012
"""Side of the triangles [m]."""

Accent = tuple[Shape, Color]


class Look(NamedTuple):
    """A silver body inside the box from `lower` to `upper` [m], and colored accents."""

    body: Distance
    lower: Vector
    upper: Vector
    accents: tuple[Accent, ...]


def _band(y: float, radius: float, width: float) -> Accent:
    """An orange band about the y axis."""
    return Shape("band", "cylinder", (radius, width), (0.0, y, 0.0), (math.pi / 2, 0.0, 0.0)), ORANGE


def _collar(z: float, radius: float) -> Accent:
    """A dark band about the z axis, where a link ends."""
    return Shape("collar", "cylinder", (radius, 0.006), (0.0, 0.0, z)), DARK


LOOKS: tuple[Look, ...] = (
    Look(
        blend(
            (
                cylinder((0.0, 0.0, 0.0), (0.0, 0.0, 0.155), 0.086, 0.005),
                cylinder((0.0, 0.0, 0.0), (0.0, 0.0, 0.045), 0.112, 0.02),
                rounded_box((-0.068, 0.0, 0.076), (0.134, 0.128, 0.152), 0.012),
            ),
            0.05,
        ),
        (-0.14, -0.125, 0.0),
        (0.125, 0.125, 0.16),
        (_collar(0.153, 0.087),),
    ),
    Look(
        blend(
            (dome((0, 0, -0.2125), (0, -0.02, -0.04), 0.083, EDGE), dome((0, 0, 0), (0, -0.1155, 0), 0.0845, EDGE)),
            0.04,
        ),
        (-0.09, -0.12, -0.215),
        (0.09, 0.09, 0.09),
        (),
    ),
    Look(
        blend(
            (dome((0, 0, 0.2045), (0, 0.03, 0.02), 0.067, EDGE), dome((0, 0, 0), (0, 0.1315, 0), 0.0845, EDGE)), 0.05
        ),
        (-0.09, -0.09, -0.09),
        (0.09, 0.135, 0.21),
        (_band(0.034, 0.0865, 0.022), _collar(0.2015, 0.068)),
    ),
    Look(
        blend(
            (dome((0, 0, -0.2155), (0, 0.02, -0.04), 0.067, EDGE), dome((0, 0, 0), (0, 0.114, 0), 0.0675, EDGE)), 0.04
        ),
        (-0.075, -0.075, -0.22),
        (0.075, 0.12, 0.075),
        (),
    ),
    Look(
        blend(
            (dome((0, 0, 0.1845), (0, -0.02, 0.02), 0.067, EDGE), dome((0, 0, 0), (0, -0.114, 0), 0.0675, EDGE)), 0.04
        ),
        (-0.075, -0.12, -0.075),
        (0.075, 0.075, 0.19),
        (_band(-0.034, 0.0692, 0.018), _collar(0.1815, 0.0682)),
    ),
    Look(
        blend(
            (
                dome((0, 0, -0.2155), (0, -0.02, -0.1), 0.067, EDGE),
                rounded_box((0, -0.079, -0.06), (0.084, 0.034, 0.15), 0.015),
                cylinder((0, -0.098, 0), (0, -0.062, 0), 0.05, 0.01),
            ),
            0.035,
        ),
        (-0.075, -0.105, -0.22),
        (0.075, 0.075, 0.055),
        (),
    ),
    Look(
        blend(
            (
                dome((0, 0, 0.08), (0, 0.004, -0.085), 0.062, EDGE),
                dome((0, 0, 0), (0, 0.066, 0), 0.064, EDGE),
                cylinder((0, -0.07, 0), (0, 0, 0), 0.056, 0.01),
            ),
            0.03,
        ),
        (-0.075, -0.075, -0.09),
        (0.075, 0.075, 0.085),
        (_band(-0.063, 0.0582, 0.01),),
    ),
    Look(
        cylinder((0, 0, -0.045), (0, 0, -0.004), 0.049, 0.01),
        (-0.055, -0.055, -0.05),
        (0.055, 0.055, 0.0),
        ((Shape("flange", "cylinder", (0.0315, 0.01), (0.0, 0.0, -0.005)), DARK), _collar(-0.044, 0.05)),
    ),
)
"""The looks of the links, from the base to the flange."""


def visual_files() -> dict[str, str]:
    """Text of the glTF file of each link's body, by file name."""
    return {
        f"iiwa_link_{number}.gltf": gltf(triangulate(look.body, look.lower, look.upper, STEP), SILVER, roughness=0.4)
        for number, look in enumerate(LOOKS)
    }
