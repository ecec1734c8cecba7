"""Trajectories of the arm: B-splines from rest to rest."""

from collections.abc import Callable, Collection
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from scipy.interpolate import BSpline

from ictamp_drake.core.types import FloatArray, GripperCommand, Segment

_PROBES = 33
"""Number of points of a trajectory at which the hand's way is measured."""
_UNEVENNESS = 1.25
"""Assumed ratio of the hand's top speed to its mean speed between two of these points."""


@dataclass(frozen=True, eq=False)
class Trajectory:
    """A B-spline in joint space that starts and ends at rest.

    Attributes:
        order: Degree + 1.
        knots: Knots from 0 to the duration [s], shape (n + order,).
        control_points: Control points [rad], shape (m, n).
    """

    order: int
    knots: FloatArray
    control_points: FloatArray

    @property
    def duration(self) -> float:
        """Duration [s]."""
        return float(self.knots[-1])

    @property
    def start(self) -> FloatArray:
        """Joint positions at the start, shape (n,) [rad]."""
        return self.control_points[0]

    @property
    def end(self) -> FloatArray:
        """Joint positions at the end, shape (n,) [rad]."""
        return self.control_points[-1]

    @cached_property
    def _spline(self) -> BSpline:
        return BSpline(self.knots, self.control_points, self.order - 1)

    def positions(self, times: FloatArray) -> FloatArray:
        """Joint positions at times, shape (m,) [s], as an array of shape (m, n) [rad]."""
        return np.asarray(self._spline(times))

    def derivatives(self, times: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray]:
        """Joint positions [rad], velocities and accelerations at times, shape (m,) [s], each of shape (m, n)."""
        first, second = self._spline.derivative(1), self._spline.derivative(2)
        return self.positions(times), np.asarray(first(times)), np.asarray(second(times))

    def slowed(self, factor: float) -> "Trajectory":
        """The trajectory along the same way, longer in time by a factor of at least 1."""
        return self if factor == 1 else Trajectory(self.order, factor * self.knots, self.control_points)

    def reversed(self) -> "Trajectory":
        """The trajectory back along the same way in the same time."""
        return Trajectory(self.order, self.duration - self.knots[::-1], self.control_points[::-1])

    def segment(self, label: str, gripper: GripperCommand, touches: Collection[str] | None = None) -> Segment:
        """Segment of a motion, on which the arm or what it holds may touch some bodies; see `Segment`."""
        known = None if touches is None else frozenset(touches)
        return Segment(label, self.duration, gripper, self.order, self.knots, self.control_points, known)


def sample(trajectory: Trajectory, forward: Callable[[FloatArray], FloatArray], step: float, turn: float) -> FloatArray:
    """Joint positions along a trajectory, both ends included, shape (m, n) [rad].

    Between neighbors the hand moves at most `step` [m], and neither hand nor any joint turns more than `turn` [rad].

    Args:
        trajectory: Trajectory to sample.
        forward: Function from many joint positions to X_WG, (m, n) -> (m, 4, 4).
        step, turn: Limits, see above.
    """
    times = np.linspace(0.0, trajectory.duration, _PROBES)
    qs = trajectory.positions(times)
    X_WGs = forward(qs)
    moved = np.linalg.norm(np.diff(X_WGs[:, :3, 3], axis=0), axis=1)
    # |R - R'| = 2 sqrt(2) sin(angle / 2), which is at least 0.9 sqrt(2) angle below 1.5 rad
    turned = np.linalg.norm(np.diff(X_WGs[:, :3, :3], axis=0), axis=(1, 2)) / (0.9 * np.sqrt(2))
    jointed = np.abs(np.diff(qs, axis=0)).max(axis=1)
    parts = np.maximum(moved / step, np.maximum(turned, jointed) / turn)
    counts = np.ceil(_UNEVENNESS * parts).astype(int).clip(1)
    pieces = [np.linspace(a, b, n, endpoint=False) for a, b, n in zip(times, times[1:], counts, strict=False)]
    return trajectory.positions(np.append(np.concatenate(pieces), trajectory.duration))
