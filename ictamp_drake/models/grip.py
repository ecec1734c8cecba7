"""Grip force that holds a box between the pads by friction. Its reasons are in docs/physics.md."""

from math import hypot

import numpy as np

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import FloatArray
from ictamp_drake.models.constants import MAX_GRIP_FORCE
from ictamp_drake.models.contact import CONTACT_RADIUS, PAD
from ictamp_drake.models.hand import PAD_HALF_HEIGHT, PAD_HALF_WIDTH

GRAVITY = 9.81
"""Acceleration of gravity [m/s^2]."""
LEAST_FORCE = 30.0
"""Grip force of each finger on boxes that need no more [N]."""
SAFETY = 2.0
"""Ratio of what friction can bear to the weight that it bears."""
LEVER = hypot(PAD_HALF_WIDTH - CONTACT_RADIUS, PAD_HALF_HEIGHT - CONTACT_RADIUS)
"""Distance of a pad's contact points from its center, at which friction resists a turn of the box [m]."""


def bearable(force: float, friction: float) -> float:
    """Largest load that both pads bear by friction with a grip force [N] and the friction of the box.

    The coefficient of two bodies is 2 μ1 μ2 / (μ1 + μ2), as Drake combines them.
    """
    return 2 * force * 2 * friction * PAD.friction / (friction + PAD.friction)


def friction_load(p_GO: FloatArray, f_G: FloatArray) -> FloatArray:
    """Load on the friction of the pads by forces f_G [N] at p_GO [m], shape (3,) and (n, 3) -> (n,) [N].

    Forces along the fingers' direction, y, are borne without friction. The force across it and the moment about it add
    up as two sides of a right angle (Howe and Cutkosky, "Practical Force-Motion Models for Sliding Manipulation",
    1996).
    """
    moment = np.cross(p_GO, f_G)[:, 1]
    load: FloatArray = np.sqrt(f_G[:, 0] ** 2 + f_G[:, 2] ** 2 + (moment / LEVER) ** 2)
    return load


def needed_force(mass: float, friction: float, offset: float = 0.0, safety: float = SAFETY) -> float:
    """Grip force of each finger that holds a box at rest [N].

    Args:
        mass: Mass of the box [kg].
        friction: Friction of the box.
        offset: Distance of the pads from the vertical through the box's center, along G's x [m].
        safety: Ratio of what friction can bear to the load.
    """
    return safety * hypot(1.0, offset / LEVER) * mass * GRAVITY / bearable(1.0, friction)


def check_weight(mass: float, friction: float, field: str, safety: float = SAFETY) -> None:
    """Raise IctampError, for the field of a box, when the hand cannot hold it even in the middle."""
    force = needed_force(mass, friction, safety=safety)
    if force > MAX_GRIP_FORCE:
        problem = (
            f"{{value}} kg with a friction of {friction:g} need a grip force of {force:.0f} N, and the hand has at "
            f"most {MAX_GRIP_FORCE:g} N"
        )
        raise IctampError(Code.TOO_HEAVY, problem, field=f"{field}.mass", value=mass)
