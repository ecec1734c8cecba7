"""Kinematics of the Panda in closed form: the pose of its hand, and all postures with the hand at one pose.

A pose has six dimensions and the arm seven joints, so one joint is free: the last, as in He and Liu, "Analytical
Inverse Kinematics for Franka Emika Panda" (ICCMA 2021). Its angle determines the wrist's center W, where axes 5 and 6
meet. The triangle of shoulder S, elbow and W determines joint 4, and the position of S as seen from the wrist
determines joints 6 and 5. The three angles of the shoulder are Euler angles.
"""

import numpy as np
from numpy.typing import NDArray

from ictamp_drake.core.types import FloatArray
from ictamp_drake.models.panda import DH_PARAMETERS, FLANGE_OFFSET, GRASP_OFFSET, HAND_ANGLE
from ictamp_drake.robots.chain import ROUNDING, Chain, is_within


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


_P_BS: FloatArray = np.array([0.0, 0.0, DH_PARAMETERS[0].d])
_S: FloatArray = np.array([DH_PARAMETERS[4].a, -DH_PARAMETERS[2].d])
"""x and y of S in link 4's frame when joint 4 is at zero [m]."""
_W: FloatArray = np.array([DH_PARAMETERS[4].a, DH_PARAMETERS[4].d])
"""x and y of W in link 4's frame [m]."""

_P_67: FloatArray = link(*DH_PARAMETERS[6], np.zeros(1))[0, :3, 3]
_X_G7: FloatArray = np.asarray(np.linalg.inv(X_7G), dtype=np.float64)

_ALIKE = 1e-9
"""Maximum difference of poses by which an arm counts as a Panda."""


class PandaKinematics:
    """Closed form for the Panda; the free joint is the last."""

    free: int | None = 6
    finds_all = True

    def postures(
        self, X_BG: FloatArray, angles: FloatArray, limits: FloatArray, /
    ) -> tuple[FloatArray, NDArray[np.intp]]:
        """See `core.protocols.InverseKinematics`."""
        one = len(X_BG) == 1
        found = postures(X_BG[0] if one else np.repeat(X_BG, len(angles), axis=0), np.tile(angles, len(X_BG)))
        sixth = found[..., 5]  # the only joint with a limit beyond π
        sixth[sixth < limits[0, 5] - ROUNDING] += 2 * np.pi
        inside = is_within(found, limits)
        q = found[inside]
        return q, np.zeros(len(q), dtype=np.intp) if one else inside.nonzero()[1] // len(angles)


def is_panda(chain: Chain) -> bool:
    """Whether forward kinematics of an arm are those of the Panda with its hand."""
    q = np.linspace(-2.0, 2.0, 7 * 8).reshape(8, 7)
    return len(chain.axes) == 7 and bool(np.abs(chain.forward(q) - forward(q)).max() < _ALIKE)


def postures(X_BG: FloatArray, last: FloatArray) -> FloatArray:
    """Joint positions with the hand at X_BG, up to eight for each angle of the last joint, regardless of joint limits.

    Args:
        X_BG: Pose of G in the arm's base frame, one for all angles or one for each, shape (4, 4) or (n, 4, 4).
        last: Angles of the last joint, shape (n,) [rad].

    Returns:
        Shape (8, n, 7), all angles except the last in [-π, π) [rad]; nan where there is none.
    """
    R_B7, p_B7 = _remove_hand(X_BG)
    R_B6 = _undo_joint(R_B7, 7, (np.cos(last), np.sin(last)))
    a, b, c = (R_B6 * (_P_BS[:, None] - p_B7)).sum(axis=1) + _P_67[:, None]  # from W to S in link 6's frame
    R_B6 = R_B6[:, :, None]
    q = np.empty((2, 2, 2, len(last), 7))
    q[..., 6] = last
    with np.errstate(invalid="ignore", divide="ignore"):  # impossible angles are nan
        q4 = _elbow(np.sqrt(a * a + b * b + c * c), np.array([[1.0], [-1.0]]))
        turn4 = cos4, sin4 = np.cos(q4), np.sin(q4)
        x = cos4 * _S[0] + sin4 * _S[1] - _W[0]  # from W to S in link 4's frame
        y = cos4 * _S[1] - sin4 * _S[0] - _W[1]
        rise, heading, side = np.arcsin(y / np.hypot(a, b)), np.arctan2(b, a), np.sign(x)
        q[..., 3] = _wrap_angle(q4)
        for found, turn in zip(q, (rise, np.pi - rise), strict=True):
            q6 = turn - heading
            turn6 = cos6, sin6 = np.cos(q6), np.sin(q6)
            q5 = np.arctan2(side * c, side * (a * cos6 - b * sin6))
            X, Y, Z = _undo_joint(
                _undo_joint(_undo_joint(R_B6, 6, turn6), 5, (np.cos(q5), np.sin(q5))), 4, turn4
            )  # link 3's, in B
            q1, q2 = np.arctan2(Z[1], Z[0]), np.arctan2(np.hypot(Z[0], Z[1]), Z[2])
            cos, sin = np.cos(q1), np.sin(q1)
            q3 = np.arctan2(cos * X[1] - sin * X[0], cos * Y[1] - sin * Y[0])
            found[..., 4], found[..., 5] = q5, _wrap_angle(q6)
            for i, angle in enumerate((q1, q2, q3)):  # the shoulder's other way
                found[0, ..., i], found[1, ..., i] = angle, -angle if i == 1 else angle - np.copysign(np.pi, angle)
    q[np.isnan(q[..., 5])] = np.nan  # this angle is nan whenever another one is
    return q.reshape(8, len(last), 7)


def _wrap_angle(angle: FloatArray) -> FloatArray:
    return angle - 2 * np.pi * np.floor((angle + np.pi) / (2 * np.pi))


def _remove_hand(X_BG: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Axes of link 7, one after the other, and its position in B, (4, 4) or (n, 4, 4) -> (3, 3, n) and (3, n)."""
    X_B7 = np.reshape(X_BG @ _X_G7, (-1, 4, 4))
    return X_B7[:, :3, :3].transpose(2, 1, 0), X_B7[:, :3, 3].T


def _undo_joint(axes: FloatArray, number: int, turn: tuple[FloatArray, FloatArray]) -> FloatArray:
    """Axes of the link before a link: x, y, z, each of shape (3, ..., n).

    Args:
        axes: Axes of the link.
        number: Number of the link.
        turn: Cosine and sine of its joint's angle.
    """
    (x, y, z), (cos, sin) = axes, turn
    alpha = DH_PARAMETERS[number - 1].alpha
    x, y = x * cos - y * sin, x * sin + y * cos
    return np.array([x, y * np.cos(alpha) - z * np.sin(alpha), y * np.sin(alpha) + z * np.cos(alpha)])


def _elbow(distance: FloatArray, bend: FloatArray) -> FloatArray:
    """Angle of joint 4 at a distance of S and W, bent to either side (1 or -1); nan when it is impossible."""
    upper, fore = np.hypot(*_S), np.hypot(*_W)
    between = np.arccos((upper**2 + fore**2 - distance**2) / (2 * upper * fore))
    folded = np.arctan2(_S[1], _S[0]) - np.arctan2(_W[1], _W[0])
    angle: FloatArray = folded + bend * between
    return angle
