"""The choice between kinds of inverse kinematics."""

from importlib.util import find_spec
from typing import NamedTuple

import numpy as np

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.protocols import InverseKinematics
from ictamp_drake.core.types import FloatArray, KinematicsKind
from ictamp_drake.robots.chain import Chain
from ictamp_drake.robots.numeric import NumericKinematics
from ictamp_drake.robots.panda import PandaKinematics, is_panda

OPTION = "skills.motion.kinematics.kind"
"""Option of the programs that says the kind."""

_POSES = 40
"""Number of random poses on which an analytic solution is tried."""

_STEP = 0.1
"""Grid step over the free joint in these trials [rad]."""

_ENOUGH = 0.95
"""Least share of these poses that an analytic solution must solve for `auto` to choose it."""


def create_inverse_kinematics(
    kind: KinematicsKind, chain: Chain, starts: int, field: str = OPTION
) -> InverseKinematics:
    """Create the inverse kinematics of an arm.

    Args:
        kind: Kind wanted. `auto` is the first of closed form, analytic and numeric that serves the arm: the closed form
            if the arm is a Panda, analytic if it solves random poses of this arm, by forward kinematics.
        chain: Arm.
        starts: Number of starts for each pose, numeric kind only.
        field: Field that says the kind, for errors.

    Raises:
        IctampError: The arm has no solution of this kind, or the package that knows it is missing.
    """
    if kind in ("auto", "closed-form") and is_panda(chain):
        return PandaKinematics()
    if kind == "analytic" or (kind == "auto" and find_spec("eaik")):
        analytic = _create_analytic(chain, field)
        if analytic and (kind == "analytic" or try_poses(analytic, chain, _POSES, _STEP).solved >= _ENOUGH):
            return analytic
    if kind in ("auto", "numeric"):
        return NumericKinematics(chain, starts)
    raise IctampError(
        Code.CONFLICT,
        "the arm has no {value} inverse kinematics",
        field=field,
        value=kind,
        advice="choose numeric, which serves any arm",
    )


def _create_analytic(chain: Chain, field: str) -> InverseKinematics | None:
    """Create the analytic solution, with the free joint that gives the most postures; None where none is known."""
    if not find_spec("eaik"):
        advice = 'run pip install "ictamp_drake[ik]"'
        raise IctampError(Code.NOT_INSTALLED, "eaik is not installed", field=field, value="analytic", advice=advice)
    from ictamp_drake.robots.analytic import AnalyticKinematics, lockable  # noqa: PLC0415

    found = (AnalyticKinematics(chain, joint) for joint in lockable(chain))
    return max(found, key=lambda each: try_poses(each, chain, _POSES, _STEP).postures, default=None)


class Trial(NamedTuple):
    """Success on random reachable poses.

    Attributes:
        solved: Share of the poses with a posture.
        postures: Mean number of postures of a pose.
    """

    solved: float
    postures: float


def try_poses(kinematics: InverseKinematics, chain: Chain, count: int, step: float) -> Trial:
    """Solve random reachable poses. Only postures that forward kinematics confirm count.

    Args:
        kinematics: Inverse kinematics.
        chain: Its arm.
        count: Number of poses: those of postures drawn within the limits.
        step: Grid step over the free joint [rad].
    """
    lower, upper = limits = np.clip(chain.limits, -np.pi, np.pi)
    X_BG = chain.forward(np.random.default_rng(0).uniform(lower, upper, (count, len(lower))))
    found, pose = kinematics.postures(X_BG, free_angles(kinematics.free, limits, step), limits)
    true = pose[chain.is_at(found, X_BG[pose])]
    return Trial(len(np.unique(true)) / count, len(true) / count)


def free_angles(free: int | None, limits: FloatArray, step: float) -> FloatArray:
    """Angles of the free joint within its limits or a full turn, shape (a,) [rad]; one angle if no joint is free."""
    if free is None:
        return np.zeros(1)
    lower, upper = limits[:, free]
    return np.arange(max(lower, -np.pi), min(upper, np.pi), step)
