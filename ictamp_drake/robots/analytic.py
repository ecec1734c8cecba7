"""Inverse kinematics of most arms of six or seven joints, by decomposition into known subproblems (package `eaik`).

An arm of seven joints has one of them locked at each angle of a grid.
"""

from functools import lru_cache

import numpy as np
from eaik.IK_HP import HPRobot
from numpy.typing import NDArray

from ictamp_drake.core.types import FloatArray
from ictamp_drake.robots.chain import Chain, is_within, turn_into

_SAMPLE = 0.3
"""Angle of a locked joint at which a decomposition is asked for [rad]."""


class AnalyticKinematics:
    """All postures of an arm, with the free joint at given angles. Check `lockable` first."""

    finds_all = True

    def __init__(self, chain: Chain, free: int | None) -> None:
        self.free = free
        self._chain = chain
        self._solver = lru_cache(maxsize=None)(self._make_solver)

    def _make_solver(self, angle: float) -> HPRobot:
        return _solver(self._chain, self.free, angle)

    def postures(
        self, X_BG: FloatArray, angles: FloatArray, limits: FloatArray, /
    ) -> tuple[FloatArray, NDArray[np.intp]]:
        """See `core.protocols.InverseKinematics`."""
        targets = X_BG.copy()
        targets[:, :3, :3] = X_BG[:, :3, :3] @ self._chain.rotation.T
        solvers = [self._solver(angle) for angle in (angles if self.free is not None else [0.0])]
        solutions = [solver.IK(target).Q for target in targets for solver in solvers]
        counts = [len(each) for each in solutions]
        pose = np.repeat(np.repeat(np.arange(len(X_BG)), len(solvers)), counts)
        q = np.array([row for each in solutions for row in each]).reshape(-1, limits.shape[1])
        q = turn_into(q, limits)
        inside = is_within(q, limits)
        q, pose = q[inside], pose[inside]
        true = self._chain.is_at(q, X_BG[pose])
        return q[true], pose[true]


def lockable(chain: Chain) -> list[int | None]:
    """Joints of which one must be locked for the arm to be solved; [None] if none must, [] if it cannot be solved."""
    joints: list[int | None] = {6: [None], 7: [*range(7)]}.get(len(chain.axes), [])
    return [joint for joint in joints if _solver(chain, joint, _SAMPLE).hasKnownDecomposition()]


def _solver(chain: Chain, free: int | None, angle: float) -> HPRobot:
    return HPRobot(chain.axes, chain.offsets, [] if free is None else [(free, angle)])
