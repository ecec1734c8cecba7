"""Explanation of a search that found no plan: in words for people, and as data for programs."""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any

from ictamp_drake.core.failures import Failure
from ictamp_drake.planning.result import PlanningResult, StopReason

SHOWN = 4
"""Maximum number of blocked actions, and of obstacles of each, that the text names."""

_PARAMETERS = {"pick": "grasps", "place": "placements"}
_SLOW_GENERATOR = 0.25
"""Share of the time spent on finding high-level plans above which the text blames the plan generator."""


@dataclass(frozen=True)
class Blocked:
    """An action that was tried and never succeeded.

    Attributes:
        action: The action, e.g. pick(red_box, rack).
        refusals: Number of refused parameters k by cause, the most frequent first.
        obstacles: Number of refused k by the name of the obstacle that the arm or the held box would have touched.
    """

    action: str
    refusals: Mapping[Failure, int]
    obstacles: Mapping[str, int] = field(default_factory=dict)

    @property
    def advice(self) -> str:
        """Advice against the most frequent cause."""
        return max(self.refusals, key=lambda cause: self.refusals[cause]).advice

    def __str__(self) -> str:
        """Return e.g. "pick(red_box, rack): 30 of 30 grasps: no collision-free path; in the way: blue_box (30)"."""
        total = sum(self.refusals.values())
        what = _PARAMETERS.get(self.action.partition("(")[0], "parameters k")
        line = f"{self.action}: {total} of {total} {what}: {list_causes(self.refusals)}"
        worst = ", ".join(f"{name} ({count})" for name, count in Counter(self.obstacles).most_common(SHOWN))
        return f"{line}; in the way: {worst}" if worst else line


@dataclass(frozen=True, kw_only=True)
class Explanation:
    """Explanation of the outcome of a search.

    Attributes:
        stop_reason: Name of a `StopReason`.
        blocked: Actions that never succeeded, the most often tried first.
        failures: Number of failed low-level steps by cause.
        steps: Number of low-level steps.
        plans: Number of high-level plans that were found.
        verified: Result of the last verification; False when a plan reached the goal in the search but failed when it
            was executed again; None when nothing was verified.
        planning_time_s: Planning time [s].
        generating_time_s: Part of the planning time that was spent on finding high-level plans [s].
    """

    stop_reason: str
    blocked: tuple[Blocked, ...] = ()
    failures: Mapping[Failure, int] = field(default_factory=dict)
    steps: int = 0
    plans: int = 0
    verified: bool | None = None
    planning_time_s: float = 0.0
    generating_time_s: float = 0.0

    @classmethod
    def of(cls, result: PlanningResult[Any], planning_time_s: float) -> "Explanation":
        """Return the explanation of a search that took `planning_time_s` [s]."""
        return cls(
            stop_reason=result.stop_reason.name,
            blocked=tuple(
                Blocked(str(report.action), report.refusals, dict(report.obstacles)) for report in result.blocked
            ),
            failures=dict(result.failures.most_common()),
            steps=result.low_level_steps,
            plans=result.high_level_plans,
            verified=result.verified,
            planning_time_s=planning_time_s,
            generating_time_s=result.seconds_by_stage.get("plan_generator", 0.0),
        )

    @property
    def reason(self) -> str:
        """Reason why the search ended, as a clause."""
        members = StopReason.__members__
        return str(members[self.stop_reason]) if self.stop_reason in members else self.stop_reason

    def lines(self) -> Iterator[str]:
        """Yield the obstacles to a plan, one sentence each, with advice."""
        if self.verified is False:
            yield "a plan was carried out to the goal, but failed when it was executed once more"
        for blocked in self.blocked[:SHOWN]:
            yield f"{blocked}; {blocked.advice}"
        if self.generating_time_s > _SLOW_GENERATOR * self.planning_time_s:
            took = f"{self.generating_time_s:.0f} of {self.planning_time_s:.0f} s went to finding high-level plans"
            yield f"{took}; --generator best-first finds the first one sooner"
        if not self.plans:
            yield "no high-level plan was found"
        elif not self.blocked:
            failed = f"of {self.steps} steps {sum(self.failures.values())} failed"
            causes = f": {list_causes(self.failures)}" if self.failures else ""
            yield f"every action that was tried succeeded at least once; {failed}{causes}"

    def __str__(self) -> str:
        if self.stop_reason == StopReason.SOLVED.name:
            return self.reason
        return "\n".join([self.reason, *(f"  {line}" for line in self.lines())])


def list_causes(causes: Mapping[Failure, int]) -> str:
    """List the causes, with their counts if there are several."""
    if len(causes) == 1:
        return str(next(iter(causes)))
    return ", ".join(f"{count} {cause}" for cause, count in causes.items())
