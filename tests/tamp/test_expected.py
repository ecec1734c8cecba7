"""Expected states: those of the search, and where an execution first misses one."""

from dataclasses import replace

import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.core.types import Atom
from ictamp_drake.tamp.changes import Changes
from ictamp_drake.tamp.expected import StepReport, compare_steps, expected_states
from ictamp_drake.tamp.plan import Plan
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.world import World
from tests.refusals import refusal
from tests.runs.plans import small_plan


@pytest.fixture(scope="module")
def plan() -> Plan:
    return small_plan()


@pytest.fixture(scope="module")
def world(plan: Plan) -> World:
    return World(plan.spec)


def compare(plan: Plan, world: World) -> list[StepReport]:
    states = expected_states(world, plan.c, plan.actions)
    return compare_steps(plan.replay(), SceneAbstraction(world), plan.actions, states)


def test_the_expected_states_are_those_of_the_search(plan: Plan, world: World) -> None:
    H = SceneAbstraction(world)
    ends = [attempt.successor for attempt in plan.attempts]
    assert expected_states(world, plan.c, plan.actions) == (H(plan.c), *(H(c) for c in ends if c is not None))


def test_a_plan_that_is_executed_as_it_was_found_goes_as_expected(plan: Plan, world: World) -> None:
    assert [step.as_expected for step in compare(plan, world)] == [True, True]


def test_a_hand_without_force_misses_the_first_grasp(plan: Plan, world: World) -> None:
    pick, place = compare(Changes(grip_force=0.01).apply(plan), world)
    assert not pick.as_expected
    assert Atom("in-hand", ("red_box",)) in pick.missing
    assert Atom("hand-empty", ()) in pick.unexpected
    assert "in-hand(red_box)" in str(pick)
    assert Atom("on", ("red_box", "rack")) in place.missing


def test_steps_that_were_not_executed_are_missed(plan: Plan, world: World) -> None:
    states = expected_states(world, plan.c, plan.actions)
    replay = replace(plan, attempts=plan.attempts[:1]).replay()
    first, second = compare_steps(replay, SceneAbstraction(world), plan.actions, states)
    assert first.as_expected
    assert not second.executed
    assert not second.as_expected


def test_an_action_that_is_not_applicable_is_refused(plan: Plan, world: World) -> None:
    with refusal(Code.CONFLICT, "steps[0].action", value="place(red_box, rack)"):
        expected_states(world, plan.c, plan.actions[::-1])
