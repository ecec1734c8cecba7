"""Execution of a whole plan by one simulator that is never reset, and the frames to show of executions."""

from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import accumulate
from time import process_time

from ictamp_drake.core.types import Attempt, Configuration
from ictamp_drake.planning.tree import ROOT, Step, Tree
from ictamp_drake.symbolic.goal import Goal
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.outcome import Frame, Outcome
from ictamp_drake.world.simulate import Physics

MAX_STEPS = 60
"""Maximum number of steps of a search that a page animates; each takes about 25 kB."""


@dataclass(frozen=True, eq=False)
class Replay:
    """One execution of a plan.

    Attributes:
        outcomes: Outcome of each skill; fewer than there are skills when the contact solver diverged.
        reached: Whether everything came to rest after each skill, and the goal holds in H of the last configuration.
        seconds: Processor time of the simulation [s].
        holds: Whether all skills were executed and the goal holds at rest in the end, also when something was still
            moving after an earlier skill.
    """

    outcomes: tuple[Outcome, ...]
    reached: bool
    seconds: float
    holds: bool

    def recorded(self, attempts: Sequence[Attempt[Configuration]]) -> tuple[Attempt[Configuration], ...]:
        """Return the executed skills with the motions and recordings of this execution."""
        return tuple(
            replace(attempt, motion=outcome.motion, recording=outcome.recording)
            for attempt, outcome in zip(attempts, self.outcomes, strict=False)
        )

    @property
    def c(self) -> Configuration:
        """Configuration in which the plan ended.

        Raises:
            IndexError: The plan is empty.
        """
        return self.outcomes[-1].c


def replay(
    physics: Physics,
    *,
    abstraction: SceneAbstraction,
    goal: Goal,
    c: Configuration,
    attempts: Sequence[Attempt[Configuration]],
) -> Replay:
    """Execute the motions of a plan from c.

    With the options of the search, every configuration equals that of the search, bit for bit. With a finer time step
    or with the whole scene awake, a skill may have to wait a little longer until everything is at rest.
    """
    start = process_time()
    outcomes: list[Outcome] = []
    with suppress(RuntimeError):  # the contact solver diverged
        for attempt in attempts:
            outcomes.append(physics.proceed(attempt.motion) if outcomes else physics.run(c, attempt.motion))
    seconds = process_time() - start
    end = outcomes[-1].c if outcomes else c
    at_rest = all(outcome.settled for outcome in outcomes[-1:])
    holds = len(outcomes) == len(attempts) and at_rest and goal.holds(abstraction(end))
    return Replay(tuple(outcomes), holds and all(outcome.settled for outcome in outcomes), seconds, holds)


def plan_frames(physics: Physics, attempts: Sequence[Attempt[Configuration]]) -> list[Frame]:
    """Return the frames of a plan from the recordings of its skills, with times from the start of the plan."""
    frames: list[Frame] = []
    for attempt, start in zip(attempts, starts(attempts), strict=True):
        if attempt.recording is not None:
            moments = physics.frames(attempt.recording)
            frames += [Frame(start + frame.time, frame.c) for frame in (moments if not frames else moments[1:])]
    return frames


def recorded_steps(physics: Physics, tree: Tree[Configuration], limit: int = MAX_STEPS) -> dict[int, list[Frame]]:
    """Return the frames of executed steps by their index in the tree's log, each from its node's c to its end.

    Args:
        physics: Simulator of the scene.
        tree: Tree of the search.
        limit: Maximum number of steps; those of the plan come first, then the other successes, then the failures.
    """
    executed = [
        (number, step)
        for number, step in enumerate(tree.log)
        if isinstance(step, Step) and step.attempt.recording is not None
    ]
    plan = tree.path(ROOT if tree.solution is None else tree.solution)
    executed.sort(key=lambda item: (item[1].attempt not in plan, item[1].child is None))
    recordings = ((number, step.attempt.recording) for number, step in executed[:limit])
    return {number: physics.frames(recording) for number, recording in recordings if recording is not None}


def starts(attempts: Sequence[Attempt[Configuration]]) -> list[float]:
    """Return the time at which each skill begins in an execution of the plan [s]."""
    return list(accumulate((attempt.duration for attempt in attempts), initial=0.0))[: len(attempts)]


def duration(attempts: Sequence[Attempt[Configuration]]) -> float:
    """Return the total time of the motions of a plan, without pauses in between [s]."""
    return sum(attempt.duration for attempt in attempts)
