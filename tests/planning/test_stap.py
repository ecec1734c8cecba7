"""STAP's strategy: all plans up to a depth, each with its parameters, the best first."""

from dataclasses import replace

import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.core.protocols import RuleContext
from ictamp_drake.estimators.constant import Constant
from ictamp_drake.planning.result import StopReason
from ictamp_drake.planning.stap import StapConfig
from ictamp_drake.planning.tree import ROOT, Opening
from tests.refusals import refusal
from tests.toy_world import RIGHT, UP, ToyOptimizer, ToyWorld, assert_consistent, toy_planner

WORLD = ToyWorld(size=(2, 1))


def test_all_plans_are_opened_before_the_best_is_executed_with_its_parameters() -> None:
    world = replace(WORLD, doors={(0, 1): 0.6, (1, 1): 0.01, (2, 1): 0.01})
    result = toy_planner(world, rule=StapConfig(), estimator=ToyOptimizer(world)).run()
    assert [isinstance(entry, Opening) for entry in result.tree.log] == [True] * 3 + [False] * 3
    assert result.actions == (UP, RIGHT, RIGHT)  # the one that the optimizer likes best
    offsets = [attempt.k[0] for attempt in result.plan or () if attempt.k is not None]
    assert len(offsets) == 3
    assert max(offsets[:2]) < 0.01


def test_after_a_failure_the_next_best_is_executed_from_the_start() -> None:
    world = replace(WORLD, walls=((0, 1),))
    result = toy_planner(world, rule=StapConfig(), estimator=ToyOptimizer(world)).run()
    assert result.solved
    steps = [(step.node, step.attempt.action, step.attempt.succeeded) for step in result.tree.steps]
    assert steps[:2] == [(ROOT, UP, False), (ROOT, RIGHT, True)]
    assert result.actions == (RIGHT, UP, RIGHT)


def test_when_all_have_failed_all_are_optimized_anew() -> None:
    world = replace(WORLD, walls=((2, 1),))
    optimizer = ToyOptimizer(world)
    result = toy_planner(world, rule=StapConfig(), estimator=optimizer, steps=20).run()
    assert result.stop_reason is StopReason.OUT_OF_STEPS
    assert len(optimizer.asked) > 1
    assert set(optimizer.asked) == {3}
    assert_consistent(result.tree)


def test_a_plan_that_is_refused_as_a_whole_is_followed_by_the_next_best() -> None:
    answers = iter([False, True])
    optimizer = ToyOptimizer(WORLD)
    result = toy_planner(WORLD, rule=StapConfig(), estimator=optimizer, verify=lambda _: next(answers)).run()
    assert result.actions == (RIGHT, UP, RIGHT)


@pytest.mark.parametrize("plans", [1, 2])
def test_no_more_plans_are_opened_than_told(plans: int) -> None:
    result = toy_planner(WORLD, rule=StapConfig(plans=plans), estimator=ToyOptimizer(WORLD)).run()
    assert result.high_level_plans == plans


def test_a_start_at_the_goal_that_is_not_verified_leaves_nothing_to_do() -> None:
    world = ToyWorld(size=(0, 0))
    result = toy_planner(world, rule=StapConfig(), estimator=ToyOptimizer(world), verify=lambda _: False).run()
    assert result.stop_reason is StopReason.UNREACHABLE


def test_an_estimator_that_does_not_optimize_plans_is_refused() -> None:
    with pytest.raises(TypeError, match="Constant does not optimize plans"):
        StapConfig().create(RuleContext(Constant(1.0)))


@pytest.mark.parametrize(("name", "least"), [("extra", 0), ("plans", 1), ("draws", 1), ("iterations", 0)])
def test_a_constant_that_is_too_small_is_refused_by_name(name: str, least: int) -> None:
    with refusal(Code.OUT_OF_RANGE, f"planners.stap.{name}", value=least - 1):
        StapConfig(**{name: least - 1})
