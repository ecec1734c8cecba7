"""Forward kinematics of the Panda for many configurations at once, without Drake."""

import numpy as np

from ictamp_drake.core.types import FloatArray
from ictamp_drake.models.constants import DH_PARAMETERS, FLANGE_OFFSET
from ictamp_drake.models.hand import GRASP_OFFSET, HAND_ANGLE


def link(a: float, d: float, alpha: float, angle: FloatArray) -> FloatArray:
    """Rotation by alpha about x, shift by a along x and d along z, rotation by angles about z: (n,) -> (n, 4, 4)."""
    X = np.zeros((len(angle), 4, 4))
    c, s, ca, sa = np.cos(angle), np.sin(angle), np.cos(alpha), np.sin(alpha)
    X[:, 0, 0], X[:, 0, 1] = c, -s
    X[:, 1, 0], X[:, 1, 1], X[:, 1, 2] = s * ca, c * ca, -sa
    X[:, 2, 0], X[:, 2, 1], X[:, 2, 2] = s * sa, c * sa, ca
    X[:, :, 3] = a, -d * sa, d * ca, 1.0
    return X


X_7G: FloatArray = link(0.0, FLANGE_OFFSET + GRASP_OFFSET, 0.0, np.array([HAND_ANGLE]))[0]
"""Pose of G in link 7's frame, shape (4, 4)."""


def forward(q: FloatArray) -> FloatArray:
    """X_BG at the arm's joint positions, shape (n, 7) [rad] -> (n, 4, 4)."""
    X_BG = np.eye(4)
    for joint, angle in zip(DH_PARAMETERS, q.T, strict=True):
        X_BG = X_BG @ link(*joint, angle)
    return X_BG @ X_7G
