"""What a search leaves: the plan, the tree, and where the effort went."""

from collections import Counter
from collections.abc import Mapping
from dataclasses import dataclass, field
from enum import Enum
from typing import Generic

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Attempt, C
from ictamp_drake.planning.tree import Tree


class StopReason(Enum):
    """Why a search ended; each member is a sentence."""

    SOLVED = "a plan was found and verified"
    UNREACHABLE = "no high-level plan reaches the goal"
    OUT_OF_TIME = "the time limit was reached"
    OUT_OF_STEPS = "the limit of low-level steps was reached"
    STOPPED = "the search was stopped from outside"

    def __str__(self) -> str:
        return self.value


@dataclass
class ActionReport:
    """What became of the attempts at one action.

    Attributes:
        attempts: low-level steps.
        failures: causes of the failed ones.
        rejections: causes for which parameters k were rejected before the last one of their attempt.
        obstacles: what the arm or the held box would have touched with these, by name.
    """

    action: Action
    attempts: int = 0
    failures: Counter[Failure] = field(default_factory=Counter)
    rejections: Counter[Failure] = field(default_factory=Counter)
    obstacles: Counter[str] = field(default_factory=Counter)

    @property
    def is_blocked(self) -> bool:
        """True when no attempt succeeded."""
        return self.failures.total() == self.attempts

    @property
    def refusals(self) -> Counter[Failure]:
        """Causes for which parameters k were refused, the most frequent first."""
        return Counter(dict((self.failures + self.rejections).most_common()))

    def __str__(self) -> str:
        """One line, e.g. "pick(red_box, rack): 30 of 30: no inverse-kinematics solution"."""
        line = f"{self.action}: {self.failures.total()} of {self.attempts}"
        if self.failures:
            line += f": {_format_causes(self.failures)}"
        if self.rejections:
            line += (
                f" (before the last k of an attempt, {self.rejections.total()} more: {_format_causes(self.rejections)})"
            )
        return line


@dataclass(frozen=True, eq=False)
class PlanningResult(Generic[C]):
    """Outcome of one search.

    Attributes:
        tree: all that was tried.
        stop_reason: why the search ended.
        planning_time_s: seconds from start to end, verification included.
        seconds_by_stage: computing time of the skills' own stages and of "plan_generator", "selection" (the choice of
            what to do next, which is mostly the estimator) and "verification" [s].
        candidate: number of the node at the goal whose path is `plan`: the verified one, or else the last one found.
        geometric_time_s: processor time from the start until the first plan was finished of which no step had run in
            physics yet [s]; None when there is none, or when each step runs in physics at once.
    """

    tree: Tree[C]
    stop_reason: StopReason
    planning_time_s: float
    seconds_by_stage: Mapping[str, float]
    candidate: int | None
    geometric_time_s: float | None = None

    @property
    def solved(self) -> bool:
        """True when a plan was found and verified as a whole."""
        return self.tree.solution is not None

    @property
    def verified(self) -> bool | None:
        """Whether `plan` passed its verification, None when there is none or when the search was stopped meanwhile."""
        return None if self.candidate is None else self.tree.candidates.get(self.candidate)

    @property
    def plan(self) -> tuple[Attempt[C], ...] | None:
        """The attempts from c_0 to the goal, None when no plan was carried out to its end."""
        return None if self.candidate is None else self.tree.path(self.candidate)

    @property
    def actions(self) -> tuple[Action, ...] | None:
        """The high-level actions of `plan`."""
        return None if self.plan is None else tuple(attempt.action for attempt in self.plan)

    @property
    def high_level_plans(self) -> int:
        """Plans opened."""
        return sum(opening.plan is not None for opening in self.tree.openings)

    @property
    def low_level_steps(self) -> int:
        """Runs of a skill."""
        return len(self.tree.steps)

    @property
    def steps_by_depth(self) -> tuple[int, ...]:
        """How many steps started from a node of depth 0, 1, ... up to the deepest one that was tried."""
        depths = Counter(self.tree.nodes[step.node].depth for step in self.tree.steps)
        return tuple(depths[depth] for depth in range(max(depths, default=-1) + 1))

    @property
    def failures(self) -> Counter[Failure]:
        """Failed steps by cause."""
        return Counter(step.attempt.failure for step in self.tree.steps if step.attempt.failure is not None)

    @property
    def reports(self) -> dict[Action, ActionReport]:
        """For each attempted action, in the order of the first attempt, how often it failed and why."""
        reports: dict[Action, ActionReport] = {}
        for step in self.tree.steps:
            report = reports.setdefault(step.attempt.action, ActionReport(step.attempt.action))
            report.attempts += 1
            report.rejections.update(step.attempt.rejections)
            report.obstacles.update(step.attempt.obstacles)
            if step.attempt.failure is not None:
                report.failures[step.attempt.failure] += 1
        return reports

    @property
    def blocked(self) -> list[ActionReport]:
        """The actions that never succeeded, the most often attempted first."""
        reports = [report for report in self.reports.values() if report.is_blocked]
        return sorted(reports, key=lambda report: -report.attempts)


def _format_causes(causes: Counter[Failure]) -> str:
    if len(causes) == 1:
        return str(next(iter(causes)))
    return ", ".join(f"{count} {cause}" for cause, count in causes.most_common())
