"""Building blocks from which skills put their motions together."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace

from ictamp_drake.core.types import Configuration, FloatArray, GripperCommand, Motion, Segment
from ictamp_drake.robots.gripper import Gripper
from ictamp_drake.world.commands import gripper_time, stand_still

PAUSE = 0.1
"""Waiting time of the hand after the gripper has obeyed [s]."""


def hold(
    gripper: Gripper,
    label: str,
    q: FloatArray,
    before: GripperCommand,
    after: GripperCommand,
    *,
    touches: Collection[str],
) -> Segment:
    """Stand still at q, shape (n,) [rad], while the gripper goes from one command to the next."""
    return stand_still(label, gripper_time(before, after, gripper.speed) + PAUSE, q, after, frozenset(touches))


def openings(gripper: Gripper, needed: float, clearances: Sequence[float]) -> tuple[GripperCommand, ...]:
    """Commands that open the hand by a clearance on each side more than needed, up to its maximum; all in [m]."""
    widths = (min(needed + 2 * clearance, gripper.opening) for clearance in clearances)
    return tuple(GripperCommand(width) for width in dict.fromkeys(widths))


def configuration_after(
    gripper: Gripper,
    c: Configuration,
    motion: Motion,
    *,
    width: float,
    held: str | None,
    moved: Mapping[str, FloatArray],
) -> Configuration:
    """c after a successful motion: fingers `width` apart [m], the `moved` boxes at their X_WO."""
    q = motion[-1].control_points[-1]
    return replace(imagine(gripper, c, q=q, width=width, held=held, moved=moved), gripper=motion[-1].gripper)


def imagine(
    gripper: Gripper,
    c: Configuration,
    *,
    q: FloatArray,
    width: float,
    held: str | None,
    moved: Mapping[str, FloatArray] | None = None,
) -> Configuration:
    """c with the arm at q, shape (n,) [rad], fingers `width` apart [m], and the `moved` boxes at their X_WO."""
    return Configuration(q, gripper.positions(width), {**c.poses, **(moved or {})}, held)
