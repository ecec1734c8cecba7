"""Grip force that holds a box between the pads by friction. docs/physics.md explains it."""

from math import hypot

import numpy as np

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import FloatArray
from ictamp_drake.models.contact import PAD
from ictamp_drake.robots.gripper import Gripper

GRAVITY = 9.81
"""Acceleration of gravity [m/s^2]."""
LEAST_FORCE = 30.0
"""Minimum grip force of each finger [N]."""
SAFETY = 2.0
"""Ratio of the load that friction can bear to the load of a box at rest."""


def bearable(force: float, friction: float) -> float:
    """Return the largest load that both pads bear by friction [N].

    The coefficient of two bodies is 2 μ1 μ2 / (μ1 + μ2), as Drake combines them.

    Args:
        force: Grip force of each finger [N].
        friction: Coefficient of friction of the box.
    """
    return 2 * force * 2 * friction * PAD.friction / (friction + PAD.friction)


def friction_load(p_GO: FloatArray, f_G: FloatArray, lever: float) -> FloatArray:
    """Return the load on the friction of the pads by forces at a point.

    Forces along G's y, the fingers' direction, need no friction. The force across it and the moment about it, divided
    by the lever arm, add up like the legs of a right triangle (Howe and Cutkosky, "Practical Force-Motion Models for
    Sliding Manipulation", 1996).

    Args:
        p_GO: Position of the point in G, shape (3,) [m].
        f_G: Forces in G, shape (n, 3) [N].
        lever: Lever arm of the pads' friction, see `Hand.lever` [m].

    Returns:
        Shape (n,) [N].
    """
    moment = np.cross(p_GO, f_G)[:, 1]
    load: FloatArray = np.sqrt(f_G[:, 0] ** 2 + f_G[:, 2] ** 2 + (moment / lever) ** 2)
    return load


def needed_force(mass: float, friction: float, lever: float, offset: float = 0.0, safety: float = SAFETY) -> float:
    """Return the grip force of each finger that holds a box at rest [N].

    Args:
        mass: Mass of the box [kg].
        friction: Coefficient of friction of the box.
        lever: Lever arm of the pads' friction, see `Hand.lever` [m].
        offset: Distance of G from the vertical through the box's center, along G's x [m].
        safety: Ratio of the load that friction can bear to the load of the box.
    """
    return safety * hypot(1.0, offset / lever) * mass * GRAVITY / bearable(1.0, friction)


def check_weight(mass: float, friction: float, gripper: Gripper, field: str, safety: float = SAFETY) -> None:
    """Raise IctampError, for the field of a box, when the hand cannot hold it even at its center."""
    force = needed_force(mass, friction, gripper.hand.lever, safety=safety)
    if force > gripper.force:
        problem = (
            f"{{value}} kg with a friction of {friction:g} need a grip force of {force:.0f} N, and the hand has at "
            f"most {gripper.force:g} N"
        )
        raise IctampError(Code.TOO_HEAVY, problem, field=f"{field}.mass", value=mass)
