"""Speed at which a held box is carried, low enough for it to stay where it is between the fingers."""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ictamp_drake.core.types import FloatArray
from ictamp_drake.motion.config import CarryingConfig
from ictamp_drake.motion.trajectory import Trajectory
from ictamp_drake.robots.grip import GRAVITY, friction_load

_MOMENTS = 49
"""Number of moments of a trajectory at which loads are computed."""
_STEP = 1e-3
"""Time step of finite differences [s]."""
_LEAST_SPARE = 0.02
"""Minimum share of the friction that is left for acceleration. With less, motions would take too long."""


class Load(NamedTuple):
    """Box between the fingers.

    Attributes:
        p_GO: Position of its center in G, shape (3,) [m].
        mass: Mass [kg].
        bearable: Largest load on the friction of the pads [N].
        lever: Lever arm of the pads' friction, see `Hand.lever` [m].
    """

    p_GO: FloatArray
    mass: float
    bearable: float
    lever: float


def slow_down(
    trajectory: Trajectory,
    forward: Callable[[FloatArray], FloatArray],
    box: Load,
    time_step: float,
    config: CarryingConfig,
) -> Trajectory | None:
    """Return the trajectory, slowed down if the box would slide in the fingers; None if it would slide at any speed.

    Args:
        trajectory: Motion of the arm.
        forward: Function from joint positions to X_WG, (m, n) [rad] -> (m, 4, 4).
        box: Box in the hand.
        time_step: Time step of physics [s].
        config: Constants of the speed.
    """
    times = np.linspace(0.0, trajectory.duration, _MOMENTS)
    R_WG, acceleration, bend = _accelerations(trajectory, forward, box.p_GO, times)
    weight, push = (
        friction_load(box.p_GO, box.mass * np.einsum("nji,nj->ni", R_WG, along), box.lever)
        for along in (np.broadcast_to([0.0, 0.0, GRAVITY], acceleration.shape), acceleration)
    )
    spare = box.bearable / config.reserve - weight
    if np.any(spare < _LEAST_SPARE * box.bearable):
        return None
    # A speed lower by a factor lowers accelerations by its square. The load of two forces is at most the sum of theirs.
    held = np.sqrt(np.max(push / spare))
    # In each step the box follows the tangent and the hand follows the curve. The difference adds up to this slide.
    slides = np.cumsum(np.einsum("nji,nj->ni", R_WG, bend)[:, [0, 2]], axis=0) * time_step / 2 * times[1]
    followed = np.linalg.norm(slides, axis=1).max() / config.slide
    return trajectory.slowed(max(1.0, held, followed))


def _accelerations(
    trajectory: Trajectory, forward: Callable[[FloatArray], FloatArray], p_GO: FloatArray, times: FloatArray
) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Compute motion at times, shape (n,) [s], by finite differences.

    Returns:
        R_WG, shape (n, 3, 3), the acceleration of the box's center in W, and the part of it that is due to the curve of
        the path, both of shape (n, 3) [m/s^2].
    """
    q, v, a = trajectory.derivatives(times)
    along, across = _STEP * v, _STEP**2 / 2 * a
    X_WGs = forward(np.concatenate([q, q + along + across, q - along + across, q + along, q - along]))
    now, after, before, ahead, behind = np.split(X_WGs[:, :3, :3] @ p_GO + X_WGs[:, :3, 3], 5)
    acceleration = (after - 2 * now + before) / _STEP**2
    bend = (ahead - 2 * now + behind) / _STEP**2
    return X_WGs[: len(q), :3, :3], acceleration, bend
