"""Tracks of the bodies in a recording, reduced to the moments needed to show it."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from scipy.spatial.transform import Rotation

from ictamp_drake.core.types import FloatArray
from ictamp_drake.viz.keyframes import keyframes, same_hemisphere
from ictamp_drake.viz.stage import Stage
from ictamp_drake.world.outcome import Frame

TOLERANCE = 5e-4
"""Maximum deviation of a shown pose from the recording: position [m], components of the unit quaternion."""


class Track(NamedTuple):
    """Motion of a body, linear between keys.

    Attributes:
        times: Increasing times of the keys [s], shape (n,).
        poses: Poses X_WB at the keys, shape (n, 7).
    """

    times: FloatArray
    poses: FloatArray


def tracks(stage: Stage, frames: Sequence[Frame]) -> dict[str, Track]:
    """Return the track of every movable body by its path in Meshcat; a body that stands still has a single key."""
    times = np.array([frame.time for frame in frames])
    shown = [stage.poses(frame.c) for frame in frames]
    X_WB = np.array([[X.GetAsMatrix34() for X in poses.values()] for poses in shown])
    quaternions = Rotation.from_matrix(X_WB[..., :3].reshape(-1, 3, 3)).as_quat(scalar_first=True)
    poses = np.concatenate([quaternions.reshape(*X_WB.shape[:2], 4), X_WB[..., 3]], axis=-1)
    return {path: _track(times, poses[:, body]) for body, path in enumerate(shown[0])}


def _track(times: FloatArray, poses: FloatArray) -> Track:
    poses[:, :4] = same_hemisphere(poses[:, :4])
    kept = keyframes(times, poses, TOLERANCE)
    return Track(times[kept], poses[kept])
