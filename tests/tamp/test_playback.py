"""The system that plays a plan: its outputs over time."""

import numpy as np
import pytest
from pydrake.systems.framework import Context

from ictamp_drake.tamp.plan import Plan
from ictamp_drake.tamp.playback import PlanSystem
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.world import World
from tests.runs.plans import small_plan


@pytest.fixture(scope="module")
def plan() -> Plan:
    return small_plan()


@pytest.fixture(scope="module")
def system(plan: Plan) -> PlanSystem:
    return plan.system()


@pytest.fixture
def context(system: PlanSystem) -> Context:
    return system.CreateDefaultContext()


def evaluate(system: PlanSystem, context: Context, port: str, time: float) -> object:
    context.SetTime(time)
    return system.GetOutputPort(port).Eval(context)


def test_the_desired_state_is_the_trajectory_and_its_velocity(plan: Plan, system: PlanSystem, context: Context) -> None:
    trajectory = plan.trajectory()
    for time in np.linspace(0, plan.duration, 50):
        state = np.asarray(evaluate(system, context, "desired_state", time))
        assert state.shape == (14,)
        np.testing.assert_array_equal(state[:7], trajectory.value(time)[:, 0])
        np.testing.assert_allclose(state[7:], trajectory.EvalDerivative(time, 1)[:, 0], atol=1e-12)


def test_the_arm_stands_still_after_the_end(plan: Plan, system: PlanSystem, context: Context) -> None:
    state = np.asarray(evaluate(system, context, "desired_state", plan.duration + 3))
    np.testing.assert_array_equal(state[:7], plan.attempts[-1].motion[-1].control_points[-1])
    np.testing.assert_array_equal(state[7:], 0.0)


def test_every_command_to_the_hand_has_its_turn(plan: Plan, system: PlanSystem, context: Context) -> None:
    start, seen = 0.0, [(plan.c.gripper.width, plan.c.gripper.force)]
    for attempt in plan.attempts:
        for segment in attempt.motion:
            moment = start + segment.duration / 2
            command = tuple(np.asarray(evaluate(system, context, "gripper_command", moment)))
            assert command == (segment.gripper.width, segment.gripper.force)
            seen += [command] if command != seen[-1] else []
            start += segment.duration
    assert len(seen) >= 3, "it grips and lets go"


def test_expected_atoms_change_when_a_step_is_over(plan: Plan, system: PlanSystem, context: Context) -> None:
    H = SceneAbstraction(World(plan.spec))
    expected = [H(plan.c), *(H(attempt.successor) for attempt in plan.attempts if attempt.successor)]
    first = plan.attempts[0].duration
    times = (0.0, first - 0.01, first, plan.duration - 0.01, plan.duration, plan.duration + 1)
    atoms = [evaluate(system, context, "expected_atoms", time) for time in times]
    assert atoms == [expected[0], expected[0], expected[1], expected[1], expected[2], expected[2]]


def test_a_plan_without_steps_holds_the_arm_where_it_was_commanded(plan: Plan) -> None:
    empty = Plan(plan.spec, plan.c, ()).system()
    state = np.asarray(evaluate(empty, empty.CreateDefaultContext(), "desired_state", 1.0))
    np.testing.assert_array_equal(state, [*plan.c.commanded, *[0.0] * 7])
