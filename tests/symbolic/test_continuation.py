"""Plans that begin with a given action."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.core.types import Action
from ictamp_drake.symbolic.context import GeneratorContext
from ictamp_drake.symbolic.continuation import continue_plan
from ictamp_drake.symbolic.skeletons import BreadthFirst
from tests.symbolic.towers import LEVELS, Problem, problems


@given(problems(), st.data())
def test_a_plan_begins_with_the_action_and_goes_on_to_the_goal(problem: Problem, data: st.DataObject) -> None:
    action, promised = data.draw(st.sampled_from(problem.domain.successors(problem.initial)))
    plan = continue_plan(problem.domain, problem.initial, action, problem.goal)
    assert plan.actions[0] == action
    assert plan.states[:2] == (problem.initial, promised)
    for before, step, after in zip(plan.states, plan.actions, plan.states[1:], strict=False):
        assert problem.domain.successor(before, step) == after
    assert problem.goal.holds(plan.states[-1])


@pytest.mark.parametrize("name", LEVELS)
def test_the_first_action_of_a_shortest_plan_makes_no_plan_longer(name: str) -> None:
    problem = LEVELS[name]
    shortest = BreadthFirst().create(GeneratorContext(problem.domain, problem.initial, problem.goal)).next_plan(1000)
    assert shortest is not None
    plan = continue_plan(problem.domain, problem.initial, shortest.actions[0], problem.goal)
    assert len(plan) == len(shortest)


def test_without_a_plan_within_the_limit_the_action_stands_alone() -> None:
    problem = LEVELS["hard"]
    action, promised = problem.domain.successors(problem.initial)[0]
    plan = continue_plan(problem.domain, problem.initial, action, problem.goal, max_expansions=5)
    assert plan.actions == (action,)
    assert plan.states == (problem.initial, promised)


def test_an_action_that_does_not_apply_is_refused() -> None:
    problem = LEVELS["easy"]
    with pytest.raises(ValueError, match="not applicable"):
        continue_plan(problem.domain, problem.initial, Action("place", ("red", "rack")), problem.goal)
