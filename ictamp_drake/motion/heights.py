"""Heights at which the hand passes over what stands between two places."""

import numpy as np
from pydrake.math import RigidTransform

from ictamp_drake.core.types import Configuration, FloatArray
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World


def raised_path(kinematics: ArmKinematics, q0: FloatArray, q1: FloatArray, height: float) -> FloatArray | None:
    """Path from q0 straight up until G is at a height [m], over to above q1 and straight down, shape (m, n) [rad].

    Returns:
        None when the arm does not reach that high.
    """
    up, down = _lift(kinematics, q0, height), _lift(kinematics, q1, height)
    if up is None or down is None:
        return None
    middle = _lift(kinematics, (up[-1] + down[-1]) / 2, height)
    return None if middle is None else np.vstack([up, middle[-1:], down[::-1]])


def _lift(kinematics: ArmKinematics, q: FloatArray, height: float) -> FloatArray | None:
    """Path from q straight up until G is at the height, shape (m, n); only q when G is there already."""
    X_WG = kinematics.forward(q)
    missing = height - X_WG.translation()[2]
    if missing <= 0:
        return q[None]
    return kinematics.line(q, RigidTransform(X_WG.rotation(), X_WG.translation() + [0.0, 0.0, missing]))


def obstacle_height(world: World, c: Configuration, p0: FloatArray, p1: FloatArray, width: float) -> float:
    """Top of the tallest thing near the line from p0 to p1 seen from above [m]; things count as their circumcircles."""
    tops = [0.0]
    for name in (*world.spec.supports, *(name for name in c.poses if name != c.held)):
        X_WT = world.X_WT(c, name)
        radius = float(np.linalg.norm(world.top_size(c, name))) / 2
        if _distance_from_above(X_WT.translation(), p0, p1) < radius + width:
            tops.append(float(X_WT.translation()[2]))
    return max(tops)


def _distance_from_above(p: FloatArray, p0: FloatArray, p1: FloatArray) -> float:
    way, offset = (p1 - p0)[:2], (p - p0)[:2]
    share = float(offset @ way) / max(float(way @ way), 1e-12)
    return float(np.linalg.norm(offset - min(max(share, 0.0), 1.0) * way))


def reach_below_grasp(world: World, c: Configuration, X_WG: RigidTransform) -> float:
    """Distance from G down to the lowest point of hand and held box in c, where the hand is at X_WG [m]."""
    tips = world.robot.gripper.hand.depth
    if c.held is None:
        return tips
    X_WO = to_transform(c.poses[c.held])
    half_height = float(np.abs(X_WO.rotation().matrix()[2]) @ world.sizes[c.held]) / 2
    lowest = float(X_WO.translation()[2]) - half_height
    return max(tips, float(X_WG.translation()[2]) - lowest)
