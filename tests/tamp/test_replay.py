"""Plans of every level: one execution however it is divided, smooth commands, and the same with everything awake."""

from collections.abc import Iterator, Sequence
from concurrent.futures import ProcessPoolExecutor
from dataclasses import replace
from itertools import pairwise
from multiprocessing import get_context
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.interpolate import BSpline

from ictamp_drake.core.decoding import decode
from ictamp_drake.core.reading import parse
from ictamp_drake.core.types import Attempt, Configuration, FloatArray, Motion, Segment
from ictamp_drake.scenes.levels import problem_files
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.symbolic.goal import Goal
from ictamp_drake.tamp.method import Method
from ictamp_drake.tamp.plan import Plan, read_plan, write_plan
from ictamp_drake.tamp.replay import Replay, replay
from ictamp_drake.tamp.solve import Solution, solve
from ictamp_drake.tamp.task import Task, load
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.outcome import Outcome
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.simulate import Physics
from ictamp_drake.world.world import World
from tests.runs.programs import SCENE

FARTHEST, MOST_TURNED = 2e-4, 0.2
"""Maximum distance of a box from its pose with the whole scene awake [m, deg]."""

PROBLEMS = ("easy-0", "medium-0", "hard-0", "extreme-2", "varied-1")
METHOD = Method(time_limit=250)


@pytest.fixture(scope="module", params=PROBLEMS)
def solution(request: pytest.FixtureRequest) -> Solution:
    """A problem of each level with its plan."""
    (path,) = problem_files(*request.param.split("-"))
    return solve(load(path, METHOD), METHOD)


@pytest.fixture(scope="module")
def elsewhere() -> Iterator[ProcessPoolExecutor]:
    """A second process."""
    with ProcessPoolExecutor(1, mp_context=get_context("spawn")) as pool:
        yield pool


def found(solution: Solution) -> tuple[Task, tuple[Attempt[Configuration], ...]]:
    """A problem with the skills of its plan."""
    assert solution.result.solved
    assert solution.result.plan is not None
    return solution.task, solution.result.plan


def execute(task: Task, attempts: Sequence[Attempt[Configuration]], physics: PhysicsConfig = METHOD.physics) -> Replay:
    """Execute without a reset, in a new simulator."""
    simulator = physics.create(World(task.spec))
    return replay(simulator, abstraction=task.abstraction, goal=task.goal, c=task.c, attempts=attempts)


def end(attempt: Attempt[Configuration]) -> Configuration:
    assert attempt.successor is not None
    return attempt.successor


def execute_motion(spec: SceneSpec, c: Configuration, motion: Motion) -> Configuration:
    """Execute a motion in a simulator of this process, and return its end."""
    return METHOD.physics.create(World(spec)).run(c, motion, record=False).c


# one execution


@pytest.mark.slow
def test_the_search_executed_its_plan_in_one_go_bit_for_bit(solution: Solution, tmp_path: Path) -> None:
    """One simulator without a reset, given the saved and loaded plan, ends each skill in the same configuration."""
    task, attempts = found(solution)
    write_plan(Plan(task.spec, task.c, attempts), tmp_path / "plan.yaml")
    again = read_plan(tmp_path / "plan.yaml").replay()
    assert again.reached
    assert [outcome.c for outcome in again.outcomes] == [end(attempt) for attempt in attempts]
    for outcome, attempt in zip(again.outcomes, attempts, strict=True):
        assert attempt.recording is not None
        for moment in (0, -1):
            assert outcome.recording.states[moment].tobytes() == attempt.recording.states[moment].tobytes()


@pytest.mark.slow
def test_skills_end_the_same_in_other_simulators_and_another_process(
    solution: Solution, elsewhere: ProcessPoolExecutor
) -> None:
    """Each runs in its own simulator, from the end of the previous one there, without recording."""
    task, attempts = found(solution)
    c = task.c
    for attempt in attempts:
        c = elsewhere.submit(execute_motion, task.spec, c, attempt.motion).result()
        assert c == end(attempt)


@pytest.mark.slow
def test_recording_changes_no_bit(solution: Solution) -> None:
    task, attempts = found(solution)
    first, second = attempts[:2]
    physics = METHOD.physics.create(World(task.spec))
    physics.run(end(attempts[-1]), ())  # leaves a state that must not matter
    assert physics.run(task.c, first.motion, record=False).c == end(first)
    assert physics.proceed(second.motion, record=True).c == end(second)


# commands


def knot_values(segment: Segment, order: int) -> FloatArray:
    """Derivative of an order at both ends of a segment, shape (2, 7)."""
    if len(segment.control_points) == 1:
        return np.repeat(segment.control_points, 2, axis=0) if order == 0 else np.zeros((2, 7))
    spline = BSpline(segment.knots, segment.control_points, segment.order - 1)
    return np.asarray(spline(np.array([0.0, segment.knots[-1]]), nu=order))


def check_commands(c: Configuration, motions: Sequence[Motion]) -> None:
    """From c on, commanded positions are continuous, and at rest at both ends of each segment."""
    segments = [segment for motion in motions for segment in motion]
    ends = [knot_values(segment, 0) for segment in segments]
    np.testing.assert_allclose(ends[0][0], c.commanded, rtol=0, atol=1e-9)
    for before, after in pairwise(ends):
        np.testing.assert_allclose(after[0], before[1], rtol=0, atol=1e-9)
    for segment in segments:
        np.testing.assert_allclose(knot_values(segment, 1), 0.0, atol=1e-6, err_msg=segment.label)
        np.testing.assert_allclose(knot_values(segment, 2), 0.0, atol=1e-6, err_msg=segment.label)
        assert segment.knots[-1] == pytest.approx(segment.duration, abs=1e-12)


def check_steps(motion: Motion) -> None:
    """A motion lasts a whole number of time steps."""
    steps = sum(segment.duration for segment in motion) / METHOD.physics.time_step
    assert steps == pytest.approx(round(steps), abs=1e-6)


@pytest.mark.slow
def test_commands_are_continuous_and_at_rest_between_segments(solution: Solution) -> None:
    task, attempts = found(solution)
    check_commands(task.c, [attempt.motion for attempt in attempts])
    for attempt in attempts:
        check_steps(attempt.motion)
        assert end(attempt).commanded.tobytes() == attempt.motion[-1].control_points[-1].tobytes()


# sleep


def difference(one: Configuration, other: Configuration) -> tuple[float, float]:
    """Maximum distance [m] and maximum angle [deg] between the poses of a box in two configurations."""
    X = [to_transform(pose).inverse() @ to_transform(other.poses[name]) for name, pose in one.poses.items()]
    shift = max(np.linalg.norm(each.translation()) for each in X)
    return float(shift), float(np.degrees(max(each.rotation().ToAngleAxis().angle() for each in X)))


@pytest.mark.slow
def test_what_sleeps_changes_nothing(solution: Solution) -> None:
    """After every skill of a plan, boxes are where they are with the whole scene awake, and H is the same."""
    task, attempts = found(solution)
    awake = execute(task, attempts, replace(METHOD.physics, sleep=False))
    assert awake.reached
    for outcome, attempt in zip(awake.outcomes, attempts, strict=True):
        assert task.abstraction(outcome.c) == task.abstraction(end(attempt))
        shift, turn = difference(outcome.c, end(attempt))
        assert shift < FARTHEST
        assert turn < MOST_TURNED


# a plan that does not hold


@pytest.fixture(scope="module")
def small() -> Solution:
    """A scene that takes two skills."""
    return solve(load(decode(SceneSpec, parse(SCENE)), METHOD), METHOD)


def test_a_plan_without_its_last_skill_is_executed_but_does_not_reach_the_goal(small: Solution) -> None:
    task, attempts = found(small)
    short = execute(task, attempts[:-1])
    assert len(short.outcomes) == len(attempts) - 1
    assert not short.reached


def test_an_empty_plan_reaches_what_holds_already(small: Solution) -> None:
    assert not execute(small.task, ()).reached
    assert execute(replace(small.task, goal=Goal.of(())), ()).reached


def test_an_execution_in_which_the_solver_diverges_does_not_reach_the_goal(small: Solution) -> None:
    """The execution ends there."""
    task, attempts = found(small)
    state = task.c.x
    assert state is not None
    wild = replace(task.c, x=np.append(state[:-3], np.full(3, np.nan)))
    diverged = execute(replace(task, c=wild, goal=Goal.of(())), attempts, replace(METHOD.physics, sleep=False))
    assert not diverged.reached
    assert diverged.outcomes == ()


class Restless(Physics):
    """A simulator that says that something moves after the first skill."""

    def run(self, *arguments: Any, **options: Any) -> Outcome:
        return replace(super().run(*arguments, **options), settled=False)


def test_a_goal_that_holds_in_the_end_holds_also_when_something_moved_on_the_way(small: Solution) -> None:
    task, attempts = found(small)
    world = World(task.spec)
    again = replay(
        Restless(world, METHOD.physics), abstraction=task.abstraction, goal=task.goal, c=task.c, attempts=attempts
    )
    assert again.holds
    assert not again.reached
    assert execute(task, attempts).holds
    assert not execute(task, attempts[:-1]).holds
