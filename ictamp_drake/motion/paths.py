"""Collision-free paths by sampling, with RRT-Connect from the Open Motion Planning Library."""

from collections.abc import Callable

import numpy as np
from ompl import base, geometric, util

from ictamp_drake.core.types import FloatArray
from ictamp_drake.motion.config import PathConfig

util.setLogLevel(util.LOG_NONE)


def find_path(
    q0: FloatArray,
    q1: FloatArray,
    is_free: Callable[[FloatArray], bool],
    *,
    limits: tuple[FloatArray, FloatArray],
    rng: np.random.Generator,
    config: PathConfig,
) -> FloatArray | None:
    """A path of straight edges from q0 to q1, shape (m, n) [rad], or None when no checks are left.

    Args:
        q0, q1: Joint positions at the ends, shape (n,) [rad].
        is_free: Whether a configuration is free of collisions.
        limits: Lower and upper joint limits, each of shape (n,) [rad].
        rng: Random numbers that seed the library's own, so that the same state gives the same path.
        config: Constants of the search.
    """
    util.RNG.setSeed(int(rng.integers(1, 2**31)))
    space = _space(q0, q1, limits, config)
    checker = _Checker(is_free, len(q0))
    information = base.SpaceInformation(space)
    information.setStateValidityChecker(checker.check)
    information.setup()
    problem = base.ProblemDefinition(information)
    problem.setStartAndGoalStates(_state(space, q0), _state(space, q1))
    planner = geometric.RRTConnect(information)
    planner.setRange(config.edge)
    planner.setProblemDefinition(problem)
    planner.setup()
    planner.solve(base.PlannerTerminationCondition(lambda: checker.checks >= config.max_checks))
    if not problem.hasExactSolution():
        return None
    path = problem.getSolutionPath()
    geometric.PathSimplifier(information).partialShortcutPath(path, config.shortcuts)
    return np.array([_array(path.getState(i), len(q0)) for i in range(path.getStateCount())])


class _Checker:
    """Counts its calls. It must not refer to the library's objects: they refer to it and would never be freed."""

    def __init__(self, is_free: Callable[[FloatArray], bool], joints: int) -> None:
        self.checks = 0
        self._is_free = is_free
        self._joints = joints

    def check(self, state: base.State) -> bool:
        self.checks += 1
        return self._is_free(_array(state, self._joints))


def _space(
    q0: FloatArray, q1: FloatArray, limits: tuple[FloatArray, FloatArray], config: PathConfig
) -> base.RealVectorStateSpace:
    """Space of the joint ranges around both ends, which lie inside even where they violate the limits."""
    low, high = np.minimum(q0, q1), np.maximum(q0, q1)
    lower = np.minimum(np.maximum(low - config.margin, limits[0]), low)
    upper = np.maximum(np.minimum(high + config.margin, limits[1]), high)
    bounds = base.RealVectorBounds(len(q0))
    for i, (least, most) in enumerate(zip(lower, upper, strict=True)):
        bounds.setLow(i, float(least))
        bounds.setHigh(i, float(most))
    space = base.RealVectorStateSpace(len(q0))
    space.setBounds(bounds)
    space.setLongestValidSegmentFraction(config.step / space.getMaximumExtent())
    return space


def _state(space: base.RealVectorStateSpace, q: FloatArray) -> base.State:
    state = space.allocState()
    for i, value in enumerate(q):
        state[i] = float(value)
    return state


def _array(state: base.State, joints: int) -> FloatArray:
    return np.array([state[i] for i in range(joints)])
