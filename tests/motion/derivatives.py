"""Derivatives of a trajectory, which only tests need."""

import numpy as np
from scipy.interpolate import BSpline

from ictamp_drake.core.types import FloatArray
from ictamp_drake.motion.trajectory import Trajectory


def derivatives(trajectory: Trajectory, times: FloatArray, order: int) -> FloatArray:
    """Derivatives of the given order at times [s], shape (m,), as an array of shape (m, 7) [rad/s^order]."""
    spline = BSpline(trajectory.knots, trajectory.control_points, trajectory.order - 1)
    return np.asarray(spline.derivative(order)(times))
