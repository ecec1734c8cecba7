"""Building blocks from which skills put their motions together."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

import numpy as np

from ictamp_drake.core.types import Configuration, FloatArray, GripperCommand, Motion, Segment
from ictamp_drake.models.hand import MAX_OPENING
from ictamp_drake.world.commands import gripper_time, stand_still

PAUSE = 0.1
"""Waiting time of the hand after the gripper has obeyed [s]."""


def hold(label: str, q: FloatArray, before: GripperCommand, after: GripperCommand, touches: Collection[str]) -> Segment:
    """Stand still at q, shape (7,) [rad], while the gripper goes from one command to the next."""
    return stand_still(label, gripper_time(before, after) + PAUSE, q, after, frozenset(touches))


def openings(needed: float, clearances: Sequence[float]) -> tuple[GripperCommand, ...]:
    """Commands that open the hand by a clearance on each side more than needed, up to its maximum; all in [m]."""
    widths = (min(needed + 2 * clearance, MAX_OPENING) for clearance in clearances)
    return tuple(GripperCommand(width) for width in dict.fromkeys(widths))


def configuration_after(
    c: Configuration, motion: Motion, *, width: float, held: str | None, moved: Mapping[str, FloatArray]
) -> Configuration:
    """c after a successful motion: fingers `width` apart [m], the `moved` boxes at their X_WO."""
    q = motion[-1].control_points[-1]
    return replace(imagine(c, q=q, width=width, held=held, moved=moved), gripper=motion[-1].gripper)


def imagine(
    c: Configuration,
    *,
    q: FloatArray,
    width: float,
    held: str | None,
    moved: Mapping[str, FloatArray] | None = None,
) -> Configuration:
    """c with the arm at q, shape (n,) [rad], fingers `width` apart [m], and the `moved` boxes at their X_WO."""
    return Configuration(q, np.full(2, width / 2), {**c.poses, **(moved or {})}, held)
