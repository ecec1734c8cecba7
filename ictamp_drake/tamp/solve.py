"""Solve a task: find a plan that was executed in simulation, or the reasons why there is none."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from time import perf_counter, process_time
from typing import Any

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.core.types import Attempt, Configuration
from ictamp_drake.estimators.context import EstimatorContext
from ictamp_drake.planning.events import Listener
from ictamp_drake.planning.planner import Budget, PlannerConfig, Verify
from ictamp_drake.planning.result import ActionReport, PlanningResult, StopReason
from ictamp_drake.planning.tree import Tree
from ictamp_drake.skills import (  # noqa: F401  (loaded now, so that no search is charged with it)
    chain,
    ik_sampler,
    pick,
    place,
    policy,
    runner,
    uniform,
)
from ictamp_drake.symbolic.context import GeneratorContext
from ictamp_drake.tamp.explanation import Explanation
from ictamp_drake.tamp.impossible import find_impossible
from ictamp_drake.tamp.method import SCENE_METHOD, Method
from ictamp_drake.tamp.plan import Plan
from ictamp_drake.tamp.plan_origin import Origin
from ictamp_drake.tamp.replay import replay
from ictamp_drake.tamp.task import Task


@dataclass(frozen=True, eq=False)
class Solution:
    """Outcome of a task.

    Attributes:
        task: Task that was solved.
        result: Result of the search.
        planning_time_s: Time for building the scene and for the search, up to its first plan [s].
        cpu_time_s: Processor time of this process over the same span [s].
        setup_time_s: Part of the processor time that was spent before the search [s].
        geometric_time_s: Processor time until the first plan was finished, before any of its steps ran in physics [s];
            None when no plan was finished, or when each step runs in physics at once.
        method: Method that solved the task, with the parts that served.
        stand_ins: Names of the parts that served in place of those trained with another robot, by their option.
    """

    task: Task
    result: PlanningResult[Configuration]
    planning_time_s: float
    cpu_time_s: float
    setup_time_s: float
    geometric_time_s: float | None = None
    method: Method = SCENE_METHOD
    stand_ins: Mapping[str, str] = field(default_factory=dict)

    @property
    def plan(self) -> Plan | None:
        """Best plan that was found and executed; None when there is none, see `explain`."""
        if not self.result.found:
            return None
        return self.plans[-1]

    @property
    def plans(self) -> tuple[Plan, ...]:
        """Every plan that was found, each better than the one before; more than one only with `improve`."""
        paths = (self.result.tree.path(found.node) for found in self.result.found)
        return tuple(Plan(self.task.spec, self.task.c, path, Origin.of(self.method)) for path in paths)

    def explain(self) -> Explanation:
        """Explain why the search ended, what refused each blocked action, and what would help; `str` of it is text."""
        return Explanation.of(self.result, self.planning_time_s, self.task.spec, self.method.rule_config)

    @property
    def kinematic_time_s(self) -> float:
        """Processor time of everything except physics [s]."""
        stages = self.result.seconds_by_stage
        return self.cpu_time_s - stages.get("physics", 0.0) - stages.get("verification", 0.0)

    @property
    def execution_time_s(self) -> float | None:
        """Computing time of the found plan's execution in the search [s]; None when there is no plan."""
        return sum(attempt.seconds["physics"] for attempt in self.result.plan or ()) if self.result.solved else None


def solve(
    task: Task,
    method: Method = SCENE_METHOD,
    *,
    listeners: Sequence[Listener] = (),
    stop: Callable[[], bool] = lambda: False,
    **options: Any,
) -> Solution:
    """Search until a plan is found and executed, or the budget is spent.

    A goal that holds already is reached by the empty plan, whatever the budget. With `sweep`, there is no search when
    an action that every plan needs is impossible. With `improve`, the search goes on after the first plan.

    Where the sampler or the estimator was trained with another robot than that of the task, another one serves, see
    `Solution.stand_ins`.

    Drake's diagrams refer to each other, so only `gc.collect()` frees those of earlier solutions. Call it once per
    problem in a loop of your own, which otherwise grows by some megabytes a problem; runs of this package do so.

    Args:
        task: Task to solve.
        method: Method that solves the task.
        listeners: Functions that are called with every event of the search.
        stop: Function that is called before every computational action; True ends the search.
        options: Fields of `Method` to change, e.g. sampler="optimization", time_limit=30. A part is given by its name
            or as a configuration of your own, e.g. sampler=MySampler().

    Raises:
        IctampError: An option or its value does not exist, the task was loaded with different physics, or the rule
            needs an estimator that was trained with another robot.
    """
    started, cpu_started = perf_counter(), process_time()
    method = method.with_options(**options)
    stand_ins = method.list_stand_ins(task.spec.robot)
    method = method.with_options(**stand_ins)
    if method.physics != task.physics.config:
        problem = "expected the physics of the task"
        raise IctampError(Code.CONFLICT, problem, field="physics", advice="pass the same method to load and solve")
    skills = method.skills.create(task.world, task.abstraction, task.physics, method.sampler_config)
    whole = method.execution == "whole-plan"
    estimator = method.estimator_config.create(EstimatorContext(task.world, skills))
    impossible = find_impossible(task, method.skills) if method.sweep else ()
    budget = method.budget(
        elapsed=task.setup_time_s + perf_counter() - started,
        cpu_elapsed=task.setup_cpu_time_s + process_time() - cpu_started,
    )
    if task.goal.holds(task.s):  # the empty plan is found at once, however short the limits are
        budget = Budget()
    planner = PlannerConfig(budget, method.max_expansions, method.rule_config, method.improve).create(
        c=task.c,
        s=task.s,
        generator=method.generator_config.create(GeneratorContext(task.domain, task.s, task.goal)),
        skills=replace(skills, promises=whole),
        execute=skills.execute if whole else None,
        estimator=estimator,
        verify=verifier(task, method),
        rng=generator(Stream.EVALUATION, method.seed, task.spec.seed),
        listeners=listeners,
        stop=stop,
    )
    before, setup = task.setup_time_s + perf_counter() - started, task.setup_cpu_time_s + process_time() - cpu_started
    result = planner.run() if not impossible else _refuse(task, impossible)
    geometric = None if result.geometric_time_s is None else setup + result.geometric_time_s
    planning, cpu_time = before + result.planning_time_s, setup + result.cpu_time_s
    return Solution(task, result, planning, cpu_time, setup, geometric, method, stand_ins)


def _refuse(task: Task, impossible: tuple[ActionReport, ...]) -> PlanningResult[Configuration]:
    return PlanningResult(Tree(task.c, task.s), StopReason.IMPOSSIBLE, 0.0, 0.0, {}, None, impossible=impossible)


def verifier(task: Task, method: Method) -> Verify[Configuration]:
    """Return the check that a plan must pass after its skills were executed one after the other.

    Executing the skills one by one already equals an execution of the whole plan, bit for bit, since a configuration is
    the complete state of the simulator. By default there is no further check.
    """

    def verify(attempts: tuple[Attempt[Configuration], ...]) -> bool:
        physics = method.verification
        return (
            physics is None
            or replay(
                physics.create(task.world), abstraction=task.abstraction, goal=task.goal, c=task.c, attempts=attempts
            ).reached
        )

    return verify
