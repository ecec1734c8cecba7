"""Appearance of the Panda: white molded limbs, each a blend of domes, with dark joints, flange and fingers."""

import math
from typing import NamedTuple

from ictamp_drake.core.types import FloatArray
from ictamp_drake.models.sdf_text import Color, Shape
from tools.gltf import gltf
from tools.surface import Distance, Vector, blend, cylinder, dome, intersect, rounded_box, triangulate

WHITE: Color = (0.86, 0.87, 0.88)
GREY: Color = (0.5, 0.51, 0.53)
DARK: Color = (0.15, 0.15, 0.16)

LIMB = 0.055
"""Radius of the upper limbs [m]."""
RING = LIMB + 0.0012
"""Radius of the dark disks that close them, half a millimeter beyond their flat ends [m]."""
_ALONG_Y = (math.pi / 2, 0.0, 0.0)


class Look(NamedTuple):
    """A white body inside the box from `lower` to `upper` [m], triangles of side `step` [m], and colored accents."""

    body: Distance
    lower: Vector
    upper: Vector
    step: float
    accents: tuple[tuple[Shape, Color], ...]


def _cut_at_ground(body: Distance) -> Distance:
    """The part of the body above z = 0."""

    def distance(points: FloatArray) -> FloatArray:
        return intersect(body(points), -points[:, 2], 0.016)

    return distance


BASE = _cut_at_ground(
    blend(
        (
            dome((0.0, 0.0, 0.14), (0.0, 0.0, -0.1), LIMB),
            rounded_box((-0.055, 0.0, 0.02), (0.14, 0.10, 0.08), 0.02),
            rounded_box((-0.01, 0.0, 0.0), (0.12, 0.125, 0.03), 0.012),
        ),
        0.05,
    )
)

LINKS: dict[str, Look] = {
    "panda_link0": Look(
        BASE,
        (-0.16, -0.1, 0.0),
        (0.09, 0.1, 0.14),
        0.0078,
        (
            (Shape("ring", "cylinder", (RING, 0.006), (0.0, 0.0, 0.1375)), DARK),
            (Shape("plate", "box", (0.2, 0.165, 0.01), (-0.045, 0.0, 0.005)), GREY),
            (Shape("socket", "box", (0.012, 0.06, 0.04), (-0.122, 0.0, 0.035)), DARK),
        ),
    ),
    "panda_link1": Look(
        blend((dome((0, 0, -0.192), (0, 0, -0.045), LIMB), dome((0, 0, 0), (0, -0.129, 0), LIMB)), 0.03),
        (-0.065, -0.13, -0.192),
        (0.065, 0.065, 0.065),
        0.0078,
        ((Shape("ring", "cylinder", (RING, 0.006), (0.0, -0.0025, 0.0), _ALONG_Y), DARK),),
    ),
    "panda_link2": Look(
        blend((dome((0, -0.194, 0), (0, -0.045, 0), LIMB), dome((0, 0, 0), (0, 0, 0.129), LIMB)), 0.03),
        (-0.065, -0.194, -0.065),
        (0.065, 0.065, 0.13),
        0.0078,
        ((Shape("ring", "cylinder", (RING, 0.006), (0.0, -0.1915, 0.0), _ALONG_Y), DARK),),
    ),
    "panda_link3": Look(
        blend((dome((0, 0, -0.121), (0, 0, -0.005), LIMB), dome((0.0825, 0, 0), (0.0825, 0.111, 0), LIMB)), 0.04),
        (-0.065, -0.065, -0.122),
        (0.145, 0.115, 0.065),
        0.0078,
        ((Shape("ring", "cylinder", (RING, 0.006), (0.0825, 0.0025, 0.0), _ALONG_Y), DARK),),
    ),
    "panda_link4": Look(
        blend((dome((-0.0825, 0.124, 0), (-0.0825, 0.005, 0), LIMB), dome((0, 0, 0), (0, 0, 0.111), LIMB)), 0.04),
        (-0.145, -0.065, -0.065),
        (0.065, 0.125, 0.115),
        0.0078,
        ((Shape("ring", "cylinder", (RING, 0.006), (-0.0825, 0.1215, 0.0), _ALONG_Y), DARK),),
    ),
    "panda_link5": Look(
        blend(
            (
                dome((0, 0, -0.259), (0, 0, -0.158), 0.054),
                rounded_box((0, 0.073, -0.12), (0.064, 0.032, 0.17), 0.015, roll=-0.2),
                dome((0, 0.016, 0), (0, 0.128, 0), 0.048),
            ),
            0.05,
        ),
        (-0.07, -0.07, -0.26),
        (0.07, 0.14, 0.06),
        0.0078,
        ((Shape("ring", "cylinder", (0.0494, 0.006), (0.0, 0.0184, 0.0), _ALONG_Y), DARK),),
    ),
    "panda_link6": Look(
        blend(
            (
                cylinder((0, 0, -0.014), (0, 0, 0.054), 0.046, 0.03),
                rounded_box((0.05, 0.012, 0.014), (0.07, 0.08, 0.05), 0.02),
                dome((0.088, -0.051, 0), (0.088, 0.08, 0), 0.043),
            ),
            0.03,
        ),
        (-0.055, -0.06, -0.05),
        (0.14, 0.09, 0.065),
        0.005,
        (
            (Shape("ring", "cylinder", (0.0436, 0.006), (0.088, -0.0486, 0.0), _ALONG_Y), DARK),
            (Shape("wrist_ring", "cylinder", (0.042, 0.006), (0.0, 0.0, -0.0118)), DARK),
        ),
    ),
    "panda_link7": Look(
        blend(
            (
                cylinder((0, 0, 0.053), (0, 0, 0.094), 0.043, 0.012),
                rounded_box((0.043, 0.043, 0.077), (0.05, 0.05, 0.028), 0.012, yaw=math.pi / 4),
            ),
            0.015,
        ),
        (-0.05, -0.05, 0.045),
        (0.09, 0.09, 0.1),
        0.004,
        ((Shape("flange", "cylinder", (0.032, 0.014), (0.0, 0.0, 0.1)), GREY),),
    ),
    "panda_hand": Look(
        blend(
            (
                rounded_box((0, 0, 0.035), (0.037, 0.2, 0.06), 0.009),
                rounded_box((0, 0.065, 0.01), (0.05, 0.065, 0.03), 0.01),
            ),
            0.012,
        ),
        (-0.035, -0.11, -0.012),
        (0.035, 0.11, 0.072),
        0.005,
        (
            (Shape("flange", "cylinder", (0.0315, 0.008), (0.0, 0.0, 0.004)), GREY),
            (Shape("plug", "box", (0.03, 0.06, 0.014), (0.0, -0.06, -0.001)), DARK),
            (Shape("rail", "box", (0.022, 0.19, 0.004), (0.0, 0.0, 0.0642)), DARK),
        ),
    ),
}


def visual_files() -> dict[str, str]:
    """Text of the glTF file of each link's body, by file name."""
    return {
        f"{name}.gltf": gltf(triangulate(look.body, look.lower, look.upper, look.step), WHITE, roughness=0.45)
        for name, look in LINKS.items()
    }
