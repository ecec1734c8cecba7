"""The search loop: budget, events, steps and records. The selection rule decides which option comes next."""

import time
from collections import defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from math import inf
from typing import Generic

import numpy as np

from ictamp_drake.core.checks import check_range
from ictamp_drake.core.protocols import Estimator, PlanGenerator, RuleContext, SkillRunner
from ictamp_drake.core.stopwatch import Stopwatch
from ictamp_drake.core.types import Attempt, C, State
from ictamp_drake.planning.events import Event, Listener, PlanFound, PlanOpened, StepDone, StepStarted, Verified
from ictamp_drake.planning.proportional import ProportionalConfig
from ictamp_drake.planning.result import Found, PlanningResult, StopReason
from ictamp_drake.planning.rule import OpenPlan, Rule, RuleConfig
from ictamp_drake.planning.tree import ROOT, Node, RunStep, Tree

Verify = Callable[[tuple[Attempt[C], ...]], bool]
"""Verification of a finished plan: the attempts from c_0 to the goal, in order -> whether the whole plan holds."""

Execute = Callable[[C, Attempt[C], State], Attempt[C]]
"""Execution in physics of a step whose end was only promised: c, the attempt, the promised state -> the new attempt."""


@dataclass(frozen=True)
class Budget:
    """Limits of one search. They are checked before every computational action, so the last one may exceed the time.

    Attributes:
        seconds: Limit of the computing time, everything included [s].
        cpu_seconds: Limit of the processor time, on the planner's `cpu_clock` [s]; None for no limit.
        steps: Limit of the low-level steps; None for no limit.
    """

    seconds: float = 60.0
    steps: int | None = None
    cpu_seconds: float | None = None

    def __post_init__(self) -> None:
        check_range("budget.seconds", self.seconds, 0, inf, " s")
        check_range("budget.steps", self.steps or 0, 0, inf)
        check_range("budget.cpu-seconds", self.cpu_seconds or 0, 0, inf, " s")


@dataclass(frozen=True)
class PlannerConfig:
    """Settings of the search.

    Attributes:
        budget: Limits after which the search gives up.
        max_expansions: Limit of the plan generator's expansions in one call (Algorithm 3, line 1).
        rule: Selection rule.
        improve: Time after the first plan in which the search goes on for a better one: one with fewer skills or, with
            as many, a shorter execution [s]. The limit of steps holds there too.
    """

    budget: Budget = Budget()
    max_expansions: int = 1000
    rule: RuleConfig = field(default_factory=ProportionalConfig)
    improve: float = 0.0

    def __post_init__(self) -> None:
        check_range("max-expansions", self.max_expansions, 1, inf)
        check_range("improve", self.improve, 0, inf, " s")

    def create(
        self,
        *,
        c: C,
        s: State,
        generator: PlanGenerator,
        skills: SkillRunner[C],
        estimator: Estimator[C],
        verify: Verify[C],
        rng: np.random.Generator,
        execute: Execute[C] | None = None,
        listeners: Sequence[Listener] = (),
        stop: Callable[[], bool] = lambda: False,
        clock: Callable[[], float] = time.perf_counter,
        cpu_clock: Callable[[], float] = time.process_time,
    ) -> "Planner[C]":
        """Create the planner for one problem.

        Args:
            c: Initial configuration c_init.
            s: H(c_init), the initial symbolic state.
            generator: Generator of high-level plans from H(c_init) to the goal.
            skills: Runner that executes one skill once.
            estimator: Estimator of P, passed to the selection rule.
            verify: Verification of a finished plan; when it returns False, the search continues.
            rng: Source of every random choice of the rule and the skills.
            execute: Execution in physics of the steps of a finished plan, needed where `skills` only promise their end.
                A step that fails there counts as a failed attempt, and the search continues from where physics ended.
            listeners: Functions called with every event.
            stop: Function called before every computational action; True ends the search as Ctrl-C does.
            clock: Clock of the budget, in seconds from any origin.
            cpu_clock: Clock of the stage times and of the limit of the processor time, in seconds from any origin.
        """
        tree = Tree(c, s)  # Algorithm 1, line 1
        rule = self.rule.create(RuleContext(estimator))
        return Planner(
            self, tree, rule, generator, skills, verify, rng, execute, tuple(listeners), stop, clock, cpu_clock
        )


@dataclass(eq=False)
class Planner(Generic[C]):
    """One search (Algorithm 1). `tree` can be read while it grows."""

    config: PlannerConfig
    tree: Tree[C]
    rule: Rule[C]
    generator: PlanGenerator
    skills: SkillRunner[C]
    verify: Verify[C]
    rng: np.random.Generator
    execute: Execute[C] | None
    listeners: tuple[Listener, ...]
    stop: Callable[[], bool]
    clock: Callable[[], float]
    cpu_clock: Callable[[], float]
    _stopwatch: Stopwatch = field(init=False)
    _finished: list[int] = field(default_factory=list, init=False)
    _executed: set[int] = field(default_factory=lambda: {ROOT}, init=False)
    _geometric_at: float | None = field(default=None, init=False)
    _found: list[Found] = field(default_factory=list, init=False)

    def __post_init__(self) -> None:
        self._stopwatch = Stopwatch(self.cpu_clock)

    def run(self) -> PlanningResult[C]:
        """Search until a plan is verified, no option is left or the budget is spent; Ctrl-C ends the search cleanly.

        With `improve`, go on for a better plan; Ctrl-C then keeps the best.
        """
        budget, limit = self.config.budget, self.config.budget.cpu_seconds
        start, cpu_start = self.clock(), self.cpu_clock()
        try:
            reason = self._search(start + budget.seconds, None if limit is None else cpu_start + limit)
            end = self.clock() + self.config.improve
            while reason is StopReason.SOLVED and self._keep_and_go_on(start, cpu_start):
                reason = self._search(end, None)
        except KeyboardInterrupt:
            reason = StopReason.STOPPED
        candidate = self._finished[-1] if self._finished else None
        found = tuple(self._found)
        if found:
            reason, candidate, spent = StopReason.SOLVED, found[-1].node, found[0]
        else:
            spent = self._measure(start, cpu_start, ROOT)
        geometric = None if self._geometric_at is None else self._geometric_at - cpu_start
        return PlanningResult(
            tree=self.tree,
            stop_reason=reason,
            planning_time_s=spent.seconds,
            cpu_time_s=spent.cpu_seconds,
            seconds_by_stage=spent.seconds_by_stage,
            candidate=candidate,
            geometric_time_s=geometric,
            found=found,
        )

    def _keep_and_go_on(self, start: float, cpu_start: float) -> bool:
        """Keep the verified plan that was just found, and say whether to look for a better one."""
        node = self._finished[-1]
        self._found.append(self._measure(start, cpu_start, node))
        if not self.config.improve or not self.tree.nodes[node].depth:
            return False
        self.tree.keep_better(node)
        self._tell(PlanFound(self.tree.path(node), self._found[-1].seconds))
        return True

    def _measure(self, start: float, cpu_start: float, node: int) -> Found:
        """Return the node with the time and effort since the start of the search."""
        seconds, cpu_seconds = self.clock() - start, self.cpu_clock() - cpu_start
        return Found(node, seconds, cpu_seconds, self._seconds_by_stage(), len(self.tree.log))

    def _search(self, deadline: float, cpu_deadline: float | None) -> StopReason:
        self.tree.exhausted = self.generator.exhausted
        while (reason := self._reason_to_stop(deadline, cpu_deadline)) is None:
            with self._stopwatch.stage("selection"):
                option = self.rule.choose(self.tree, self.rng)
            reached = self._open_plan(option) if isinstance(option, OpenPlan) else self._run_step(option)
            if (
                reached is not None
                and self.tree.is_finished(reached)
                and self._can_be_best(reached)
                and self._is_executed(reached)
                and self._is_verified(reached)
            ):
                return StopReason.SOLVED
        return reason

    def _reason_to_stop(self, deadline: float, cpu_deadline: float | None) -> StopReason | None:
        budget = self.config.budget
        if self.tree.exhausted and not self.tree.open_plans:
            return StopReason.UNREACHABLE
        if self.stop():
            return StopReason.STOPPED
        if self.clock() >= deadline:
            return StopReason.OUT_OF_TIME
        if cpu_deadline is not None and self.cpu_clock() >= cpu_deadline:
            return StopReason.OUT_OF_CPU_TIME
        if budget.steps is not None and len(self.tree.steps) >= budget.steps:
            return StopReason.OUT_OF_STEPS
        return None

    def _open_plan(self, option: OpenPlan) -> Node[C]:
        """Run Algorithm 3 and return the root, which is already at the goal when the new plan is empty."""
        before, start = self.generator.expanded, self.clock()
        with self._stopwatch.stage("plan_generator"):
            plan = self.generator.next_plan(self.config.max_expansions, option.obstructions)
        self.tree.exhausted = self.generator.exhausted
        expanded, seconds = self.generator.expanded - before, self.clock() - start
        opening = self.tree.record_opening(plan, expanded, seconds, graft=bool(option.obstructions))
        self._tell(PlanOpened(plan, opening.expanded, self.tree.exhausted))
        return self.tree.root

    def _run_step(self, option: RunStep) -> Node[C] | None:
        """Run Algorithm 2, lines 4-9, and return the node reached."""
        node, plan = self.tree.nodes[option.node], self.tree.plans[option.plan]
        self._tell(StepStarted(node, plan.actions[0]))
        attempt = self.skills.attempt(node.c, plan, self.rng, option.k)
        step = self.tree.record_step(option.node, option.plan, attempt)
        child = None if step.child is None else self.tree.nodes[step.child]
        self._tell(StepDone(node, attempt, child))
        return child

    def _can_be_best(self, node: Node[C]) -> bool:
        """Whether the plan that ends in this node is better than those before. One that is not is noted in the tree."""
        better = self.tree.can_be_best(node)
        if not better:
            self.tree.candidates[node.index] = None
        return better

    def _is_executed(self, node: Node[C]) -> bool:
        """Whether physics confirms every step that leads to the node; executes the steps that were only promised."""
        if self.execute is None:
            return True
        if self._geometric_at is None:
            self._geometric_at = self.cpu_clock()
        for number in self.tree.lineage(node.index):
            if number in self.tree.refuted:
                return False
            if number not in self._executed and not self._is_confirmed(self.tree.nodes[number], self.execute):
                return False
            self._executed.add(number)
        return True

    def _is_confirmed(self, node: Node[C], execute: Execute[C]) -> bool:
        assert node.parent is not None, "the root needs no physics"
        assert node.attempt is not None
        parent = self.tree.nodes[node.parent]
        attempt = execute(parent.c, node.attempt, node.s)
        if attempt.succeeded:
            self.tree.confirm(node.index, attempt)
        else:
            self.tree.refute(node.index, attempt)
            self._tell(StepDone(parent, attempt, None))
        return attempt.succeeded

    def _is_verified(self, node: Node[C]) -> bool:
        path = self.tree.path(node.index)
        self._finished.append(node.index)
        with self._stopwatch.stage("verification"):
            verified = self.verify(path)
        self.tree.candidates[node.index] = verified
        self._tell(Verified(node, path, verified))
        return verified

    def _seconds_by_stage(self) -> dict[str, float]:
        seconds = defaultdict(float, self._stopwatch.seconds)
        for step in self.tree.steps:
            for stage, duration in step.attempt.seconds.items():
                seconds[stage] += duration
        return dict(seconds)

    def _tell(self, event: Event) -> None:
        for listener in self.listeners:
            listener(event)
