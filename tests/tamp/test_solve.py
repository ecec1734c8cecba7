"""Solving one scene in this process."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.core.types import Configuration
from ictamp_drake.estimators.p_score import PScoreConfig
from ictamp_drake.estimators.q_value import QValueConfig
from ictamp_drake.planning.events import StepDone
from ictamp_drake.planning.result import StopReason
from ictamp_drake.planning.tree import Step
from ictamp_drake.runs.records import record_of
from ictamp_drake.scenes.levels import problem_files
from ictamp_drake.scenes.spec import load_scene
from ictamp_drake.skills.config import PolicyConfig
from ictamp_drake.symbolic.context import GeneratorContext
from ictamp_drake.symbolic.skeletons import BestFirst
from ictamp_drake.tamp.method import Estimators, Method, Samplers
from ictamp_drake.tamp.replay import plan_frames, starts
from ictamp_drake.tamp.solve import Solution, solve, verifier
from ictamp_drake.tamp.task import load
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.outcome import Outcome
from ictamp_drake.world.simulate import Physics
from tests.learning.synthetic import write_untrained
from tests.refusals import refusal
from tests.runs.programs import SCENE


@pytest.fixture
def scene(tmp_path: Path) -> Path:
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE)
    return path


def first_k(scene: Path, seed: int) -> list[float]:
    method = Method(seed=seed, max_steps=1, time_limit=250)
    (step,) = solve(load(scene, method), method).result.tree.steps
    assert step.attempt.k is not None
    return step.attempt.k.tolist()


def test_the_seed_decides_the_parameters(scene: Path) -> None:
    assert first_k(scene, 0) == first_k(scene, 0) != first_k(scene, 1)


def test_a_scene_needs_no_file(scene: Path) -> None:
    method, spec = Method(), load_scene(scene)
    made, read = load(spec, method), load(scene, method)
    assert (made.spec, made.c, made.goal) == (read.spec, read.c, read.goal)
    with refusal(Code.UNKNOWN_CHOICE, "goal", file="the scene", value="nowhere"):
        load(replace(spec, goal="(on red_box nowhere)"), method)


def test_a_solution_can_be_shown_from_the_recordings_of_its_skills(scene: Path) -> None:
    method = Method(time_limit=250)
    events: list[object] = []
    solution = solve(load(scene, method), method, listeners=[events.append])
    assert solution.result.plan is not None
    motion = [segment for attempt in solution.result.plan for segment in attempt.motion]
    first = sum(segment.duration for segment in solution.result.plan[0].motion)
    assert starts(solution.result.plan)[:2] == [0.0, first]
    frames = plan_frames(solution.task.physics, solution.result.plan)
    times = np.array([frame.time for frame in frames])
    assert times[0] == 0
    assert np.all(np.diff(times) > 0)
    assert times[-1] == pytest.approx(sum(segment.duration for segment in motion))
    assert frames[0].c == Configuration(solution.task.c.q, solution.task.c.fingers, solution.task.c.poses)
    assert sum(isinstance(event, StepDone) for event in events) == solution.result.low_level_steps
    end = solution.result.plan[-1].successor
    assert end is not None
    assert solution.task.goal.holds(solution.task.abstraction(end))
    assert frames[-1].c == Configuration(end.q, end.fingers, end.poses)


class Counted(Physics):
    """A simulator that counts its executions."""

    executions = 0

    def proceed(self, *arguments: Any, **options: Any) -> Outcome:
        self.executions += 1
        return super().proceed(*arguments, **options)


def test_a_plan_is_executed_once_unless_more_is_asked(scene: Path) -> None:
    method = Method(time_limit=250)
    task = load(scene, method)
    counted = Counted(task.world, method.physics)
    result = solve(replace(task, physics=counted), method).result
    assert result.solved
    assert counted.executions == sum(step.attempt.recording is not None for step in result.tree.steps)
    assert sum(isinstance(step, Step) for step in result.tree.log) >= counted.executions > 0
    assert method.verification is None
    assert verifier(task, method)(())  # not even looked at


@pytest.mark.slow
@pytest.mark.parametrize(("verify", "time_step"), [("awake", 0.004), ("fine", 0.001)])
def test_a_plan_that_holds_is_solved_when_it_is_executed_again(scene: Path, verify: Any, time_step: float) -> None:
    method = Method(time_limit=250, verify=verify)
    assert method.verification == PhysicsConfig(sleep=False, time_step=time_step)
    solution = solve(load(scene, method), method)
    assert solution.result.solved
    record = record_of("scene", "", None, 0, solution)
    assert record.solved
    assert record.verified
    assert record.seconds_by_stage["verification"] > 0


class Slippery(Method):
    """A method that verifies plans with fingers that cannot press."""

    @property
    def verification(self) -> PhysicsConfig | None:
        physics = super().verification
        return physics and replace(physics, min_pad_force=1e-3, finger_stiffness=1e-3, rest_speed=1e-6)


@pytest.mark.slow
@pytest.mark.parametrize("verify", ["awake", "fine"])
def test_a_plan_that_does_not_hold_when_it_is_executed_again_is_not_solved(scene: Path, verify: Any) -> None:
    """Nothing is at rest in the physics of the verification."""
    method = Slippery(time_limit=250, max_steps=6, verify=verify)
    solution = solve(load(scene, method), method)
    result = solution.result
    assert result.plan is not None
    assert all(attempt.succeeded for attempt in result.plan), "its skills reached the goal"
    assert not result.solved
    assert result.verified is False
    record = record_of("scene", "", None, 0, solution)
    assert not record.solved
    assert record.verified is False
    assert record.replay_time_s is None
    assert solve(load(scene, replace(method, verify="none")), replace(method, verify="none")).result.solved


def solve_and_stop(scene: Path, method: Method, after: int) -> Solution:
    """Run the search, and stop it from outside after some steps."""
    events: list[object] = []
    task = load(scene, method)
    return solve(
        task, method, listeners=[events.append], stop=lambda: sum(isinstance(e, StepDone) for e in events) >= after
    )


def test_a_stopped_search_keeps_what_was_found(scene: Path) -> None:
    solution = solve_and_stop(scene, Method(time_limit=250), after=1)
    assert solution.result.stop_reason is StopReason.STOPPED
    assert solution.execution_time_s is None
    record = record_of("scene", "", None, 0, solution)
    assert record.low_level_steps == 1
    assert record.plan_length is None
    assert not record.is_final


PARKED = """\
supports:
  table: {kind: table, position: [0.3, 0.0, 0.0]}
boxes:
  low: {size: [0.05, 0.05, 0.05], position: [0.45, 0.0, 0.025]}
  tall: {size: [0.05, 0.05, 0.2], position: [0.45, 0.054, 0.1]}
  far: {size: [0.07, 0.07, 0.05], position: [0.45, -0.25, 0.025]}
goal: (on low far)
"""
"""The hand does not fit between low and tall, which the goal does not mention, and there is only one table."""


def test_adaptive_allocation_moves_a_box_out_of_the_way_and_puts_it_down_again(tmp_path: Path) -> None:
    (tmp_path / "parked.yaml").write_text(PARKED)
    method = Method(planner="adaptive", time_limit=250)
    solution = solve(load(tmp_path / "parked.yaml", method), method)
    assert solution.result.actions is not None
    assert solution.result.verified
    assert list(map(str, solution.result.actions)) == [
        "pick(tall, table)",
        "place(tall, table)",
        "pick(low, table)",
        "place(low, far)",
    ]


def test_a_record_names_what_was_in_the_way(tmp_path: Path) -> None:
    (tmp_path / "parked.yaml").write_text(PARKED)
    method = Method(max_steps=10, time_limit=250)
    solution = solve(load(tmp_path / "parked.yaml", method), method)
    record = record_of("parked", "", None, 0, solution)
    assert "tall" in record.obstacles["pick(low, table)"]
    assert record.obstacles.keys() <= record.blocked.keys()


@pytest.mark.slow
@pytest.mark.parametrize(("level", "least"), [("extreme", 8), ("varied", 1)])
def test_problems_of_our_own_levels_start_at_rest_and_have_plans(level: str, least: int) -> None:
    for path in problem_files(level):
        task = load(path, Method())
        plan = BestFirst().create(GeneratorContext(task.domain, task.abstraction(task.c), task.goal)).next_plan(1000)
        assert plan is not None
        assert len(plan) >= least


def test_time_spent_before_the_search_counts(scene: Path) -> None:
    method = Method(time_limit=0.0)
    solution = solve(load(scene, method), method)
    assert solution.result.stop_reason is StopReason.OUT_OF_TIME
    assert solution.result.low_level_steps == 0
    assert solution.planning_time_s > solution.result.planning_time_s


def test_processor_time_spent_before_the_search_counts(scene: Path) -> None:
    solution = solve(load(scene), time_limit=1000.0, cpu_limit=0.01)
    assert solution.result.stop_reason is StopReason.OUT_OF_CPU_TIME
    assert solution.result.low_level_steps == 0


@pytest.mark.parametrize("estimator", ["p_score", "q_value"])
def test_what_was_learned_takes_part_in_the_search(scene: Path, tmp_path: Path, estimator: str) -> None:
    """Even untrained networks draw k and score the options."""
    folder = write_untrained(tmp_path)
    learned = Estimators(p_score=PScoreConfig(folder), q_value=QValueConfig(folder))
    samplers = Samplers(policy=PolicyConfig(folder, candidates=4))
    method = Method(
        time_limit=250, max_steps=2, sampler="policy", estimator=estimator, samplers=samplers, estimators=learned
    )
    method.check()
    result = solve(load(scene, method), method).result
    assert result.low_level_steps == 2
    for step in result.tree.steps:
        assert step.attempt.k is not None


def test_a_goal_that_holds_already_is_solved_whatever_the_limits() -> None:
    method = Method(time_limit=0.0, cpu_limit=0.0)
    nothing = Path(__file__).parents[1] / "scenes" / "cases" / "16-nothing-to-do.yaml"
    solution = solve(load(nothing, method), method)
    assert solution.plan is not None
    assert len(solution.plan) == 0
