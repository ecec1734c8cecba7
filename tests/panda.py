"""The Panda's robot and its numbers, for tests."""

from ictamp_drake.robots.robot import find_robot

PANDA = find_robot()
GRIPPER = PANDA.gripper
HAND = GRIPPER.hand
HOME, LOWER, UPPER, VELOCITY = PANDA.home, PANDA.lower, PANDA.upper, PANDA.velocity
MAX_OPENING, MAX_SIDE, MAX_GRIP_FORCE = GRIPPER.opening, GRIPPER.max_side, GRIPPER.force
TIP, PAD_HALF_HEIGHT = HAND.tip, HAND.pad_half_height
