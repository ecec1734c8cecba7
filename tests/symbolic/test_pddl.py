"""unified-planning judges our plans by its own semantics of the same domain file."""

import pytest
from hypothesis import given, settings
from unified_planning.engines import SequentialPlanValidator
from unified_planning.plans import ActionInstance, SequentialPlan

from ictamp_drake.core.types import Action
from ictamp_drake.symbolic.pddl import planning_problem
from ictamp_drake.symbolic.skeletons import BestFirst, BreadthFirst
from tests.symbolic.towers import LEVELS, Problem, problems


def is_valid(problem: Problem, actions: tuple[Action, ...]) -> bool:
    theirs = planning_problem(problem.boxes, problem.supports, problem.initial, problem.goal)
    steps = [
        ActionInstance(theirs.action(name), tuple(map(theirs.environment.expression_manager.ObjectExp, objects)))
        for name, objects in ((name, map(theirs.object, args)) for name, args in actions)
    ]
    return bool(SequentialPlanValidator().validate(theirs, SequentialPlan(steps)))


@pytest.mark.parametrize("config", [BreadthFirst(), BestFirst()], ids=["breadth_first", "best_first"])
@pytest.mark.parametrize("problem", LEVELS.values(), ids=LEVELS)
def test_the_validator_accepts_our_plans_and_no_broken_ones(problem: Problem, config: BreadthFirst | BestFirst) -> None:
    stream = config.create(problem.domain, problem.initial, problem.goal)
    plans = [plan for plan in (stream.next_plan(1000) for _ in range(10)) if plan is not None]
    assert len(plans) == 10
    for plan in plans:
        assert is_valid(problem, plan.actions)
    assert not is_valid(problem, plans[0].actions[:-1])
    assert not is_valid(problem, plans[0].actions[1:])


@settings(max_examples=20)
@given(problems(boxes=4))
def test_the_validator_agrees_on_scenes_with_tipped_boxes(problem: Problem) -> None:
    plan = BestFirst().create(problem.domain, problem.initial, problem.goal).next_plan(1000)
    assert plan is not None
    assert is_valid(problem, plan.actions)


def test_the_problem_holds_objects_start_and_goal() -> None:
    problem = LEVELS["easy"]
    theirs = planning_problem(problem.boxes, problem.supports, problem.initial, problem.goal)
    assert [o.name for o in theirs.all_objects] == [*problem.boxes, *problem.supports]
    assert sum(value.is_true() for value in theirs.initial_values.values()) == len(problem.initial)
    assert sorted(map(str, theirs.goals)) == ["on(cyan, rack)", "on(yellow, cyan)"]
