"""Measures of a hand with two fingers, as seen from its grasp frame G, between the pads. All lengths are in m.

x of G is along the pads, y along the motion of the fingers, and z points out of the palm, down when the hand points
down.
"""

from dataclasses import dataclass
from math import hypot
from typing import NamedTuple

from ictamp_drake.models.contact import CONTACT_RADIUS


class Outline(NamedTuple):
    """Outline of a part of the hand that comes down from above: an upright box that is open at its top.

    Attributes:
        half_length: Half of its side along G's x axis.
        half_width: Half of its side along G's y axis.
        bottom: Height of its lower face above G, when the hand points down.
    """

    half_length: float
    half_width: float
    bottom: float


class Row(NamedTuple):
    """Part of the hand above the fingers as a row of upright cylinders along G's y axis, open at their tops.

    Attributes:
        first, last: Positions of the first and of the last axis along y.
        radius: Radius of the cylinders.
        bottom: Height of their lower faces above G, when the hand points down.
    """

    first: float
    last: float
    radius: float
    bottom: float


class Cylinder(NamedTuple):
    """Upright cylinder about G's z axis.

    Attributes:
        radius: Radius.
        bottom, top: Heights of its lower and upper face above G, when the hand points down.
    """

    radius: float
    bottom: float
    top: float


@dataclass(frozen=True)
class Hand:
    """Pads and outlines of a hand.

    Attributes:
        pad_half_length: Half of a pad's side along G's x axis.
        pad_thickness: Thickness of a pad, measured outwards from the gripping face.
        pad_half_height: Half of a pad's side along G's z axis.
        finger: An open finger with its mount. Its inner face is half the opening away from G.
        upper: Parts above the fingers.
        core: Cylinders inside the hand, above the fingers, at any yaw.
        disk: Cylinder that the fingers partly fill at every height, whatever their yaw and opening; None if unknown.
    """

    pad_half_length: float
    pad_thickness: float
    pad_half_height: float
    finger: Outline
    upper: tuple[Row, ...]
    core: tuple[Cylinder, ...] = ()
    disk: Cylinder | None = None

    @property
    def pad_radius(self) -> float:
        """Radius of the largest circle inside a pad, as seen from above."""
        return min(self.pad_thickness / 2, self.pad_half_length)

    @property
    def lever(self) -> float:
        """Distance of a pad's contact points from its center: the lever arm with which friction resists a turn."""
        return hypot(self.pad_half_length - CONTACT_RADIUS, self.pad_half_height - CONTACT_RADIUS)

    @property
    def depth(self) -> float:
        """Distance from G down to the lowest point of a finger."""
        return max(self.pad_half_height, -self.finger.bottom)

    @property
    def tip(self) -> float:
        """Distance below G beyond which no part of a finger reaches, with 2.5 mm to spare."""
        return self.depth + 0.0025

    @property
    def lowest_grasp(self) -> float:
        """Height of G that keeps the tips well above the ground, and up to which flat boxes are gripped."""
        return self.tip + 0.002

    @property
    def palm(self) -> float:
        """Height of the lowest part above the fingers, above G."""
        return min(row.bottom for row in self.upper)
