"""Motions as Drake trajectories: the commands to the controllers of arm and hand over time."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from pydrake.math import BsplineBasis
from pydrake.trajectories import (
    BsplineTrajectory,
    CompositeTrajectory,
    PiecewisePolynomial,
    StackedTrajectory,
    Trajectory,
)

from ictamp_drake.core.types import FloatArray, GripperCommand, Segment
from ictamp_drake.models.constants import MAX_FINGER_SPEED

FORCE_RAMP = 0.05
"""Time to build up or release the grip force [s]."""
_INSTANT = 1e-9
"""Time difference below which two times are equal up to rounding [s]."""


def gripper_time(before: GripperCommand, after: GripperCommand) -> float:
    """Time the hand needs from the goal of one command to the goal of the next [s]."""
    return abs(after.width - before.width) / 2 / MAX_FINGER_SPEED + FORCE_RAMP * (after.force != before.force)


def stand_still(
    label: str, duration: float, q: FloatArray, gripper: GripperCommand, touches: frozenset[str] | None
) -> Segment:
    """Return a segment in which the arm rests at q, shape (7,) [rad], for `duration` [s] while the gripper moves."""
    return Segment(label, duration, gripper, 1, np.array([0.0, duration]), q[None], touches)


def desired_positions(
    q_arm: FloatArray, gripper: GripperCommand, segments: Sequence[Segment], end: float
) -> Trajectory:
    """Positions of the 7 arm joints [rad] and 2 fingers [m] from 0 to `end` [s]. The arm rests after the last segment.

    Args:
        q_arm: Commanded arm joint positions before the motion, shape (7,) [rad].
        gripper: Gripper command in force before the motion.
        segments: Segments of the motion, possibly none.
        end: End of the trajectory [s], later than both the last segment and `obedience_time`.
    """
    arm, start = _arm_pieces(segments)
    if segments:
        q_arm = segments[-1].control_points[-1]
    arm.append(PiecewisePolynomial.ZeroOrderHold([start, end], np.column_stack([q_arm, q_arm])))
    times, widths, _ = _gripper_knots(gripper, segments, end)
    stacked = StackedTrajectory(rowwise=True)
    stacked.Append(CompositeTrajectory(arm))
    stacked.Append(PiecewisePolynomial.FirstOrderHold(times, np.tile(widths / 2, (2, 1))))
    return stacked


def feedforward(gripper: GripperCommand, segments: Sequence[Segment], end: float) -> Trajectory:
    """Efforts added to those of the position controllers, shape (9, 1): only the grip force of the fingers [N]."""
    times, _, forces = _gripper_knots(gripper, segments, end)
    return PiecewisePolynomial.FirstOrderHold(times, np.vstack([np.zeros((7, len(times))), -forces, -forces]))


def arm_trajectory(segments: Sequence[Segment]) -> Trajectory:
    """Positions of the 7 arm joints [rad] from 0 to the end of the last segment.

    Raises:
        ValueError: There is no segment.
    """
    if not segments:
        raise ValueError("no segments, so there is no trajectory")
    return CompositeTrajectory(_arm_pieces(segments)[0])


def _arm_pieces(segments: Sequence[Segment]) -> tuple[list[Trajectory], float]:
    """Return consecutive pieces of the arm's trajectory and the end time of the last one [s]."""
    pieces: list[Trajectory] = []
    start = 0.0
    for segment in segments:
        pieces.append(_arm_piece(segment, start))
        start += segment.duration
    return pieces, start


def _arm_piece(segment: Segment, start: float) -> Trajectory:
    end = start + segment.duration
    if len(segment.control_points) == 1:
        q = segment.control_points[0]
        return PiecewisePolynomial.ZeroOrderHold([start, end], np.column_stack([q, q]))
    knots = segment.knots + start
    knots[-segment.order :] = end  # exactly where the next piece starts, despite rounding
    return BsplineTrajectory(BsplineBasis(segment.order, knots), segment.control_points.T)


def obedience_time(gripper: GripperCommand, segments: Sequence[Segment]) -> float:
    """Time at which the hand has obeyed the last command of a motion [s], possibly after the motion's end."""
    return max((change.arrival for change in _changes(gripper, segments)), default=0.0)


def gripper_schedule(gripper: GripperCommand, segments: Sequence[Segment]) -> list[tuple[float, GripperCommand]]:
    """Return the commands to the hand with the times from which they are in force [s], first `gripper` from 0 on."""
    return [(0.0, gripper), *((change.start, change.after) for change in _changes(gripper, segments))]


class _Change(NamedTuple):
    """Movement of the hand from the goal of one command to the goal of the next, from `start` to `arrival` [s]."""

    start: float
    arrival: float
    before: GripperCommand
    after: GripperCommand


def _changes(gripper: GripperCommand, segments: Sequence[Segment]) -> Iterator[_Change]:
    """Yield the movements of the hand. A command starts with its segment, or once the one before is obeyed."""
    start = arrival = 0.0
    for segment in segments:
        if segment.gripper != gripper:
            begin = start if start > arrival + _INSTANT else arrival
            arrival = begin + gripper_time(gripper, segment.gripper)
            yield _Change(begin, arrival, gripper, segment.gripper)
            gripper = segment.gripper
        start += segment.duration


def _gripper_knots(
    gripper: GripperCommand, segments: Sequence[Segment], end: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Times, widths and forces between which the commands of the hand are interpolated.

    The hand grips after its fingers have arrived, and lets go before they move.
    """
    knots = {0.0: (gripper.width, gripper.force)}
    for start, arrival, before, after in _changes(gripper, segments):
        knots[start] = (before.width, before.force)
        if after.force != before.force and after.width != before.width:
            grips = after.force > before.force
            ramp = arrival - FORCE_RAMP if grips else start + FORCE_RAMP
            knots[ramp] = (after.width, before.force) if grips else (before.width, after.force)
        knots[arrival] = (after.width, after.force)
        gripper = after
    knots[end] = (gripper.width, gripper.force)
    times = np.array(sorted(knots))
    widths, forces = np.array([knots[time] for time in times]).T
    return times, widths, forces
