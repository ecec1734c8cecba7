"""Causes of failed attempts at a skill. Failures are expected, so they are values, not exceptions."""

from enum import Enum


class Failure(Enum):
    """Cause of a failed attempt, in the order in which a skill can meet them."""

    NO_INVERSE_KINEMATICS = "no inverse-kinematics solution"
    GOAL_IN_COLLISION = "grasp or placement in collision"
    NO_PATH = "no collision-free path"
    TOO_HEAVY = "object too heavy for the grip"
    NOT_GRASPED = "object not grasped"
    SLIPPED = "object slipped"
    TOPPLED = "object toppled"
    OTHER_MOVED = "another object moved"
    WRONG_STATE = "wrong symbolic state"
    NOT_SETTLED = "did not settle"

    def __str__(self) -> str:
        return self.value

    @property
    def advice(self) -> str:
        """Advice on what to change in the scene or the options when an action always fails for this cause."""
        return _ADVICE[self]


Cause = Failure | str
"""Cause of a failed attempt; text in records of other versions, which may have other causes."""

_ADVICE = {
    Failure.NO_INVERSE_KINEMATICS: "move the object or its receptacle to where the arm can reach it from above",
    Failure.GOAL_IN_COLLISION: "leave more room around the object, or around the place where it is to stand",
    Failure.NO_PATH: "leave the arm wider gaps between the objects",
    Failure.TOO_HEAVY: "give the object less mass or more friction",
    Failure.NOT_GRASPED: "check the object's mass, friction and width, or raise --skills.pick.safety",
    Failure.SLIPPED: "check the object's mass and friction, or raise --skills.pick.safety",
    Failure.TOPPLED: "place the object on a wider or firmer base",
    Failure.OTHER_MOVED: "leave more room between the objects",
    Failure.WRONG_STATE: "see the attempts in search.html",
    Failure.NOT_SETTLED: "check the object's mass and friction, and whether it can come to rest there",
}
