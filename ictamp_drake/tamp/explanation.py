"""Explanation of a search that found no plan: in words for people, and as data for programs."""

from collections import Counter
from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ictamp_drake.core.failures import Cause, Failure
from ictamp_drake.planning.adaptive import AdaptiveConfig
from ictamp_drake.planning.result import PlanningResult, StopReason
from ictamp_drake.planning.rule import RuleConfig
from ictamp_drake.skills.config import GRID_STEP, GRID_TURN
from ictamp_drake.viz.reasons import NO_REASONS, SHOWN, Reasons, RefusedAction

if TYPE_CHECKING:
    from ictamp_drake.core.types import Action, Configuration
    from ictamp_drake.scenes.spec import SceneSpec

_PARAMETERS = {"pick": "grasp", "place": "placement"}
_GRID = f"on a grid of {1000 * GRID_STEP:g} mm and {GRID_TURN:g} deg"
_SLOW_GENERATOR = 0.25
"""Share of the time spent on finding high-level plans above which the text blames the plan generator."""


@dataclass(frozen=True)
class Blocked:
    """An action that was tried and never succeeded, or that a sweep found to be impossible.

    Attributes:
        action: The action, e.g. pick(red_box, rack).
        refusals: Number of refused parameters k by cause, the most frequent first.
        obstacles: Number of refused k by the name of the obstacle that the arm or the held box would have touched.
        swept: Whether these are all k on a grid, so that the action counts as impossible.
        beyond: Number of k for which the arm has no posture, by the joint whose limits are in the way; an empty name is
            out of reach. Only some k are looked at if there are many.
    """

    action: str
    refusals: Mapping[Cause, int]
    obstacles: Mapping[str, int] = field(default_factory=dict)
    swept: bool = False
    beyond: Mapping[str, int] = field(default_factory=dict)

    @property
    def advice(self) -> str:
        """Advice against the most frequent cause; empty if nothing was refused."""
        worst = max(self.refusals, key=lambda cause: self.refusals[cause], default=None)
        return worst.advice if isinstance(worst, Failure) else ""

    @property
    def args(self) -> tuple[str, ...]:
        """Arguments of the action, beginning with the object that it moves."""
        return tuple(self.action.rstrip(")").partition("(")[2].split(", "))

    @property
    def refused(self) -> str:
        """Number and causes of the refusals, e.g. "30 of 30 grasps refused: grasp or placement in collision"."""
        total = sum(self.refusals.values())
        what = _PARAMETERS.get(self.action.partition("(")[0], "parameter")
        if self.swept:
            beyond = " or ".join(self._limits) or _describe("")
            words: dict[Cause, Cause] = {
                Failure.NO_INVERSE_KINEMATICS: beyond,
                Failure.GOAL_IN_COLLISION: "in collision",
            }
            causes = {words.get(cause, cause): count for cause, count in self.refusals.items()}
            return f"no {what} {_GRID}: {total} of {total} refused: {list_causes(causes)}"
        limits = f" ({' or '.join(self._limits)})" if self._limits else ""
        return f"{total} of {total} {what}s refused: {list_causes(self.refusals)}{limits}"

    @property
    def _limits(self) -> list[str]:
        """Out of reach, and limits of joints, in words, the most frequent first."""
        return [_describe(joint) for joint, _ in Counter(self.beyond).most_common(SHOWN)]

    def __str__(self) -> str:
        """E.g., "pick(red_box, rack): 30 of 30 grasps refused: no collision-free path; in the way: blue_box (30)"."""
        line = f"{self.action}: {self.refused}"
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
        stuck: Whether boxes were in the way of blocked actions, and the planner never asks for plans that move them.
        scene: Scene of the search; None when it is not available, as in records.
        start: Initial configuration c_0; None when it is not available.
    """

    stop_reason: str
    blocked: tuple[Blocked, ...] = ()
    failures: Mapping[Cause, int] = field(default_factory=dict)
    steps: int = 0
    plans: int = 0
    verified: bool | None = None
    planning_time_s: float = 0.0
    generating_time_s: float = 0.0
    stuck: bool = False
    scene: "SceneSpec | None" = field(default=None, compare=False, repr=False)
    start: "Configuration | None" = field(default=None, compare=False, repr=False)

    @classmethod
    def of(
        cls,
        result: PlanningResult[Any],
        planning_time_s: float,
        scene: "SceneSpec | None" = None,
        rule: RuleConfig | None = None,
    ) -> "Explanation":
        """Return the explanation of a search that took `planning_time_s` [s], in a scene, by a selection rule."""
        boxes = scene.boxes.keys() if scene else ()
        beyond = {} if scene is None or result.solved else _count_beyond(result, scene)
        swept = result.stop_reason is StopReason.IMPOSSIBLE
        return cls(
            stop_reason=result.stop_reason.name,
            blocked=tuple(
                Blocked(
                    str(report.action),
                    dict(report.refusals.items()),
                    dict(report.obstacles),
                    swept,
                    beyond.get(report.action, {}),
                )
                for report in result.blocked
            ),
            failures=dict(result.failures.most_common()),
            steps=result.low_level_steps,
            plans=result.high_level_plans,
            verified=result.verified,
            planning_time_s=planning_time_s,
            generating_time_s=result.seconds_by_stage.get("plan_generator", 0.0),
            stuck=not isinstance(rule, AdaptiveConfig | None)
            and any(report.obstacles.keys() & boxes for report in result.blocked),
            scene=scene,
            start=result.tree.root.c,
        )

    @property
    def reason(self) -> str:
        """Reason why the search ended, as a clause."""
        members = StopReason.__members__
        return str(members[self.stop_reason]) if self.stop_reason in members else self.stop_reason

    @property
    def is_generator_slow(self) -> bool:
        """Whether finding high-level plans took much of the time."""
        return self.generating_time_s > _SLOW_GENERATOR * self.planning_time_s

    @property
    def solved(self) -> bool:
        """Whether a plan was found, so that there is nothing to explain."""
        return self.stop_reason == StopReason.SOLVED.name

    def lines(self) -> Iterator[str]:
        """Yield the obstacles to a plan, one sentence each, with advice."""
        remarks = list(self.remarks())
        first = self.verified is False
        yield from remarks[:first]
        for blocked in self.blocked[:SHOWN]:
            yield "; ".join(filter(None, [str(blocked), blocked.advice]))
        yield from remarks[first:]

    def remarks(self) -> Iterator[str]:
        """Yield remarks other than those on blocked actions, one sentence each."""
        if self.verified is False:
            yield "a plan reached the goal, but failed when it was executed again"
        if self.is_generator_slow:
            took = f"{self.generating_time_s:.0f} of {self.planning_time_s:.0f} s went to finding high-level plans"
            yield f"{took}; --generator best-first finds the first one sooner"
        if self.stop_reason == StopReason.IMPOSSIBLE.name:
            yield "other boxes were ignored, since they can be moved; --no-sweep searches all the same"
        elif not self.plans:
            yield "no high-level plan was found"
        elif not self.blocked:
            failed = f"{sum(self.failures.values())} of {self.steps} steps failed"
            causes = f": {list_causes(self.failures)}" if self.failures else ""
            yield f"every action that was tried succeeded at least once; {failed}{causes}"
        if self.stuck:
            yield "--planner adaptive moves boxes that are in the way"

    @property
    def reasons(self) -> Reasons:
        """Reasons as pages and pictures show them; none for a solved problem."""
        if self.solved:
            return NO_REASONS
        refusals = (
            RefusedAction(
                action=blocked.action,
                args=blocked.args,
                refused=blocked.refused,
                obstacles=dict(Counter(blocked.obstacles).most_common()),
                advice=blocked.advice,
            )
            for blocked in self.blocked
        )
        return Reasons(self.reason, tuple(refusals), tuple(self.remarks()))

    def draw(self, path: Path | str) -> None:
        """Write a picture of the scene at its start, with the refused actions and their obstacles (PNG).

        Raises:
            ValueError: The explanation has no scene, since it was read from a record.
        """
        from ictamp_drake.viz.picture import scene_png  # noqa: PLC0415  (drawing modules take long to load)

        if self.scene is None or self.start is None:
            raise ValueError("this explanation knows no scene")
        scene_png(self.scene, self.start, Path(path), reasons=self.reasons)

    def __str__(self) -> str:
        if self.solved:
            return self.reason
        return "\n".join([self.reason, *(f"  {line}" for line in self.lines())])


def _count_beyond(result: PlanningResult[Any], scene: "SceneSpec") -> "dict[Action, Mapping[str, int]]":
    """Count out of reach and joint limits for the blocked actions, see `Blocked.beyond`."""
    unreached = {report.action: report.unreached for report in result.blocked if report.unreached}
    if not unreached:
        return {}
    from ictamp_drake.motion.reach import Reach  # noqa: PLC0415  (Drake takes long to load, and no help needs it)

    reach = Reach(scene)
    return {action: reach.count(poses) for action, poses in unreached.items()}


def _describe(joint: str) -> str:
    return f"beyond the limits of {joint}" if joint else "out of reach"


def list_causes(causes: Mapping[Cause, int]) -> str:
    """List the causes, with their counts if there are several."""
    if len(causes) == 1:
        return str(next(iter(causes)))
    return ", ".join(f"{count} {cause}" for cause, count in causes.items())
