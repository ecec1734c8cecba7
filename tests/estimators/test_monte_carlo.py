"""Counted success in the toy world."""

import numpy as np
import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.core.types import FloatArray, Skeleton
from ictamp_drake.estimators.context import EstimatorContext
from ictamp_drake.estimators.monte_carlo import MonteCarloConfig
from tests.refusals import refusal
from tests.toy_world import ToyGenerator, ToyWorld, abstraction, toy_planner


def estimates(success: float, executions: int = 400) -> FloatArray:
    world = ToyWorld(size=(2, 2), success=success)
    plan = ToyGenerator(world).next_plan(1000)
    assert isinstance(plan, Skeleton)
    assert abstraction(world.start) == plan.states[0]
    estimator = MonteCarloConfig(executions).create(EstimatorContext(None, world))  # type: ignore[arg-type]
    return estimator.estimate([(world.start, plan), (world.start, plan)])  # type: ignore[list-item]


@pytest.mark.parametrize("success", [0.0, 0.3, 1.0])
def test_the_share_of_successes_is_the_probability(success: float) -> None:
    P = estimates(success)
    assert P.shape == (2,)
    np.testing.assert_allclose(P, success, atol=0.08)


def test_an_option_is_counted_once() -> None:
    P = estimates(0.5, executions=5)
    assert P[0] == P[1]


def test_it_takes_part_in_a_search() -> None:
    world = ToyWorld(size=(3, 3), success=0.5)
    estimator = MonteCarloConfig(10).create(EstimatorContext(None, world))  # type: ignore[arg-type]
    assert toy_planner(world, estimator=estimator).run().solved  # type: ignore[arg-type]


def test_no_executions_are_refused() -> None:
    with refusal(Code.OUT_OF_RANGE, "estimators.monte-carlo.executions", value=0):
        MonteCarloConfig(executions=0)
