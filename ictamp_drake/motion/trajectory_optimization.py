"""The quickest splines within the joints' limits: closed forms, and Drake's kinematic trajectory optimization."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from pydrake.planning import KinematicTrajectoryOptimization
from pydrake.solvers import Binding, LinearConstraint, SnoptSolver, SolverOptions
from scipy.interpolate import BSpline

from ictamp_drake.core.types import FloatArray
from ictamp_drake.motion.config import MIN_DURATION, TrajectoryConfig
from ictamp_drake.motion.splines import differentiation, knots, paces
from ictamp_drake.motion.trajectory import Trajectory
from ictamp_drake.robots.robot import Robot

_TOLERANCE = 1e-3
"""Optimality tolerance of SNOPT. Finer ones shorten no trajectory by more than a thousandth."""


class HalfSpace(NamedTuple):
    """A demand on one moment of a trajectory: normal @ q >= offset.

    Attributes:
        share: Moment as a fraction of the duration.
        normal: Normal in joint space, shape (n,).
        offset: Bound in the unit of normal times radian.
    """

    share: float
    normal: FloatArray
    offset: float


class TrajectoryOptimizer:
    """Finds the fastest splines within the joints' limits. Keeps up to two programs per number of control points."""

    def __init__(self, robot: Robot, config: TrajectoryConfig | None = None) -> None:
        self.config = config or TrajectoryConfig()
        self.lower, self.upper = robot.lower, robot.upper
        fractions = np.array([self.config.velocity, self.config.acceleration, self.config.jerk])
        self.bounds = np.array([robot.velocity, robot.acceleration, robot.jerk]) * fractions[:, None]
        """Largest velocity, acceleration and jerk of each joint, shape (3, n) [rad/s, rad/s^2, rad/s^3]."""
        self._programs: dict[tuple[int, int], _TrajectoryProgram] = {}

    def connect(self, q0: FloatArray, q1: FloatArray) -> Trajectory:
        """Trajectory from q0 to q1, both of shape (n,) [rad], whatever is in the way."""
        return self.adjust(self.follow(np.array([q0, q1]), self.config.control_points), np.inf)

    def follow_corridor(self, path: FloatArray, radius: float, control_points: int) -> Trajectory:
        """Trajectory through the corridor around a path, from its first to its last row.

        Args:
            path: Joint positions joined by straight lines, shape (m, n) [rad].
            radius: Distance by which each coordinate of a control point may leave the path [rad].
            control_points: Number of control points, at least `LEAST_POINTS`. More follow a crooked path more closely.
        """
        return self._solve(_spread(path, _profile(control_points)), radius)

    def follow(self, path: FloatArray, control_points: int) -> Trajectory:
        """Trajectory along a path, in closed form: all control points lie on it, and only the pace is chosen.

        Args:
            path: Joint positions joined by straight lines, shape (m, n) [rad].
            control_points: Number of control points, at least `LEAST_POINTS`.
        """
        efforts = (np.abs(np.diff(path, axis=0)) / self.bounds[1]).max(axis=1)  # acceleration limits short ways
        points = _interpolate_path(path, efforts, paces(control_points, self.config.order))
        durations = self.shortest_durations(points)
        best = int(np.argmin(durations))
        return self._trajectory(points[best], float(durations[best]))

    def adjust(self, trajectory: Trajectory, radius: float, demands: Sequence[HalfSpace] = ()) -> Trajectory:
        """Variant of a trajectory whose control points moved by at most `radius` [rad] to meet the demands."""
        return self._solve(trajectory.control_points, radius, demands)

    def _solve(self, guess: FloatArray, radius: float, demands: Sequence[HalfSpace] = ()) -> Trajectory:
        """Solve without jerk limits, which take a third of the work, and with them only if the result breaks them."""
        for limits in (2, 3):
            points = self._program(len(guess), limits).solve(guess, radius, demands)
            duration = float(self.shortest_durations(points))
            if duration <= self.shortest_durations(points, limits):
                break
        return self._trajectory(points, duration)

    def _trajectory(self, points: FloatArray, duration: float) -> Trajectory:
        return Trajectory(self.config.order, knots(len(points), self.config.order) * duration, points)

    def _program(self, control_points: int, limits: int) -> "_TrajectoryProgram":
        if (control_points, limits) not in self._programs:
            self._programs[control_points, limits] = _TrajectoryProgram(self, control_points, limits)
        return self._programs[control_points, limits]

    def shortest_durations(self, points: FloatArray, limits: int = 3) -> FloatArray:
        """Minimum durations [s] for the control points of splines, shape (..., m, n) -> (...).

        Args:
            points: Control points.
            limits: Number of limits that count: of velocity, acceleration and jerk, in this order.
        """
        found: FloatArray = np.full(points.shape[:-2], MIN_DURATION)
        matrices = differentiation(points.shape[-2], self.config.order)
        for order, (matrix, bound) in enumerate(zip(matrices[:limits], self.bounds, strict=False), start=1):
            used = np.abs(matrix @ points) / bound  # the spline stays below its control points
            found = np.maximum(found, used.max(axis=(-2, -1)) ** (1 / order))
        return found


class _TrajectoryProgram:
    def __init__(self, optimizer: TrajectoryOptimizer, control_points: int, limits: int) -> None:
        self._optimizer, self._limits = optimizer, limits
        config = optimizer.config
        self._trajectory = KinematicTrajectoryOptimization(len(optimizer.lower), control_points, config.order)
        program = self._trajectory.get_mutable_prog()
        self._points, self._duration = self._trajectory.control_points(), self._trajectory.duration()
        add = self._trajectory.AddVelocityBounds, self._trajectory.AddAccelerationBounds, self._trajectory.AddJerkBounds
        for add_bounds, bound in zip(add[:limits], optimizer.bounds, strict=False):
            add_bounds(-bound, bound)
        self._trajectory.AddDurationConstraint(MIN_DURATION, config.max_duration)
        self._trajectory.AddDurationCost(1.0)
        flat = self._points.T.ravel()
        self._corridor = program.AddBoundingBoxConstraint(0.0, 0.0, flat).evaluator()
        self._pull = program.AddQuadraticErrorCost(np.eye(flat.size), np.zeros(flat.size), flat).evaluator()
        self._solver, self._options = SnoptSolver(), SolverOptions()
        self._options.SetOption(SnoptSolver.id(), "Major iterations limit", config.iterations)
        self._options.SetOption(SnoptSolver.id(), "Iterations limit", 50 * config.iterations)

    def solve(self, guess: FloatArray, radius: float, demands: Sequence[HalfSpace]) -> FloatArray:
        """Control points of a quick trajectory, at most `radius` from those of the guess, shape (m, n).

        Any control points obey the limits when time is stretched. The result of an unfinished optimization can
        therefore be used if it is better than the guess. Demands that cannot be met are left unmet.
        """
        corridor = self._set_corridor(guess, radius)
        weight = self._optimizer.config.straightness / guess.size
        self._pull.UpdateCoefficients(2 * weight * np.eye(guess.size), -2 * weight * guess.ravel())
        program = self._trajectory.get_mutable_prog()
        duration = float(self._optimizer.shortest_durations(guess, self._limits))
        program.SetInitialGuess(self._points, guess.T)
        program.SetInitialGuess(self._duration, duration)
        added = [self._add_demands(demands)] if demands else []
        solution = self._solver.Solve(program, None, self._options).GetSolution(self._points).T
        for binding in added:
            program.RemoveConstraint(binding)
        points = np.clip(solution, *corridor)
        shorter = float(self._optimizer.shortest_durations(points, self._limits))
        return points if (demands or shorter <= duration) and np.isfinite(shorter) else guess

    def _add_demands(self, demands: Sequence[HalfSpace]) -> Binding[LinearConstraint]:
        order = self._optimizer.config.order
        shares = np.array([demand.share for demand in demands])
        basis = BSpline.design_matrix(shares, knots(self._points.shape[1], order), order - 1)
        normals = np.array([demand.normal for demand in demands])
        rows = np.einsum("ri,rj->rij", basis.toarray(), normals).reshape(len(demands), -1)
        offsets = [demand.offset for demand in demands]
        program, flat = self._trajectory.get_mutable_prog(), self._points.T.ravel()
        return program.AddLinearConstraint(rows, offsets, np.full(len(demands), np.inf), flat)

    def _set_corridor(self, guess: FloatArray, radius: float) -> tuple[FloatArray, FloatArray]:
        """Bound the control points. The first and last three coincide, so velocity and acceleration end at zero."""
        lower = np.maximum(guess - radius, np.minimum(self._optimizer.lower, guess))
        upper = np.minimum(guess + radius, np.maximum(self._optimizer.upper, guess))
        for bound in (lower, upper):
            bound[:3], bound[-3:] = guess[0], guess[-1]
        self._corridor.set_bounds(lower.ravel(), upper.ravel())
        return lower, upper


def _profile(n: int) -> FloatArray:
    """Initial place of each control point along the path, with bell-shaped velocity, shape (n,) from 0 to 1."""
    s = np.clip((np.arange(n) - 2) / (n - 5), 0, 1)
    return s * s * (3 - 2 * s)


def _spread(path: FloatArray, shares: FloatArray) -> FloatArray:
    """Points at fractions of the path's length, shape (m, n)."""
    return _interpolate_path(path, np.linalg.norm(np.diff(path, axis=0), axis=1), shares)


def _interpolate_path(path: FloatArray, lengths: FloatArray, shares: FloatArray) -> FloatArray:
    """Points at fractions of a path's length, shape (...) -> (..., n), given the lengths of its pieces."""
    places = np.append(0.0, np.cumsum(lengths))
    return np.stack([np.interp(shares * places[-1], places, column) for column in path.T], axis=-1)
