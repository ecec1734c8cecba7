"""Reach of a hand that points down, at every yaw, and its collisions and the arm's with what never moves."""

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RigidTransform

from ictamp_drake.core.types import Configuration, FloatArray
from ictamp_drake.models.hand import FINGER_DISK, HAND_CORE
from ictamp_drake.models.shapes import support_shapes
from ictamp_drake.motion.collision import CollisionScene
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World

OUT_OF_REACH = ""
"""Name of the obstacle where the arm has no posture, or is in its own way."""

_LINKS = tuple(f"panda_link{number}" for number in range(7))
_FINGERS = ("panda_leftfinger", "panda_rightfinger")
_HAND = ("panda_link7", "panda_hand")
_RING, _FARTHEST = 0.005, 1.0
"""Distance between the radii at which reach is computed, and a radius that the arm does not reach [m]."""


class Columns:
    """Collisions of hand and arm with what never moves, at places where the hand points down.

    The last joint turns the hand alone, so hand and arm are tested apart: the hand at every yaw, and the other links in
    every posture.

    Attributes:
        hand: Collisions of the hand with its fingers alone.
        palm: Collisions of the hand without its fingers.
        links: Collisions of the links that do not turn with the hand.
    """

    def __init__(self, world: World, arm: ArmKinematics) -> None:
        self.hand = CollisionScene(world, padding=0.0, without=_LINKS)
        self.palm = CollisionScene(world, padding=0.0, without=(*_LINKS, *_FINGERS))
        self.links = CollisionScene(world, padding=0.0, without=(*_HAND, *_FINGERS))
        self._arm = arm
        self._spec = world.spec

    def blame(self, scene: CollisionScene, c: Configuration, qs: FloatArray) -> str:
        """Name the support that most of the postures touch; OUT_OF_REACH if they touch none.

        Args:
            scene: Collisions of the hand or of the other links.
            c: Configuration of everything but the arm.
            qs: Postures of the arm, shape (m, 7) [rad].
        """
        others = [contact.other for q in qs for contact in scene.contacts(c, q)]
        supports = [name for name in others if name in self._spec.supports]
        return max(supports, key=supports.count, default=OUT_OF_REACH)

    def is_within_reach(self, p_WG: FloatArray) -> NDArray[np.bool_]:
        """Whether G might reach positions of equal height; a quick test that rules out what is far away.

        Args:
            p_WG: Positions of G, shape (n, 3) [m].

        Returns:
            Shape (n,).
        """
        p_BG = (to_transform(self._spec.arm.X_WB).inverse() @ p_WG.T).T
        ring = np.minimum(np.hypot(*p_BG.T[:2]), _FARTHEST) / _RING
        rings, number = np.unique([np.floor(ring), np.ceil(ring)], return_inverse=True)
        near = self._arm.is_within_reach(_RING * rings, float(p_BG[0, 2]))[number]
        return np.asarray(near.reshape(2, -1).any(axis=0))

    def find_obstacles(self, p_WG: FloatArray) -> list[str]:
        """Find supports that hand or fingers hit at any yaw.

        Args:
            p_WG: Positions of G, shape (n, 3) [m].

        Returns:
            A name for each position, OUT_OF_REACH where no support is hit for certain.
        """
        names = np.full(len(p_WG), OUT_OF_REACH, dtype=object)
        for name, support in self._spec.supports.items():
            for shape in support_shapes(support.kind, (support.size[0], support.size[1], support.size[2])):
                X_WS = to_transform(support.X_WT) @ RigidTransform(np.array(shape.xyz))
                p_SG, half = (X_WS.inverse() @ p_WG.T).T, np.array(shape.size) / 2
                outside = np.linalg.norm(np.maximum(np.abs(p_SG[:, :2]) - half[:2], 0.0), axis=1)
                inside = (half[:2] - np.abs(p_SG[:, :2])).min(axis=1)
                meets = [(part, outside < part.radius) for part in HAND_CORE]
                for part, hit in (*meets, (FINGER_DISK, inside > FINGER_DISK.radius)):
                    names[hit & (p_SG[:, 2] + part.bottom < half[2]) & (p_SG[:, 2] + part.top > -half[2])] = name
        return [str(name) for name in names]
