"""Why an attempt at a skill failed: expected outcomes are values, and each member is a sentence."""

from enum import Enum


class Failure(Enum):
    """Cause of a failed attempt, in the order in which a skill can meet them."""

    NO_INVERSE_KINEMATICS = "no inverse-kinematics solution"
    GOAL_IN_COLLISION = "grasp or placement in collision"
    NO_PATH = "no collision-free path"
    NOT_GRASPED = "object not grasped"
    SLIPPED = "object slipped"
    TOPPLED = "object toppled"
    OTHER_MOVED = "another object moved"
    WRONG_STATE = "wrong symbolic state"
    NOT_SETTLED = "did not settle"

    def __str__(self) -> str:
        return self.value
