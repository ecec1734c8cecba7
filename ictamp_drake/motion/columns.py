"""Reach of a hand that points down, at every yaw, and its collisions and the arm's with what never moves."""

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RigidTransform

from ictamp_drake.core.types import Configuration, FloatArray
from ictamp_drake.models.shapes import support_shapes
from ictamp_drake.motion.collision import CollisionScene
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World

OUT_OF_REACH = ""
"""Name of the obstacle where the arm has no posture, or is in its own way."""

_RING = 0.005
"""Distance between the radii at which reach is computed [m]."""


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
        robot = world.bodies.robot
        links = [body for body in robot.links if body not in robot.turning]
        self.hand = CollisionScene(world, padding=0.0, without=links)
        self.palm = CollisionScene(world, padding=0.0, without=(*links, *robot.moving))
        self.links = CollisionScene(world, padding=0.0, without=robot.turning)
        self._arm = arm
        self._farthest = float(np.linalg.norm(world.robot.chain.offsets, axis=1).sum()) + _RING
        self._spec = world.spec

    def blame(self, scene: CollisionScene, c: Configuration, qs: FloatArray) -> str:
        """Name the support that most of the postures touch; OUT_OF_REACH if they touch none.

        Args:
            scene: Collisions of the hand or of the other links.
            c: Configuration of everything but the arm.
            qs: Postures of the arm, shape (m, n) [rad].
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
        ring = np.minimum(np.hypot(*p_BG.T[:2]), self._farthest) / _RING
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
        names, hand = np.full(len(p_WG), OUT_OF_REACH, dtype=object), self._arm.robot.gripper.hand
        for name, support in self._spec.supports.items():
            for shape in support_shapes(support.kind, (support.size[0], support.size[1], support.size[2])):
                X_WS = to_transform(support.X_WT) @ RigidTransform(np.array(shape.xyz))
                p_SG, half = (X_WS.inverse() @ p_WG.T).T, np.array(shape.size) / 2
                outside = np.linalg.norm(np.maximum(np.abs(p_SG[:, :2]) - half[:2], 0.0), axis=1)
                inside = (half[:2] - np.abs(p_SG[:, :2])).min(axis=1)
                meets = [(part, outside < part.radius) for part in hand.core]
                if hand.disk is not None:
                    meets.append((hand.disk, inside > hand.disk.radius))
                for part, hit in meets:
                    names[hit & (p_SG[:, 2] + part.bottom < half[2]) & (p_SG[:, 2] + part.top > -half[2])] = name
        return [str(name) for name in names]
