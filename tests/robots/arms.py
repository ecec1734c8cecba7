"""Arms for tests: the Panda, one of six joints, and one whose wrist no decomposition is known for."""

import numpy as np

from ictamp_drake.robots.chain import Chain
from ictamp_drake.robots.robot import find_robot

PANDA = find_robot().chain

SIX = Chain(
    axes=np.array([[0, 0, 1], [0, 1, 0], [0, 1, 0], [0, 1, 0], [0, 0, -1], [0, 1, 0]], dtype=float),
    offsets=np.array(
        [[0, 0, 0.16], [0, 0.14, 0], [0.43, -0.12, 0], [0.39, 0, 0], [0, 0.09, 0], [0, 0, -0.09], [0, 0.1, 0]]
    ),
    rotation=np.eye(3)[[0, 2, 1]] * [[1], [-1], [1]],
    limits=np.array([[-2 * np.pi] * 6, [2 * np.pi] * 6]),
)
"""Three parallel axes and turns of almost two ways around, like most light six-axis arms."""

CROOKED = Chain(
    axes=np.array([[0, 0, 1], [0, 1, 0], [0.6, 0, 0.8], [0, 1, 0], [0.8, 0, 0.6], [0, 0.8, 0.6], [0, 0, 1]]),
    offsets=np.array([[0.01 * (i + 1), 0.02 * (i % 3), 0.15] for i in range(8)]),
    rotation=np.eye(3),
    limits=np.array([[-2.5, -1.8, -2.5, -2.5, -2.5, -2.5, -np.inf], [2.5, 1.8, 2.5, 2.5, 2.5, 2.5, np.inf]]),
)
"""No axes meet or are parallel."""
