"""Geometry of the Panda's hand, the only place that states it. All lengths are in m.

G, the grasp frame, is between the finger tips. Its x axis is along the pads, y along the motion of the fingers, and z
points out of the palm, down when the hand points down.

The hand's collision shapes are bounded in three ways: `FINGER`, `PALM` and `WRIST` are boxes that contain them, for the
networks; `UPPER_HAND` contains those above the fingers more closely, in rows of cylinders, for geometric sampling; and
`HAND_CORE` and `FINGER_DISK` are volumes that the hand occupies at any yaw, for what is certain to collide.
"""

import math
from typing import NamedTuple


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


HAND_ANGLE = -math.pi / 4
"""Rotation of the hand relative to the flange about z [rad]."""
GRASP_OFFSET = 0.1034
"""Distance of G from the flange along z."""
FINGER_OFFSET = 0.0584
"""Distance of the finger frames from the flange along z."""

MAX_OPENING = 0.08
"""Distance between the pads of the open hand."""
MAX_SIDE = MAX_OPENING - 0.005
"""Widest side of a box that is gripped: the opening minus the play that the fingers need."""

PAD_HALF_WIDTH = 0.01
"""Half width of a pad along the finger frame's x."""
PAD_HALF_HEIGHT = 0.0095
"""Half height of a pad along the finger frame's z, which is the distance of the finger tips below G."""
PAD_THICKNESS = 0.0155
"""Thickness of finger and pad, measured outwards from the gripping face, the finger frame's plane y = 0."""
PAD_RADIUS = PAD_THICKNESS / 2
"""Radius of the largest circle inside a pad, as seen from above."""
PAD_CENTER = GRASP_OFFSET - FINGER_OFFSET
"""Distance of the pad's center from the finger frame along z, which puts it at G."""

TIP = PAD_HALF_HEIGHT + 0.0025
"""Distance below G beyond which no part of a finger reaches, with 2.5 mm to spare."""

LOWEST_GRASP = TIP + 0.002
"""Height of G that keeps the tips well above the ground, and up to which flat boxes are gripped."""

FINGER = Outline(half_length=0.011, half_width=0.0135, bottom=-PAD_HALF_HEIGHT)
"""An open finger with its mount. Its inner face is half the opening away from G."""
PALM = Outline(half_length=0.0195, half_width=0.101, bottom=0.037)
WRIST = Outline(half_length=0.075, half_width=0.075, bottom=0.105)

UPPER_HAND = (
    Row(-PALM.half_width + PALM.half_length, PALM.half_width - PALM.half_length, PALM.half_length, PALM.bottom),
    Row(0.075, 0.085, radius=0.0245, bottom=0.0445),
    Row(0.05, 0.08, radius=0.029, bottom=0.0955),
    Row(0.0, 0.0, radius=0.054, bottom=0.1035),
)
"""Palm, front edge and front of the hand, and the wrist above it: closer to the model than the outlines."""

HAND_CORE = (
    Cylinder(radius=0.019, bottom=PALM.bottom, top=0.104),
    Cylinder(radius=0.053, bottom=0.104, top=0.160),
)
"""Cylinders inside palm and flange."""
FINGER_DISK = Cylinder(radius=0.045, bottom=-0.009, top=PALM.bottom)
"""Cylinder that the fingers partly fill at every height, whatever their yaw and opening."""
