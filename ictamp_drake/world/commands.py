"""Motions as Drake trajectories: the commands to the controllers of arm and gripper over time."""

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
from ictamp_drake.robots.gripper import Gripper

FORCE_RAMP = 0.05
"""Time to build up or release the grip force [s]."""
_BETWEEN = 7
"""Number of times added between two commands to a linkage."""
_INSTANT = 1e-9
"""Time difference below which two times are equal up to rounding [s]."""


def gripper_time(before: GripperCommand, after: GripperCommand, speed: float) -> float:
    """Time that fingers of a speed [m/s] need from the goal of one command to the goal of the next [s]."""
    return abs(after.width - before.width) / 2 / speed + FORCE_RAMP * (after.force != before.force)


def stand_still(
    label: str, duration: float, q: FloatArray, gripper: GripperCommand, touches: frozenset[str] | None
) -> Segment:
    """Return a segment in which the arm rests at q, shape (n,) [rad], for `duration` [s] while the gripper moves."""
    return Segment(label, duration, gripper, 1, np.array([0.0, duration]), q[None], touches)


class Command(NamedTuple):
    """Commands to the controllers of arm and gripper over time.

    Attributes:
        arm: Desired positions of the arm's joints [rad].
        times: Times between which the commands of the fingers are interpolated, shape (m,) [s].
        fingers: Desired positions of the driven joints of the fingers at these times, shape (driven, m) [m or rad].
        grip: Efforts of these joints that grip, added to those of their controllers, shape (driven, m) [N or N m].
    """

    arm: Trajectory
    times: FloatArray
    fingers: FloatArray
    grip: FloatArray

    def positions(self, parts: tuple[bool, bool]) -> Trajectory:
        """Return the desired positions of the arm, the gripper, or both."""
        fingers = PiecewisePolynomial.FirstOrderHold(self.times, self.fingers)
        if not all(parts):
            return self.arm if parts[0] else fingers
        stacked = StackedTrajectory(rowwise=True)
        stacked.Append(self.arm)
        stacked.Append(fingers)
        return stacked

    def efforts(self, parts: tuple[bool, bool]) -> Trajectory:
        """Return the efforts added to those of the position controllers of the arm, the gripper, or both."""
        rows = [np.zeros((self.arm.rows(), len(self.times))), self.grip]
        return PiecewisePolynomial.FirstOrderHold(self.times, np.vstack([rows[i] for i in (0, 1) if parts[i]]))


def command_motion(
    gripper: Gripper, q: FloatArray, before: GripperCommand, segments: Sequence[Segment], end: float
) -> Command:
    """Return the commands of a motion from 0 to `end` [s]. The arm rests after the last segment.

    Args:
        gripper: Gripper that obeys.
        q: Commanded positions of the arm before the motion, shape (n,) [rad].
        before: Command to the gripper in force before the motion.
        segments: Segments of the motion, possibly none.
        end: End of the commands [s], later than both the last segment and `obedience_time`.
    """
    arm, start = _arm_pieces(segments)
    if segments:
        q = segments[-1].control_points[-1]
    arm.append(PiecewisePolynomial.ZeroOrderHold([start, end], np.column_stack([q, q])))
    times, widths, forces = _gripper_knots(before, segments, end, gripper.speed)
    if gripper.shares is None:  # positions of a linkage are no straight line between two widths
        times, widths, forces = _refine(times, widths, forces)
    return Command(CompositeTrajectory(arm), times, gripper.drive(widths), gripper.efforts(widths, forces))


def _refine(times: FloatArray, *values: FloatArray) -> tuple[FloatArray, ...]:
    """Return values at times, with `_BETWEEN` more times in each interval."""
    finer = np.unique(np.linspace(times[:-1], times[1:], _BETWEEN + 2))
    return finer, *(np.interp(finer, times, each) for each in values)


def arm_trajectory(segments: Sequence[Segment]) -> Trajectory:
    """Positions of the arm's joints [rad] from 0 to the end of the last segment.

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


def obedience_time(gripper: GripperCommand, segments: Sequence[Segment], speed: float) -> float:
    """Time at which fingers of a speed [m/s] have obeyed the last command of a motion [s], possibly after its end."""
    return max((change.arrival for change in _changes(gripper, segments, speed)), default=0.0)


def gripper_schedule(
    gripper: GripperCommand, segments: Sequence[Segment], speed: float
) -> list[tuple[float, GripperCommand]]:
    """Return the commands to the hand with the times from which they are in force [s], first `gripper` from 0 on.

    Args:
        gripper: Command in force before the motion.
        segments: Segments of the motion.
        speed: Speed of each finger [m/s].
    """
    return [(0.0, gripper), *((change.start, change.after) for change in _changes(gripper, segments, speed))]


class _Change(NamedTuple):
    """Movement of the hand from the goal of one command to the goal of the next, from `start` to `arrival` [s]."""

    start: float
    arrival: float
    before: GripperCommand
    after: GripperCommand


def _changes(gripper: GripperCommand, segments: Sequence[Segment], speed: float) -> Iterator[_Change]:
    """Yield the movements of the hand. A command starts with its segment, or once the one before is obeyed."""
    start = arrival = 0.0
    for segment in segments:
        if segment.gripper != gripper:
            begin = start if start > arrival + _INSTANT else arrival
            arrival = begin + gripper_time(gripper, segment.gripper, speed)
            yield _Change(begin, arrival, gripper, segment.gripper)
            gripper = segment.gripper
        start += segment.duration


def _gripper_knots(
    gripper: GripperCommand, segments: Sequence[Segment], end: float, speed: float
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Times, widths and forces between which the commands of the hand are interpolated.

    The hand grips after its fingers have arrived, and lets go before they move.
    """
    knots = {0.0: (gripper.width, gripper.force)}
    for start, arrival, before, after in _changes(gripper, segments, speed):
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
