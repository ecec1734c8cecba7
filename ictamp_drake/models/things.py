"""The boxes, the table and the rack of the packing problems, read from their committed SDF files."""

from functools import cache
from pathlib import Path
from typing import NamedTuple
from xml.etree import ElementTree

import numpy as np

from ictamp_drake.core.types import FloatArray
from ictamp_drake.models.sdf_text import DRAKE_NAMESPACE

FOLDER = Path(__file__).parent / "sdf"
BOXES = tuple(sorted(path.stem for path in FOLDER.glob("*_box.sdf")))
"""Names of the boxes that have a file."""
WIDEST = 0.075
"""Widest side by which boxes of the levels are gripped [m]: the opening of their robot's hand, less 5 mm of play."""
SUPPORTS = ("table", "rack")
"""Names of the supports that have a file, which are also their kinds."""


class Thing(NamedTuple):
    """Properties of a box or support in its file.

    Attributes:
        size: Sides of the smallest upright box around its solid shapes, along the axes of its frame [m].
        mass: Mass [kg]; 0 for supports, which never move.
        friction: Coefficient of Coulomb friction, static and dynamic.
        color: Red, green, blue, each in [0, 1].
    """

    size: tuple[float, float, float]
    mass: float
    friction: float
    color: tuple[float, float, float]


@cache
def read_thing(name: str) -> Thing:
    """Read the file of a box or support. Of its shapes, boxes parallel to its axes are solid; spheres are for contact.

    Raises:
        OSError: The file does not exist.
    """
    root = ElementTree.parse(FOLDER / f"{name}.sdf").getroot()
    solids = [element for element in root.iter("collision") if element.find("geometry/box") is not None]
    middles = np.array([_numbers(solid, "pose")[:3] for solid in solids])
    halves = np.array([_numbers(solid, "geometry/box/size") for solid in solids]) / 2
    x, y, z = ((middles + halves).max(axis=0) - (middles - halves).min(axis=0)).round(9).tolist()
    mass = root.findtext(".//inertial/mass", default="0")
    (friction,) = _numbers(solids[0], f"{{{DRAKE_NAMESPACE}}}proximity_properties/{{{DRAKE_NAMESPACE}}}mu_static")
    red, green, blue, _ = _numbers([*root.iter("visual")][-1], "material/diffuse").tolist()
    return Thing((x, y, z), float(mass), float(friction), (red, green, blue))


def _numbers(element: ElementTree.Element, path: str) -> FloatArray:
    return np.array(element.findtext(path, default="").split(), dtype=float)
