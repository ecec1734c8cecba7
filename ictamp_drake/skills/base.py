"""What a skill is, and the pieces from which skills put their motions together."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import replace
from typing import Protocol

import numpy as np

from ictamp_drake.core.checks import check_vector
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import Action, Configuration, FloatArray, GripperCommand, Motion, Parameter, Segment
from ictamp_drake.models.hand import MAX_OPENING
from ictamp_drake.motion.planner import MotionPlanner, Refusal
from ictamp_drake.world.commands import gripper_time, stand_still
from ictamp_drake.world.world import World

CLEARANCES = (0.01, 0.006, 0.003)
"""Distances of each finger from the box while the hand comes down to it or leaves it [m].

The first one bears a box that is 3 mm and 2 deg from where it was seen, the last one what the arm deviates by.
"""
PAUSE = 0.1
"""Time that the hand waits after the gripper has obeyed [s]."""


class Skill(Protocol):
    """ψ_a, what turns k into a motion."""

    def plan(self, c: Configuration, action: Action, k: Parameter, rng: np.random.Generator) -> Motion | Refusal:
        """The motion that carries out the action from c with parameter k, or what is in its way."""

    def promise(self, c: Configuration, action: Action, k: Parameter, motion: Motion) -> Configuration:
        """Where the motion ends if all goes well; asked only when plans run in physics as a whole."""


class SkillConfig(Protocol):
    """Configuration of a skill."""

    def create(self, world: World, planner: MotionPlanner) -> Skill:
        """The skill in one scene; all skills of a scene share its planner."""


def hold(label: str, q: FloatArray, before: GripperCommand, after: GripperCommand, touches: Collection[str]) -> Segment:
    """The arm stands still at q, shape (7,) [rad], while the gripper goes from one command to the next."""
    return stand_still(label, gripper_time(before, after) + PAUSE, q, after, frozenset(touches))


def openings(needed: float, clearances: Sequence[float]) -> tuple[GripperCommand, ...]:
    """Commands that open the hand wider than needed by a clearance on each side, or as far as it goes; all in [m]."""
    widths = (min(needed + 2 * clearance, MAX_OPENING) for clearance in clearances)
    return tuple(GripperCommand(width) for width in dict.fromkeys(widths))


def check_clearances(field: str, clearances: Sequence[float]) -> None:
    """Raise IctampError unless there is a clearance, and each is between 0 and the opening of the hand [m]."""
    if not clearances:
        raise IctampError(Code.EMPTY, "expected one number or more, got {value}", field=field, value=clearances)
    check_vector(field, clearances, 0, MAX_OPENING, " m", count=None)


def configuration_after(
    c: Configuration, motion: Motion, *, width: float, held: str | None, moved: Mapping[str, FloatArray]
) -> Configuration:
    """c after a motion that went well: the fingers `width` apart [m], the `moved` boxes at their X_WO."""
    q = motion[-1].control_points[-1]
    return replace(imagine(c, q=q, width=width, held=held, moved=moved), gripper=motion[-1].gripper)


def imagine(
    c: Configuration,
    *,
    q: FloatArray,
    width: float,
    held: str | None,
    moved: Mapping[str, FloatArray] | None = None,
) -> Configuration:
    """c as it will be: arm at q, shape (7,) [rad], fingers `width` apart [m], the `moved` boxes at their X_WO."""
    return Configuration(np.concatenate([q, [width / 2] * 2]), {**c.poses, **(moved or {})}, held)
