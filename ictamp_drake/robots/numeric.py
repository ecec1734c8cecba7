"""Inverse kinematics of any arm by damped least squares from many starts."""

import numpy as np
from numpy.typing import NDArray

from ictamp_drake.core.types import FloatArray
from ictamp_drake.robots.chain import TOLERANCE, Chain, middle_of, pose_error, turn_into

_ITERATIONS = 40

_LENGTH = 0.3
"""Lever arm that converts rotation to distance [m]."""

_STEP = 0.7
"""Largest change of a joint in one iteration [rad]."""

_POSES = 64
"""Number of poses solved at a time, which bounds the memory."""


class NumericKinematics:
    """Postures found from starts spread over the joint limits, the same for every pose. Some may be missed."""

    free: int | None = None
    finds_all = False

    def __init__(self, chain: Chain, starts: int) -> None:
        self._chain = chain
        self._shares = np.random.default_rng(0).uniform(size=(starts, len(chain.axes)))

    def postures(
        self, X_BG: FloatArray, _angles: FloatArray, limits: FloatArray, /
    ) -> tuple[FloatArray, NDArray[np.intp]]:
        """See `core.protocols.InverseKinematics`."""
        found, poses = [np.empty((0, limits.shape[1]))], [np.empty(0, dtype=np.intp)]
        for first in range(0, len(X_BG), _POSES):
            q, pose = self._descend(X_BG[first : first + _POSES], limits)
            found.append(q)
            poses.append(first + pose)
        return np.concatenate(found), np.concatenate(poses)

    def _descend(self, X_BG: FloatArray, limits: FloatArray) -> tuple[FloatArray, NDArray[np.intp]]:
        """Return the postures reached from the starts, and the number of each one's pose."""
        middle = middle_of(limits)
        lower, upper = np.maximum(limits[0], middle - np.pi), np.minimum(limits[1], middle + np.pi)
        turns = limits[1] - limits[0] >= 2 * np.pi  # joints that come back to the other end
        q = np.tile(lower + self._shares * (upper - lower), (len(X_BG), 1))
        pose = np.repeat(np.arange(len(X_BG)), len(self._shares))
        damping, last = np.full(len(q), 1e-2), np.full(len(q), np.inf)
        found, poses = [], []
        for _ in range(_ITERATIONS):
            X, J = self._chain.forward_with_jacobian(q)
            error = pose_error(X, X_BG[pose])
            done = np.linalg.norm(error.reshape(-1, 2, 3), axis=2).max(axis=1) < TOLERANCE / 10
            found.append(q[done])
            poses.append(pose[done])
            if done.all():
                break
            error[:, :3] *= _LENGTH
            J[:, :3] *= _LENGTH
            size = np.linalg.norm(error, axis=1)
            damping = np.clip(damping * np.where(size < last, 0.2, 4.0), 1e-8, 1.0)
            q, pose, J, error, damping, last = (each[~done] for each in (q, pose, J, error, damping, size))
            JT = J.transpose(0, 2, 1)
            step = (JT @ np.linalg.solve(J @ JT + damping[:, None, None] * np.eye(6), error[:, :, None]))[:, :, 0]
            q = q + step * np.minimum(1.0, _STEP / np.maximum(np.abs(step).max(axis=1, keepdims=True), 1e-9))
            q = np.where(turns, turn_into(q, limits), q.clip(lower, upper))
        return np.concatenate(found), np.concatenate(poses)
