"""Collision geometry of the LBR iiwa 14: upright and lying cylinders, and a box, that contain the real links.

All axes are those of the base when the arm stands upright. Origins are those of the links' frames.
"""

import math

from ictamp_drake.models.sdf_text import Shape


def _upright(name: str, bottom: float, top: float, y: float, radius: float) -> Shape:
    """A cylinder along z, between two heights and with its axis in the plane x = 0."""
    return Shape(name, "cylinder", (radius, round(top - bottom, 4)), (0.0, y, round((bottom + top) / 2, 5)))


def _lying(name: str, first: float, last: float, radius: float) -> Shape:
    """A cylinder about the y axis, between two positions along it."""
    center = (0.0, round((first + last) / 2, 5), 0.0)
    return Shape(name, "cylinder", (radius, round(last - first, 4)), center, (math.pi / 2, 0.0, 0.0))


LINKS: tuple[tuple[Shape, ...], ...] = (
    (
        _upright("foot", 0.0, 0.03, 0.0, 0.1225),
        _upright("lower", 0.03, 0.06, 0.0, 0.1135),
        _upright("middle", 0.06, 0.1, 0.0, 0.105),
        _upright("upper", 0.1, 0.1575, 0.0, 0.0945),
        Shape("rear", "box", (0.137, 0.152, 0.1575), (-0.0685, 0.0, 0.07875)),
    ),
    (
        _upright("column", -0.2125, -0.16, -0.002, 0.088),
        _upright("bend", -0.16, -0.125, -0.014, 0.0837),
        _upright("neck", -0.125, -0.025, -0.041, 0.076),
        _lying("shoulder", -0.065, 0.0, 0.0867),
        _lying("shoulder_end", -0.095, -0.065, 0.0763),
        _lying("shoulder_cap", -0.117, -0.095, 0.058),
    ),
    (
        _lying("shoulder", -0.0105, 0.085, 0.087),
        _lying("shoulder_end", 0.085, 0.112, 0.0755),
        _lying("shoulder_cap", 0.112, 0.1335, 0.0575),
        _upright("neck", 0.025, 0.085, 0.046, 0.0812),
        _upright("waist", 0.085, 0.13, 0.041, 0.0706),
        _upright("bend", 0.13, 0.165, 0.016, 0.073),
        _upright("column", 0.165, 0.2046, 0.003, 0.0721),
    ),
    (
        _upright("column", -0.2256, -0.15, 0.003, 0.0714),
        _upright("bend", -0.15, -0.115, 0.012, 0.0747),
        _upright("neck", -0.115, -0.02, 0.042, 0.0712),
        _lying("elbow", -0.0005, 0.07, 0.0691),
        _lying("elbow_end", 0.07, 0.098, 0.0613),
        _lying("elbow_cap", 0.098, 0.1152, 0.049),
    ),
    (
        _lying("elbow", -0.07, 0.0105, 0.0691),
        _lying("elbow_end", -0.098, -0.07, 0.0615),
        _lying("elbow_cap", -0.1152, -0.098, 0.0492),
        _upright("neck", 0.02, 0.075, -0.047, 0.0674),
        _upright("waist", 0.075, 0.115, -0.037, 0.0657),
        _upright("bend", 0.115, 0.15, -0.012, 0.0747),
        _upright("column", 0.15, 0.1846, -0.003, 0.0714),
    ),
    (
        _upright("column", -0.2256, -0.165, 0.0, 0.0687),
        _upright("bend", -0.165, -0.12, -0.007, 0.0733),
        _upright("neck", -0.12, -0.09, -0.04, 0.0515),
        _upright("forearm", -0.09, -0.025, -0.082, 0.0455),
        _lying("wrist", -0.0998, -0.06, 0.052),
    ),
    (
        _upright("bottom", -0.087, -0.068, 0.019, 0.0472),
        _upright("lower", -0.068, -0.05, 0.015, 0.0576),
        _upright("ball", -0.05, 0.045, 0.006, 0.0664),
        _upright("neck", 0.045, 0.0812, 0.002, 0.0568),
        _lying("side", -0.05, 0.0, 0.074),
        _lying("cap", -0.0712, -0.05, 0.065),
    ),
    (_upright("flange", -0.055, 0.0, 0.0, 0.0525),),
)
"""The primitives of every link, from the base to the flange."""
