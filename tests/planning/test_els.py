"""Effort level search: levels computed by hand, and effects of its constants."""

import numpy as np
import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.core.failures import Failure
from ictamp_drake.core.protocols import RuleContext
from ictamp_drake.core.types import Attempt
from ictamp_drake.estimators.constant import Constant
from ictamp_drake.planning.els import Els, ElsConfig
from ictamp_drake.planning.rule import OpenPlan, Option
from ictamp_drake.planning.tree import ROOT, RunStep, Tree
from tests.refusals import refusal
from tests.toy_world import RIGHT, UP, TableEstimator, ToyConfiguration, ToyWorld, abstraction, toy_planner

WORLD = ToyWorld(size=(1, 1))
RIGHT_UP, UP_RIGHT = WORLD.plans()


class Search:
    """A tree that grows by hand, and the rule that reads it."""

    def __init__(self, config: ElsConfig, estimator: TableEstimator | None = None) -> None:
        self.tree = Tree(WORLD.start, abstraction(WORLD.start))
        self.rule: Els[ToyConfiguration] = config.create(RuleContext(estimator or Constant(1.0)))

    def next(self) -> Option:
        return self.rule.choose(self.tree, np.random.default_rng(0))

    def opens(self, seconds: float = 0.0, came: bool = True) -> None:
        assert self.next() == OpenPlan()
        plan = (RIGHT_UP, UP_RIGHT)[len(self.tree.opened)] if came else None
        self.tree.record_opening(plan, 1, seconds)

    def runs(self, node: int, plan: int, seconds: float, success: bool = False) -> None:
        assert self.next() == RunStep(node, plan)
        action = self.tree.plans[plan].actions[0]
        successor = ToyConfiguration((1, 0) if action == RIGHT else (0, 1), 0.1)
        failure = None if success else Failure.SLIPPED
        self.tree.record_step(node, plan, Attempt(action, failure, successor, seconds={"physics": seconds}))


def test_the_node_of_the_least_level_is_served() -> None:
    search = Search(ElsConfig(p_w=1.0, p_c=1.0, eps=0.0))
    search.opens(seconds=0.5)  # plan 0, level 0; its attempts begin at 0.5
    search.runs(ROOT, 0, seconds=0.2)  # attempt 0 at 0.5, before plan 1 at 1
    search.opens(seconds=0.25)  # plan 1 at 1; its attempts begin at 1.25
    search.runs(ROOT, 1, seconds=0.4, success=True)  # attempt 0 of plan 1 at 1.25, before attempt 1 of plan 0 at 1.5
    search.runs(ROOT, 0, seconds=0.2)  # at 1.5, before the result of plan 1 at 1.25 + 0.4
    search.runs(1, 2, seconds=0.1)  # the rest of plan 1, at 1.65


def test_a_node_that_is_not_complete_waits_with_its_effort() -> None:
    search = Search(ElsConfig(eps=0.0))
    search.opens(seconds=0.75, came=False)  # goes on at 0.75, before its sibling at 1
    search.opens(seconds=0.5)  # the plan has arrived; its attempts begin at 1.25
    search.opens(seconds=0.0)  # plan 1 at 1
    search.runs(ROOT, 1, seconds=0.1)


def test_exponents_weigh_siblings_and_effort() -> None:
    search = Search(ElsConfig(p_w=3.0, p_c=2.0, w0=2.0, c0=4.0, eps=0.0))
    search.opens(seconds=2.0)  # attempts begin at (2 / 4)^2 = 0.25, plan 1 waits at (1 / 2)^3 = 0.125
    search.opens(seconds=0.0)  # its attempts begin at 0.125
    search.runs(ROOT, 1, seconds=0.1)
    search.runs(ROOT, 0, seconds=0.1)  # attempt 1 of either waits 0.125 above attempt 0
    search.runs(ROOT, 1, seconds=0.1)
    search.runs(ROOT, 0, seconds=0.1)


def test_weighted_by_an_estimator_the_likelier_plan_comes_first() -> None:
    estimator = TableEstimator({RIGHT: 0.25, UP: 0.5})
    search = Search(ElsConfig(weighted=True, w0=4.0, eps=0.0), estimator)
    search.opens()  # its first attempt counts as number 1 / 0.25 - 1 = 3, at 3 / 4
    search.opens()  # plan 1 at 1 / 4; its first attempt counts as number 1, at 1 / 2
    search.tree.exhausted = True
    search.runs(ROOT, 1, seconds=0.1)
    search.runs(ROOT, 0, seconds=0.1)
    assert [len(call) for call in estimator.asked] == [1, 1]


def test_without_weights_no_estimator_is_asked() -> None:
    estimator = TableEstimator({})
    assert toy_planner(ToyWorld(size=(2, 1), success=0.5), estimator=estimator, rule=ElsConfig()).run().solved
    assert not estimator.asked


@pytest.mark.parametrize(("name", "value"), [("p_w", -1.0), ("p_c", float("nan")), ("eps", -1e-9)])
def test_a_negative_constant_is_refused_by_name(name: str, value: float) -> None:
    with refusal(Code.OUT_OF_RANGE, f"planners.els.{name.replace('_', '-')}", value=value):
        ElsConfig(**{name: value})  # type: ignore[arg-type]


def test_a_floor_that_is_no_probability_is_refused() -> None:
    with refusal(Code.OUT_OF_RANGE, "planners.els.floor", value=2.0):
        ElsConfig(floor=2.0)


@pytest.mark.parametrize("name", ["w0", "c0", "floor"])
def test_a_scale_of_zero_is_refused_by_name(name: str) -> None:
    with refusal(Code.OUT_OF_RANGE, f"planners.els.{name}", value=0.0):
        ElsConfig(**{name: 0.0})  # type: ignore[arg-type]


@pytest.mark.parametrize(
    "config", [ElsConfig(p_w=1e308), ElsConfig(p_c=1e308), ElsConfig(p_w=1e308, p_c=1e308, w0=1e-300)]
)
def test_powers_that_are_too_large_come_last(config: ElsConfig) -> None:
    search = Search(config)
    for seconds in (3.0, 2.0, 2.0):
        option = search.next()
        if option == OpenPlan():
            search.tree.record_opening((RIGHT_UP, UP_RIGHT)[len(search.tree.opened) % 2], 1, seconds)
        else:
            assert isinstance(option, RunStep)
            action = search.tree.plans[option.plan].actions[0]
            attempt = Attempt(action, Failure.SLIPPED, None, seconds={"physics": seconds})
            search.tree.record_step(option.node, option.plan, attempt)
