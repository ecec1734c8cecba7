"""A scene as it was observed: joints of the arm, the held box, and poses from a camera."""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from scipy.spatial.transform import Rotation

from ictamp_drake.core.checks import check_choice
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import FloatArray
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, StartSpec
from ictamp_drake.world.frames import upright_frame
from ictamp_drake.world.poses import to_pose, to_transform

MAX_GAP = 0.01
"""Largest distance of an observed box above or below the top of what it stands on [m]."""
MAX_TILT = 0.1
"""Largest tilt of an observed box that stands on something [rad]."""


@dataclass(frozen=True)
class Start:
    """Observations before planning. Anything left out is as the scene says.

    Attributes:
        joints: Positions of the arm's joints, base first [rad], shape (n,).
        held: Name of the box between the fingers; empty for none.
        poses: X_WO of boxes by name, each a pose array of shape (7,), unit quaternion (w, x, y, z) then position [m],
            or a `RigidTransform`. A box is set down on what it stands on if it is at most 1 cm above or inside it and
            tilted by at most 0.1 rad.
    """

    joints: FloatArray | None = None
    held: str | None = None
    poses: Mapping[str, FloatArray | RigidTransform] = field(default_factory=dict)


def observed_scene(spec: SceneSpec, start: Start) -> SceneSpec:
    """Return the scene with arm, hand and boxes as they were observed.

    Raises:
        IctampError: A box does not exist, or a pose is malformed.
    """
    for name in start.poses:
        check_choice("start.poses", name, spec.boxes)
    joints = spec.start.joints if start.joints is None else tuple(map(float, start.joints))
    held = spec.start.held if start.held is None else start.held
    moved = {name: _moved(name, spec.boxes[name], pose) for name, pose in start.poses.items()}
    spec = replace(spec, boxes={**spec.boxes, **moved}, start=StartSpec(joints, held))
    lowest_first = sorted(start.poses, key=lambda name: spec.boxes[name].position[2])
    for name in lowest_first:
        if name != held:
            spec = replace(spec, boxes={**spec.boxes, name: _set_down(spec, name)})
    return spec


def _moved(name: str, box: BoxSpec, pose: FloatArray | RigidTransform) -> BoxSpec:
    X_WO = pose if isinstance(pose, RigidTransform) else _transform(name, np.asarray(pose, dtype=np.float64))
    return _at(box, X_WO)


def _transform(name: str, pose: FloatArray) -> RigidTransform:
    if pose.shape != (7,) or not np.isfinite(pose).all() or not 0.99 < np.linalg.norm(pose[:4]) < 1.01:
        expected = "expected a unit quaternion (w, x, y, z) and a position (x, y, z), got {value}"
        raise IctampError(Code.WRONG_TYPE, expected, field=f"start.poses.{name}", value=pose.tolist())
    return to_transform(pose)


def _at(box: BoxSpec, X_WO: RigidTransform) -> BoxSpec:
    roll, pitch, yaw = Rotation.from_matrix(X_WO.rotation().matrix()).as_euler("xyz", degrees=True)
    x, y, z = X_WO.translation()
    return replace(box, position=(float(x), float(y), float(z)), rotation=(float(roll), float(pitch), float(yaw)))


def _set_down(spec: SceneSpec, name: str) -> BoxSpec:
    """Set the box down level on the top face nearest to its lower face, among those beneath its center.

    Without such a face within `MAX_GAP`, or with a tilt above `MAX_TILT`, the box stays as it was observed.
    """
    box = spec.boxes[name]
    lying = upright_frame(box.X_WO, box.size)
    R_WU = lying.X_WU.rotation()
    if np.arccos(np.clip(R_WU.matrix()[2, 2], -1, 1)) > MAX_TILT:
        return box
    p_WU = lying.X_WU.translation()
    bottom = float(p_WU[2] - lying.size[2] / 2)
    gaps = [bottom - top for top in _tops(spec, name, p_WU) if abs(bottom - top) <= MAX_GAP]
    if not gaps:
        return box
    x_WU = R_WU.matrix()[:, 0]
    level = RotationMatrix.MakeZRotation(float(np.arctan2(x_WU[1], x_WU[0])))
    X_WU = RigidTransform(level, p_WU - [0.0, 0.0, min(gaps, key=abs)])
    X_UO = lying.X_WU.inverse() @ to_transform(box.X_WO)
    return _at(box, to_transform(to_pose(X_WU @ X_UO)))


def _tops(spec: SceneSpec, name: str, p_W: FloatArray) -> list[float]:
    """Heights of the top faces above or below a point, shape (3,) [m], without the top of the box itself."""
    tops = [(to_transform(support.X_WT), np.array(support.size[:2])) for support in spec.supports.values()]
    for other, box in spec.boxes.items():
        if other != name:
            lying = upright_frame(box.X_WO, box.size)
            tops.append((lying.X_WT, lying.size[:2]))
    inside = ((X_WT, np.abs((X_WT.inverse() @ p_W)[:2]) <= size / 2) for X_WT, size in tops)
    return [float(X_WT.translation()[2]) for X_WT, within in inside if within.all()]
