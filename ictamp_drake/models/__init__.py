"""Robot, supports and boxes: SDF files written by `python -m tools.panda.write`, and their constants."""

from ictamp_drake.models.constants import (
    ARM_JOINTS,
    ARM_LIMITS,
    FINGER_JOINTS,
    GRIPPER_MAX_WIDTH,
    HOME,
    MAX_FINGER_SPEED,
    MAX_GRIP_FORCE,
    JointLimits,
)
from ictamp_drake.models.package import add_package
from ictamp_drake.models.shapes import box_sdf, rack_sdf, table_sdf

__all__ = [
    "ARM_JOINTS",
    "ARM_LIMITS",
    "FINGER_JOINTS",
    "GRIPPER_MAX_WIDTH",
    "HOME",
    "MAX_FINGER_SPEED",
    "MAX_GRIP_FORCE",
    "JointLimits",
    "add_package",
    "box_sdf",
    "rack_sdf",
    "table_sdf",
]
