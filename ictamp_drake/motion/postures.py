"""All postures of the arm with the hand at one pose, in closed form.

A pose has six dimensions and the arm seven joints, so one of them is free: the last, as in He and Liu, "Analytical
Inverse Kinematics for Franka Emika Panda" (ICCMA 2021). Its angle tells where the wrist's centre W is, in which axes 5
and 6 meet. The triangle of shoulder S, elbow and W tells joint 4, where S is as seen from the wrist joints 6 and 5, and
the shoulder's three are Euler angles.
"""

import numpy as np

from ictamp_drake.core.types import FloatArray
from ictamp_drake.models.constants import DH_PARAMETERS
from ictamp_drake.world.matrices import X_7G, inverse, link

_P_BS: FloatArray = np.array([0.0, 0.0, DH_PARAMETERS[0].d])
_S: FloatArray = np.array([DH_PARAMETERS[4].a, -DH_PARAMETERS[2].d])
"""x and y of S in link 4's frame when joint 4 is at zero [m]."""
_W: FloatArray = np.array([DH_PARAMETERS[4].a, DH_PARAMETERS[4].d])
"""x and y of W in link 4's frame [m]."""


def postures(X_BG: FloatArray, last: FloatArray) -> FloatArray:
    """Joint positions with the hand at X_BG, up to eight for each angle of the last joint, whatever the joints' limits.

    Args:
        X_BG: pose of G in the arm's base frame, the same for all angles or one for each, shape (4, 4) or (n, 4, 4).
        last: angles of the last joint, shape (n,) [rad].

    Returns:
        Shape (8, n, 7), angles but the last in [-π, π) [rad]; nan where there is none.
    """
    count = len(last)
    last, bend = np.tile(last, 2), np.repeat([1.0, -1.0], count)
    X_B6 = np.tile(np.broadcast_to(X_BG, (count, 4, 4)), (2, 1, 1)) @ inverse(_link(7, last) @ X_7G)
    a, b, c = np.einsum("nji,nj->in", X_B6[:, :3, :3], _P_BS - X_B6[:, :3, 3])  # from W to S in link 6's frame
    found = []
    with np.errstate(invalid="ignore", divide="ignore"):  # what can't be is nan
        q4 = _elbow(np.sqrt(a * a + b * b + c * c), bend)
        x = np.cos(q4) * _S[0] + np.sin(q4) * _S[1] - _W[0]  # from W to S in link 4's frame
        y = np.cos(q4) * _S[1] - np.sin(q4) * _S[0] - _W[1]
        rise = np.arcsin(y / np.hypot(a, b))
        for turn in rise, np.pi - rise:
            q6 = turn - np.arctan2(b, a)
            q5 = np.arctan2(np.sign(x) * c, np.sign(x) * (a * np.cos(q6) - b * np.sin(q6)))
            R = (X_B6 @ inverse(_link(4, q4) @ _link(5, q5) @ _link(6, q6)))[:, :3, :3]
            for side in 1.0, -1.0:
                q1 = np.arctan2(side * R[:, 1, 2], side * R[:, 0, 2])
                q2 = np.arctan2(side * np.hypot(R[:, 0, 2], R[:, 1, 2]), R[:, 2, 2])
                sin, cos = (np.cos(q1) * R[:, 1, i] - np.sin(q1) * R[:, 0, i] for i in (0, 1))
                found.append(np.column_stack([q1, q2, np.arctan2(sin, cos), q4, q5, q6, last]))
    q = np.reshape(found, (8, count, 7))
    q[..., :6] = np.remainder(q[..., :6] + np.pi, 2 * np.pi) - np.pi
    return np.where(np.isfinite(q).all(axis=2, keepdims=True), q, np.nan)


def _link(number: int, angle: FloatArray) -> FloatArray:
    """Pose of a link in the frame of the one before it at so many angles of its joint, (n,) -> (n, 4, 4)."""
    return link(*DH_PARAMETERS[number - 1], angle)


def _elbow(distance: FloatArray, bend: FloatArray) -> FloatArray:
    """Angle of joint 4 at which S and W are so far apart, bent to either side (1 or -1); nan when they can't be."""
    upper, fore = np.hypot(*_S), np.hypot(*_W)
    between = np.arccos((upper**2 + fore**2 - distance**2) / (2 * upper * fore))
    folded = np.arctan2(_S[1], _S[0]) - np.arctan2(_W[1], _W[0])
    angle: FloatArray = folded + bend * between
    return angle
