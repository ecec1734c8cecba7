"""The steps of a search, as they were executed."""

import numpy as np
import pytest

from ictamp_drake.core.types import Configuration
from ictamp_drake.planning.tree import Step
from ictamp_drake.runs.options import Method
from ictamp_drake.runs.recording import record_steps
from ictamp_drake.runs.solve import Solution, prepare, solve
from ictamp_drake.skills.runner import execute
from tests.runs.programs import SCENE


@pytest.fixture(scope="module")
def solution(tmp_path_factory: pytest.TempPathFactory) -> Solution:
    path = tmp_path_factory.mktemp("recording") / "scene.yaml"
    path.write_text(SCENE)
    method = Method(time_limit=250)
    return solve(prepare(path, method), method)


def executed(solution: Solution) -> dict[int, Step[Configuration]]:
    log = solution.result.tree.log
    return {n: step for n, step in enumerate(log) if isinstance(step, Step) and step.attempt.motion}


def apart(c: Configuration, other: Configuration) -> float:
    """Greatest difference of a number in two configurations [m, rad]."""
    differences = [np.abs(c.q - other.q).max(), *(np.abs(c.poses[box] - other.poses[box]).max() for box in c.poses)]
    return float(max(differences))


@pytest.mark.parametrize("verified", [True, False])
def test_a_recording_leads_from_node_to_child(solution: Solution, verified: bool) -> None:
    replay = solution.replay if verified else None
    recordings = record_steps(solution.task.physics, solution.result.tree, replay)
    steps = executed(solution)
    assert recordings.keys() == steps.keys()
    for number, frames in recordings.items():
        assert frames[0].c is solution.result.tree.nodes[steps[number].node].c
        assert frames[0].time == 0
        assert frames[-1].c is steps[number].attempt.successor
        assert np.all(np.diff([frame.time for frame in frames]) > 0)
        assert apart(frames[-2].c, frames[-1].c) < 1e-3, "the recording ends where the search was"
        assert apart(frames[0].c, frames[1].c) < 1e-2, "and begins there"


def test_the_verified_plan_is_shown_by_its_replay(solution: Solution) -> None:
    tree, replay = solution.result.tree, solution.replay
    assert replay is not None
    assert tree.solution is not None
    recordings = record_steps(solution.task.physics, tree, replay)
    of_attempt = {step.attempt: recordings[number] for number, step in executed(solution).items()}
    shown = [frame.c for attempt in tree.path(tree.solution) for frame in of_attempt[attempt][1:-1]]
    assert shown == [frame.c for frame in replay.frames[1:]]


def test_a_step_executed_again_ends_in_the_same_configuration(solution: Solution) -> None:
    for step in executed(solution).values():
        c, attempt = solution.result.tree.nodes[step.node].c, step.attempt
        assert execute(solution.task.physics, c, attempt.action, attempt.motion).c == attempt.successor


def test_successes_come_first_when_there_are_too_many_steps(solution: Solution) -> None:
    successes = [number for number, step in executed(solution).items() if step.child is not None]
    recordings = record_steps(solution.task.physics, solution.result.tree, solution.replay, limit=1)
    assert list(recordings) == successes[:1]
