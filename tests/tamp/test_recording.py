"""Recordings of the steps of a search."""

import numpy as np
import pytest

from ictamp_drake.core.types import Configuration
from ictamp_drake.planning.tree import Step
from ictamp_drake.skills.runner import execute
from ictamp_drake.tamp.method import Method
from ictamp_drake.tamp.replay import recorded_steps
from ictamp_drake.tamp.solve import Solution, solve
from ictamp_drake.tamp.task import load
from tests.runs.programs import SCENE


@pytest.fixture(scope="module")
def solution(tmp_path_factory: pytest.TempPathFactory) -> Solution:
    path = tmp_path_factory.mktemp("recording") / "scene.yaml"
    path.write_text(SCENE)
    method = Method(time_limit=250)
    return solve(load(path, method), method)


def executed_steps(solution: Solution) -> dict[int, Step[Configuration]]:
    log = solution.result.tree.log
    return {n: step for n, step in enumerate(log) if isinstance(step, Step) and step.attempt.motion}


def visible_part(c: Configuration | None) -> Configuration:
    """Visible part of a configuration."""
    assert c is not None
    return Configuration(c.q, c.fingers, c.poses)


def test_a_recording_leads_from_node_to_child(solution: Solution) -> None:
    recordings = recorded_steps(solution.task.physics, solution.result.tree)
    steps = executed_steps(solution)
    assert recordings.keys() == steps.keys()
    for number, frames in recordings.items():
        assert frames[0].c == visible_part(solution.result.tree.nodes[steps[number].node].c)
        assert frames[0].time == 0
        assert frames[-1].c == visible_part(steps[number].attempt.successor)
        assert np.all(np.diff([frame.time for frame in frames]) > 0)


def test_a_step_executed_again_ends_in_the_same_configuration(solution: Solution) -> None:
    for step in executed_steps(solution).values():
        c, attempt = solution.result.tree.nodes[step.node].c, step.attempt
        assert execute(solution.task.physics, c, attempt.action, attempt.motion).c == attempt.successor


def test_successes_come_first_when_there_are_too_many_steps(solution: Solution) -> None:
    successes = [number for number, step in executed_steps(solution).items() if step.child is not None]
    recordings = recorded_steps(solution.task.physics, solution.result.tree, limit=1)
    assert list(recordings) == successes[:1]
