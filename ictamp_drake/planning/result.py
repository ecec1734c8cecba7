"""Result of a search: the plan, the tree, and how the effort was spent."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Generic

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Attempt, C, FloatArray
from ictamp_drake.planning.tree import Opening, Step, Tree


class StopReason(Enum):
    """Reason why a search ended; each member is a sentence."""

    SOLVED = "a plan was found and verified"
    UNREACHABLE = "no high-level plan reaches the goal"
    IMPOSSIBLE = "every plan needs an action that is impossible"
    OUT_OF_TIME = "the time limit was reached"
    OUT_OF_CPU_TIME = "the limit of the processor time was reached"
    OUT_OF_STEPS = "the limit of low-level steps was reached"
    STOPPED = "the search was stopped from outside"

    def __str__(self) -> str:
        return self.value


@dataclass
class ActionReport:
    """Outcome of all attempts at one action.

    Attributes:
        action: High-level action.
        attempts: Number of low-level steps.
        failures: Causes of the failed attempts, with their counts.
        rejections: Causes that rejected a parameter k before the last one of its attempt, with their counts.
        obstacles: Objects that the arm or the held box would have touched with the rejected k, by name, with counts.
        unreached: Poses of the hand at which the arm has no posture, see `Attempt.unreached`.
    """

    action: Action
    attempts: int = 0
    failures: Counter[Failure] = field(default_factory=Counter)
    rejections: Counter[Failure] = field(default_factory=Counter)
    obstacles: Counter[str] = field(default_factory=Counter)
    unreached: list[FloatArray] = field(default_factory=list)

    @property
    def is_blocked(self) -> bool:
        """True when no attempt succeeded."""
        return self.failures.total() == self.attempts

    @property
    def refusals(self) -> Counter[Failure]:
        """Causes that rejected parameters k, the last one of each attempt included, most frequent first."""
        return Counter(dict((self.failures + self.rejections).most_common()))

    def __str__(self) -> str:
        """Format as one line, e.g. "pick(red_box, rack): 30 of 30: no inverse-kinematics solution"."""
        line = f"{self.action}: {self.failures.total()} of {self.attempts}"
        if self.failures:
            line += f": {_format_causes(self.failures)}"
        if self.rejections:
            line += (
                f" (before the last k of an attempt, {self.rejections.total()} more: {_format_causes(self.rejections)})"
            )
        return line


@dataclass(frozen=True)
class Found:
    """Verified plan that is better than all before, and the time and effort until it was found.

    Attributes:
        node: Number of the node at the goal.
        seconds: Time since the start of the search [s].
        cpu_seconds: Processor time since the start of the search [s].
        seconds_by_stage: Computing time by stage until then [s].
        entries: Number of entries of the tree's log by then.
    """

    node: int
    seconds: float
    cpu_seconds: float
    seconds_by_stage: Mapping[str, float]
    entries: int


@dataclass(frozen=True, eq=False)
class PlanningResult(Generic[C]):
    """Outcome of one search.

    If the search went on after its first plan, all times and counts end with that plan.

    Attributes:
        tree: Completion tree with everything that was tried.
        stop_reason: Reason why the search ended.
        planning_time_s: Time from the start to the first plan, verification included, or to the end [s].
        cpu_time_s: Processor time over the same span [s].
        seconds_by_stage: Computing time of the skills' own stages and of "plan_generator", "selection" (the choice of
            the next option, mostly time of the estimator) and "verification" [s].
        candidate: Number of the node at the goal whose path is `plan`: the best verified one, or else the last one
            found.
        geometric_time_s: Processor time from the start until the first plan was finished, before any of its steps ran
            in physics [s]. None when no plan was finished, or when each step runs in physics at once.
        impossible: Reports of actions that every plan needs and for which no parameter on a grid is free. If there are
            any, there was no search.
        found: Verified plans in order, each better than the one before.
    """

    tree: Tree[C]
    stop_reason: StopReason
    planning_time_s: float
    cpu_time_s: float
    seconds_by_stage: Mapping[str, float]
    candidate: int | None
    geometric_time_s: float | None = None
    impossible: tuple[ActionReport, ...] = ()
    found: tuple[Found, ...] = ()

    @property
    def solved(self) -> bool:
        """True when a plan was found and verified as a whole."""
        return bool(self.found)

    @property
    def verified(self) -> bool | None:
        """Whether `plan` passed verification; None without a plan, or when verification was interrupted."""
        return None if self.candidate is None else self.tree.candidates.get(self.candidate)

    @property
    def plan(self) -> tuple[Attempt[C], ...] | None:
        """Attempts from c_0 to the goal, or None when no plan was carried out to its end."""
        return None if self.candidate is None else self.tree.path(self.candidate)

    @property
    def actions(self) -> tuple[Action, ...] | None:
        """High-level actions of `plan`, or None when there is no plan."""
        return None if self.plan is None else tuple(attempt.action for attempt in self.plan)

    @property
    def high_level_plans(self) -> int:
        """Number of plans opened."""
        return sum(isinstance(entry, Opening) and entry.plan is not None for entry in self._log)

    @property
    def low_level_steps(self) -> int:
        """Number of skill runs."""
        return len(self._steps)

    @property
    def steps_by_depth(self) -> tuple[int, ...]:
        """Number of steps that started from nodes of depth 0, 1, ... up to the deepest node tried."""
        depths = Counter(self.tree.nodes[step.node].depth for step in self._steps)
        return tuple(depths[depth] for depth in range(max(depths, default=-1) + 1))

    @property
    def failures(self) -> Counter[Failure]:
        """Number of failed steps by cause."""
        return Counter(step.attempt.failure for step in self._steps if step.attempt.failure is not None)

    @property
    def reports(self) -> dict[Action, ActionReport]:
        """Report of each attempted action, in order of first attempt."""
        reports: dict[Action, ActionReport] = {}
        for step in self._steps:
            report = reports.setdefault(step.attempt.action, ActionReport(step.attempt.action))
            report.attempts += 1
            report.rejections.update(step.attempt.rejections)
            report.obstacles.update(step.attempt.obstacles)
            report.unreached += step.attempt.unreached
            if step.attempt.failure is not None:
                report.failures[step.attempt.failure] += 1
        return reports

    @property
    def blocked(self) -> list[ActionReport]:
        """Reports of the actions that are impossible or never succeeded, most attempted first."""
        reports = [report for report in self.reports.values() if report.is_blocked]
        return [*self.impossible, *sorted(reports, key=lambda report: -report.attempts)]

    @property
    def _log(self) -> list[Opening | Step[C]]:
        """Log of the tree, up to the first verified plan if there is one."""
        return self.tree.log[: self.found[0].entries] if self.found else self.tree.log

    @property
    def _steps(self) -> list[Step[C]]:
        return [entry for entry in self._log if isinstance(entry, Step)]


def _format_causes(causes: Counter[Failure]) -> str:
    if len(causes) == 1:
        return str(next(iter(causes)))
    return ", ".join(f"{count} {cause}" for cause, count in causes.most_common())
