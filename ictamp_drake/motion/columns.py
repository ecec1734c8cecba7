"""Postures of the arm above a place, for every yaw of a hand that points down, among what never moves."""

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RigidTransform

from ictamp_drake.core.types import Configuration, FloatArray
from ictamp_drake.models.hand import CORE
from ictamp_drake.models.shapes import support_shapes
from ictamp_drake.motion.collision import CollisionScene
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World

OUT_OF_REACH = ""
"""Name of the obstacle where the arm has no posture."""

_LINKS = tuple(f"panda_link{number}" for number in range(7))
_FINGERS = ("panda_leftfinger", "panda_rightfinger")
_HAND = ("panda_link7", "panda_hand")
_RING, _FARTHEST = 0.005, 1.0
"""Distance of the radii at which reach is computed, and a radius that no arm reaches [m]."""


class Columns:
    """Places of a hand that points down, by what keeps the hand or the arm away from them.

    The last joint turns the hand alone, so hand and arm are tested apart: the hand at every yaw, and the other links in
    every posture.

    Attributes:
        arm: Kinematics of the arm.
        hand: Collisions of hand and fingers alone.
    """

    def __init__(self, world: World, arm: ArmKinematics) -> None:
        self.arm = arm
        self.hand = CollisionScene(world, padding=0.0, without=_LINKS)
        self._palm = CollisionScene(world, padding=0.0, without=(*_LINKS, *_FINGERS))
        self._links = CollisionScene(world, padding=0.0, without=(*_HAND, *_FINGERS))
        self._spec = world.spec

    def free_yaws(self, c: Configuration, X_WG: RigidTransform, turns: FloatArray) -> list[int] | str:
        """Find the yaws at which the palm is free where some posture of the arm is, whatever the last joint's limits.

        Args:
            c: Configuration of what stands around.
            X_WG: Pose of G, pointing down, for a turn of 0.
            turns: Turns of the hand about W's z, shape (n,) [rad].

        Returns:
            Indices of the turns; if there is none, the name of an obstacle, or `OUT_OF_REACH`.
        """
        postures = self.arm.turning_postures(X_WG)
        if not len(postures):
            return OUT_OF_REACH
        turned = np.tile(postures[0], (len(turns), 1))
        turned[:, 6] -= turns  # a hand that points down turns the other way
        yaws = [i for i, q in enumerate(turned) if self._palm.is_free(c, q)]
        if not yaws:
            return self.blame(self._palm, c, turned)
        if not any(self._links.is_free(c, q) for q in postures):
            return self.blame(self._links, c, postures)
        return yaws

    def blame(self, scene: CollisionScene, c: Configuration, qs: FloatArray) -> str:
        """Name the support that most postures touch, shape (m, 7) -> its name; else the arm is in its own way."""
        others = [contact.other for q in qs for contact in scene.contacts(c, q)]
        supports = [name for name in others if name in self._spec.supports]
        return max(supports, key=supports.count, default=OUT_OF_REACH)

    def is_near_enough(self, p_WG: FloatArray) -> NDArray[np.bool_]:
        """Whether places are near enough, all at the same height, shape (n, 3) [m] -> (n,). Joint 1 has no limit."""
        p_BG = (to_transform(self._spec.arm.X_WB).inverse() @ p_WG.T).T
        ring = np.minimum(np.hypot(*p_BG.T[:2]), _FARTHEST) / _RING
        near = self.arm.is_near_enough(_RING * np.arange(int(ring.max(initial=0.0)) + 2), float(p_BG[0, 2]))
        return near[np.floor(ring).astype(int)] | near[np.ceil(ring).astype(int)]

    def obstacles(self, p_WG: FloatArray) -> list[str]:
        """Supports in which the core of the hand would be at places, shape (n, 3) [m]; an empty name for none."""
        names = np.full(len(p_WG), OUT_OF_REACH, dtype=object)
        for name, support in self._spec.supports.items():
            for shape in support_shapes(support.kind, support.size):
                X_WS = to_transform(support.X_WT) @ RigidTransform(np.array(shape.xyz))
                p_SG, half = (X_WS.inverse() @ p_WG.T).T, np.array(shape.size) / 2
                away = np.linalg.norm(np.maximum(np.abs(p_SG[:, :2]) - half[:2], 0.0), axis=1)
                for radius, low, high in CORE:
                    level = (p_SG[:, 2] + low < half[2]) & (p_SG[:, 2] + high > -half[2])
                    names[(away < radius) & level] = name
        return [str(name) for name in names]
