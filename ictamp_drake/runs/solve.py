"""One scene: from its file to a plan that was executed."""

import math
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from time import perf_counter, process_time

from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.core.types import Atom, Attempt, Configuration
from ictamp_drake.planning.events import Listener
from ictamp_drake.planning.planner import PlannerConfig, Verify
from ictamp_drake.planning.result import PlanningResult
from ictamp_drake.runs.options import Method
from ictamp_drake.runs.parts import Parts
from ictamp_drake.runs.replay import replay
from ictamp_drake.scenes.spec import SceneSpec, load_scene
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.symbolic.goals import check_goal, parse_goal
from ictamp_drake.world.abstraction import Abstraction
from ictamp_drake.world.simulate import Physics
from ictamp_drake.world.start import start_configuration
from ictamp_drake.world.world import World


@dataclass(frozen=True, eq=False)
class Task:
    """A scene with everything that planning in it needs.

    Attributes:
        spec: the scene.
        world: it in Drake.
        physics: its simulator.
        abstraction: H.
        c: c_0, the initial configuration when everything has come to rest.
        goal: the atoms that must hold.
        domain: its ground actions.
        started: when loading the scene began, by `time.perf_counter` [s].
        cpu_started: the same by `time.process_time` [s].
    """

    spec: SceneSpec
    world: World
    physics: Physics
    abstraction: Abstraction
    c: Configuration
    goal: frozenset[Atom]
    domain: Domain
    started: float
    cpu_started: float


@dataclass(frozen=True, eq=False)
class Solution:
    """What came of a problem.

    Attributes:
        task: the problem.
        result: what the search left.
        planning_time_s: time from the start of loading the scene until the plan was found or given up [s].
        cpu_time_s: processor time of this process in the meantime [s].
        setup_time_s: the part of it before the search [s].
        geometric_time_s: processor time until the first plan was finished of which no step had run in physics yet [s];
            None when there is none, or when each step runs in physics at once.
    """

    task: Task
    result: PlanningResult[Configuration]
    planning_time_s: float
    cpu_time_s: float
    setup_time_s: float
    geometric_time_s: float | None = None

    @property
    def kinematic_time_s(self) -> float:
        """Processor time of everything but physics [s]."""
        stages = self.result.seconds_by_stage
        return self.cpu_time_s - stages.get("physics", 0.0) - stages.get("verification", 0.0)

    @property
    def execution_time_s(self) -> float | None:
        """Computing time of the one execution of the found plan, skill by skill [s]; None when there is none."""
        return sum(attempt.seconds["physics"] for attempt in self.result.plan or ()) if self.result.solved else None


def prepare(scene: Path | SceneSpec, method: Method) -> Task:
    """Build all that is needed to plan in a scene, of a file or not.

    Raises:
        IctampError: one sentence that says what is wrong with the file, the scene or its goal.
    """
    started, cpu_started = perf_counter(), process_time()
    spec, name = (scene, "the scene") if isinstance(scene, SceneSpec) else (load_scene(scene), str(scene))
    goal = parse_goal(spec.goal, sorted(spec.boxes), sorted(spec.supports), f"{name}: goal")
    world = World(spec)
    physics = method.physics.create(world)
    abstraction = Abstraction(world, method.predicates)
    c = start_configuration(world, abstraction, physics, name)
    initial = abstraction(c)
    check_goal(goal, initial, f"{name}: goal")
    roomiest_first = sorted(spec.supports, key=lambda name: -math.prod(spec.supports[name].size[:2]))
    domain = Domain.create(sorted(spec.boxes), roomiest_first, initial)
    return Task(spec, world, physics, abstraction, c, goal, domain, started, cpu_started)


def solve(
    task: Task,
    method: Method,
    listeners: Sequence[Listener] = (),
    stop: Callable[[], bool] = lambda: False,
    parts: Parts | None = None,
) -> Solution:
    """Plan until a plan is verified or the budget is spent.

    Args:
        task: the problem.
        method: how it is solved.
        listeners: called with every event of the search.
        stop: asked before every computational action; True ends the search.
        parts: to search with, by default those that the method chose.
    """
    parts = parts or method.parts
    skills = method.skills.create(task.world, task.abstraction, task.physics, parts.sampler, parts.skills)
    budget = method.budget(elapsed=perf_counter() - task.started)
    whole = method.execution == "whole-plan"
    planner = PlannerConfig(budget, method.max_expansions, parts.rule).create(
        c=task.c,
        abstraction=task.abstraction,
        generator=parts.generator.create(task.domain, task.abstraction(task.c), task.goal),
        skills=replace(skills, promises=whole),
        execute=skills.execute if whole else None,
        estimator=parts.estimator.create(task.world, skills),
        verify=verifier(task, method),
        rng=generator(Stream.EVALUATION, method.seed, task.spec.seed),
        listeners=listeners,
        stop=stop,
    )
    setup = process_time() - task.cpu_started
    result = planner.run()
    geometric = None if result.geometric_time_s is None else setup + result.geometric_time_s
    return Solution(task, result, perf_counter() - task.started, process_time() - task.cpu_started, setup, geometric)


def verifier(task: Task, method: Method) -> Verify[Configuration]:
    """What a plan must pass after its skills were executed one after the other.

    That is one execution of the whole already, bit for bit, since a configuration is the complete state of the
    simulator. So nothing more is asked by default.
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
