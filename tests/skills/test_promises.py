"""Promises of skills: H agrees with the action's promise, and physics ends nearby."""

from dataclasses import replace

import numpy as np
import pytest

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Configuration, Skeleton
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.world.poses import to_transform
from tests.skills.rig import rig
from tests.skills.test_skills import MUST_SUCCEED

NEAR, TURNED = 0.005, 5.0
"""Maximum distance between the results of physics and the promises [m, deg]."""


def apart(c: Configuration, other: Configuration, box: str) -> tuple[float, float]:
    """Distance [m] and angle [deg] between the poses of a box in two configurations."""
    X, Y = to_transform(c.poses[box]), to_transform(other.poses[box])
    turn = (X.rotation().inverse() @ Y.rotation()).ToAngleAxis().angle()
    return float(np.linalg.norm(X.translation() - Y.translation())), float(np.degrees(turn))


@pytest.mark.parametrize(("spec", "actions"), MUST_SUCCEED.values(), ids=MUST_SUCCEED)
def test_physics_ends_where_the_skill_promises(spec: SceneSpec, actions: list[Action]) -> None:
    setup = rig(spec)
    promising = replace(setup.skills, promises=True)
    rng, c = np.random.default_rng(0), setup.start
    for action in actions:
        step = setup.step(c, action)
        attempt, state = promising.attempt(c, step, rng), step.states[1]
        assert attempt.succeeded, attempt.detail
        assert "physics" not in attempt.seconds
        assert attempt.recording is None
        executed = setup.skills.execute(c, attempt, state)
        assert executed.succeeded, executed.detail
        assert executed.motion[: len(attempt.motion)] == attempt.motion
        assert executed.seconds["motion"] == attempt.seconds["motion"]
        assert attempt.successor is not None
        assert executed.successor is not None
        assert (attempt.successor.held, attempt.successor.gripper) == (
            executed.successor.held,
            executed.successor.gripper,
        )
        np.testing.assert_array_equal(attempt.successor.commanded, executed.successor.commanded)
        for box in spec.boxes:
            distance, turn = apart(attempt.successor, executed.successor, box)
            assert distance < NEAR
            assert turn < TURNED
        c = executed.successor


def test_a_plan_made_of_promises_is_executed_from_what_physics_left() -> None:
    """The placement is planned for the promised grasp, and runs from the grasp in physics."""
    spec, (pick, place, *_) = MUST_SUCCEED["table to rack and back"]
    setup = rig(spec)
    promising = replace(setup.skills, promises=True)
    rng = np.random.default_rng(0)
    step = setup.step(setup.start, pick)
    grasp, lifted = promising.attempt(setup.start, step, rng), step.states[1]
    assert grasp.successor is not None
    placed = setup.domain.successor(lifted, place)
    placement = promising.attempt(grasp.successor, Skeleton((lifted, placed), (place,)), rng)
    held = setup.skills.execute(setup.start, grasp, lifted).successor
    assert held is not None
    assert setup.skills.execute(held, placement, placed).succeeded


def test_physics_can_say_no() -> None:
    spec, (pick, *_) = MUST_SUCCEED["table to rack and back"]
    setup = rig(spec)
    step = setup.step(setup.start, pick)
    attempt = replace(setup.skills, promises=True).attempt(setup.start, step, np.random.default_rng(0))
    moved = setup.start.poses["yellow_box"] + [0.0, 0.0, 0.0, 0.0, 0.0, 0.2, 0.0]
    elsewhere = Configuration(setup.start.q, setup.start.fingers, {**setup.start.poses, "yellow_box": moved})
    executed = setup.skills.execute(elsewhere, attempt, step.states[1])
    assert executed.failure is Failure.NOT_GRASPED
