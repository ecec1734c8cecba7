"""Measures of an arm's reach: random poses, and grasps from above on a table."""

from typing import NamedTuple

import numpy as np

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import FloatArray
from ictamp_drake.robots.alone import Alone
from ictamp_drake.robots.analytic import AnalyticKinematics
from ictamp_drake.robots.choice import free_angles, try_poses
from ictamp_drake.robots.panda import PandaKinematics
from ictamp_drake.robots.robot import Robot

STARTS = 32
"""Number of starts of the numeric kind for each pose."""
_STEP = 0.2
"""Grid step over the free joint [rad]."""
_POSES = 100
"""Number of random poses."""
_SAMPLES = 5000
"""Number of random postures from which the reach is read."""
_ABOVE = 0.05
"""Height of G above the table [m]."""
_SPARE = 0.001
"""Distance by which links may enter the table [m]: the base stands on it."""


class Reach(NamedTuple):
    """Reach of an arm.

    Attributes:
        kind: Kind of inverse kinematics in use.
        solved: Share of random reachable poses with a posture.
        farthest: Largest distance from the base to G [m].
        table: Share of a grid of grasps from above, on a table at the height of the base, that have a free posture.
    """

    kind: str
    solved: float
    farthest: float
    table: float


def measure_reach(robot: Robot) -> Reach:
    """Measure the reach of an arm.

    Raises:
        IctampError: The arm has no inverse kinematics of its kind.
    """
    kinematics = robot.inverse("auto", STARTS)
    kinds = {PandaKinematics: "closed form", AnalyticKinematics: "analytic"}
    lower, upper = limits = np.clip(robot.chain.limits, -np.pi, np.pi)
    q = np.random.default_rng(0).uniform(lower, upper, (_SAMPLES, len(lower)))
    X_BG = top_grasps(max(_ABOVE, robot.gripper.hand.lowest_grasp))
    found, pose = kinematics.postures(X_BG, free_angles(kinematics.free, limits, _STEP), robot.chain.limits)
    alone, fingers = Alone(robot, -_SPARE), robot.gripper.positions(robot.gripper.opening)
    reached: set[int] = set()
    for each, number in zip(found, pose.tolist(), strict=True):
        if number not in reached and alone.is_free(each, fingers):
            reached.add(number)
    return Reach(
        kind=kinds.get(type(kinematics), "numeric"),
        solved=try_poses(kinematics, robot.chain, _POSES, _STEP).solved,
        farthest=float(np.linalg.norm(robot.forward(q)[:, :3, 3], axis=1).max()),
        table=len(reached) / len(X_BG),
    )


def top_grasps(height: float) -> FloatArray:
    """Poses in the base of a hand that points down at a height [m], on a grid in front of the base, shape (n, 4, 4)."""
    places = np.array(np.meshgrid(np.linspace(0.3, 0.7, 5), np.linspace(-0.4, 0.4, 5), np.arange(8) * np.pi / 4))
    x, y, yaw = places.reshape(3, -1)
    X = np.zeros((len(x), 4, 4))
    X[:, 0, 0], X[:, 0, 1], X[:, 1, 0], X[:, 1, 1] = np.cos(yaw), np.sin(yaw), np.sin(yaw), -np.cos(yaw)
    X[:, 2, 2], X[:, 3, 3] = -1.0, 1.0
    X[:, 0, 3], X[:, 1, 3], X[:, 2, 3] = x, y, height
    return X


def check_reach(reach: Reach) -> list[IctampError]:
    """Return a mistake if the arm cannot reach a table at the height of its base."""
    if reach.table > 0:
        return []
    problem = "no grasp from above, 0.3 to 0.7 m in front of the base, can be reached on a table at its height"
    advice = "look with --show whether z of the base points up, and z of the grasp frame down at home"
    return [IctampError(Code.NOT_REACHABLE, problem, field="base", advice=advice)]
