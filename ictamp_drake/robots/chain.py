"""A serial arm as axes and offsets, read from a Drake plant, and its forward kinematics for many postures at once."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Frame, Joint

from ictamp_drake.core.types import FloatArray

TOLERANCE = 1e-6
"""Maximum error of a posture's position [m] and rotation [rad], by forward kinematics."""

ROUNDING = 1e-9
"""Distance beyond a joint's limit that counts as rounding [rad]."""


@dataclass(frozen=True, eq=False)
class Chain:
    """Revolute joints one after the other. All is given in the base frame B, with all joints at zero.

    Attributes:
        axes: Unit vectors of the joints' axes, shape (joints, 3).
        offsets: Vectors from the base to the first joint, from each joint to the next, and from the last joint to the
            hand's frame G, shape (joints + 1, 3) [m].
        rotation: Rotation of G, shape (3, 3).
        limits: Lower and upper limits of the joints, shape (2, joints) [rad]. A joint without limits has infinite ones.
    """

    axes: FloatArray
    offsets: FloatArray
    rotation: FloatArray
    limits: FloatArray

    @cached_property
    def _products(self) -> tuple[FloatArray, FloatArray]:
        """Matrices of the cross product with each axis, and their squares."""
        once = np.array([np.cross(axis, np.eye(3), axisb=1).T for axis in self.axes])
        return once, once @ once

    def forward(self, q: FloatArray) -> FloatArray:
        """X_BG at the joint positions q, shape (n, joints) [rad] -> (n, 4, 4)."""
        return self.forward_with_jacobian(q)[0]

    def forward_with_jacobian(self, q: FloatArray) -> tuple[FloatArray, FloatArray]:
        """X_BG and the Jacobian of G's velocity in B, angular first, shapes (n, 4, 4) and (n, 6, joints)."""
        once, twice = self._products
        turns = np.eye(3) + np.sin(q)[..., None, None] * once + (1 - np.cos(q))[..., None, None] * twice
        X = np.tile(np.eye(4), (len(q), 1, 1))
        R, p = X[:, :3, :3], np.tile(self.offsets[0], (len(q), 1))
        J, points = np.empty((len(q), 6, q.shape[1])), np.empty((len(q), 3, q.shape[1]))
        for joint, offset in enumerate(self.offsets[1:]):
            J[:, :3, joint], points[:, :, joint] = R @ self.axes[joint], p
            R = R @ turns[:, joint]
            p = p + R @ offset
        J[:, 3:] = np.cross(J[:, :3], p[:, :, None] - points, axis=1)
        X[:, :3, :3], X[:, :3, 3] = R @ self.rotation, p
        return X, J

    def is_at(self, q: FloatArray, X_BG: FloatArray) -> NDArray[np.bool_]:
        """Whether each posture brings G to its pose within `TOLERANCE`, shapes (n, joints), (n, 4, 4) -> (n,)."""
        error = pose_error(self.forward(q), X_BG)
        near: NDArray[np.bool_] = np.maximum(*np.linalg.norm(error.reshape(-1, 2, 3), axis=2).T) < TOLERANCE
        return near


def read_chain(plant: MultibodyPlant, joints: Sequence[Joint], base: Frame, hand: Frame) -> Chain:
    """Read the chain of revolute joints, in their order from the base to the hand, from a finalized plant."""
    context = plant.CreateDefaultContext()
    for joint in joints:
        joint.set_angle(context, 0.0)
    frames = [plant.CalcRelativeTransform(context, base, joint.frame_on_parent()) for joint in joints]
    X_BG = plant.CalcRelativeTransform(context, base, hand)
    points = [np.zeros(3), *(X.translation() for X in frames), X_BG.translation()]
    return Chain(
        axes=np.array([X.rotation() @ joint.revolute_axis() for X, joint in zip(frames, joints, strict=True)]),
        offsets=np.diff(points, axis=0),
        rotation=X_BG.rotation().matrix(),
        limits=np.array(
            [[joint.position_lower_limit() for joint in joints], [joint.position_upper_limit() for joint in joints]]
        ),
    )


def pose_error(X: FloatArray, target: FloatArray) -> FloatArray:
    """Rotation vectors and translations from X to the target, in B, shapes (n, 4, 4) -> (n, 6) [rad, m]."""
    D = target[:, :3, :3] @ X[:, :3, :3].transpose(0, 2, 1)
    w = np.stack([D[:, 2, 1] - D[:, 1, 2], D[:, 0, 2] - D[:, 2, 0], D[:, 1, 0] - D[:, 0, 1]], axis=1) / 2
    sine = np.linalg.norm(w, axis=1)
    angle = np.arctan2(sine, (np.trace(D, axis1=1, axis2=2) - 1) / 2)
    w *= (angle / np.maximum(sine, 1e-12))[:, None]
    return np.concatenate([w, target[:, :3, 3] - X[:, :3, 3]], axis=1)


def is_within(q: FloatArray, limits: FloatArray) -> NDArray[np.bool_]:
    """Whether joint positions are within limits, shapes (..., joints), (2, joints) -> (...); False for nan."""
    inside: NDArray[np.bool_] = np.all((q >= limits[0] - ROUNDING) & (q <= limits[1] + ROUNDING), axis=-1)
    return inside


def turn_into(q: FloatArray, limits: FloatArray) -> FloatArray:
    """Joint positions, turned by full turns to where they are nearest to the middle of limits, finite or not."""
    middle = middle_of(limits)
    turned: FloatArray = middle + np.remainder(q - middle + np.pi, 2 * np.pi) - np.pi
    return turned


def turn_near(q: FloatArray, aim: FloatArray, limits: FloatArray, spare: float = 0.0) -> FloatArray:
    """Joint positions, turned by full turns to where they are nearest to an aim.

    Joints whose limits span no more than a full turn stay as they are.

    Args:
        q: Positions within the limits, shape (..., joints) [rad].
        aim: Positions to be near, shape (joints,) [rad].
        limits: Lower and upper limits, which may be infinite, shape (2, joints) [rad].
        spare: Distance to keep from the limits where that leaves a joint a full turn [rad].
    """
    room = (limits[1] - limits[0]) / 2 - np.pi
    lower, upper = limits + np.clip(room, 0.0, spare) * [[1], [-1]]
    turned = q + 2 * np.pi * np.round((np.clip(aim, lower, upper) - q) / (2 * np.pi))
    turned += 2 * np.pi * (turned < lower) - 2 * np.pi * (turned > upper)
    near: FloatArray = np.where(room > 0, turned, q)
    return near


def middle_of(limits: FloatArray) -> FloatArray:
    """Middle of joint limits, or zero for joints without limits, shape (2, joints) -> (joints,) [rad]."""
    middle: FloatArray = np.where(np.isfinite(limits), limits, 0.0).sum(axis=0) / 2
    return middle
