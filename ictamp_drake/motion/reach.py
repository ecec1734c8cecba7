"""Reasons why the arm has no posture with its hand at a pose. The search does not ask for them; reports do."""

from collections import Counter
from collections.abc import Sequence

import numpy as np

from ictamp_drake.core.types import FloatArray
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.robots.robot import find_robot
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.world.poses import to_transform

OUT_OF_REACH = ""
"""Name in place of a joint's where the arm would have no posture without limits either."""

_LOOKED_AT = 60
"""Maximum number of poses that are looked at, evenly chosen."""


class Reach:
    """Reach of the arm of a scene, with and without its joint limits."""

    def __init__(self, spec: SceneSpec) -> None:
        self._robot = find_robot(spec.robot)
        self._arm = ArmKinematics(self._robot, to_transform(spec.arm.X_WB))

    def blame(self, X_WG: FloatArray) -> str | None:
        """Name the joint whose limits are in the way of a pose of G, shape (7,).

        Returns:
            The joint beyond its limits most often, in the postures with the fewest such joints; OUT_OF_REACH when there
            is no posture without limits either; None when there is a posture within all limits.
        """
        beyond = self._arm.joints_beyond_limits(to_transform(X_WG))
        if not len(beyond):
            return OUT_OF_REACH
        counts = beyond.sum(axis=1)
        least = counts.min()
        if least == 0:
            return None
        return self._robot.joints[int(np.argmax(beyond[counts == least].sum(axis=0)))]

    def describe(self, X_WG: FloatArray) -> str:
        """Describe in words what is in the way of a pose of G, shape (7,); empty if there is a posture."""
        joint = self.blame(X_WG)
        if joint is None:
            return ""
        return f"beyond the limits of {joint}" if joint else "out of reach"

    def count(self, poses: Sequence[FloatArray]) -> Counter[str]:
        """Count what is in the way of poses of G, shape (7,) each, of which some are looked at if there are many."""
        step = -(-len(poses) // _LOOKED_AT) or 1
        causes = Counter(self.blame(X_WG) for X_WG in poses[::step])
        return Counter({cause: count for cause, count in causes.most_common() if cause is not None})
