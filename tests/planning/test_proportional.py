"""The paper's rule: its draws, their proportions, and its queries to the estimator."""

from collections import Counter, defaultdict
from dataclasses import replace

import numpy as np
import pytest
from scipy.stats import chisquare

from ictamp_drake.core.errors import Code
from ictamp_drake.core.failures import Failure
from ictamp_drake.core.protocols import RuleContext
from ictamp_drake.core.types import Attempt
from ictamp_drake.estimators.constant import Constant
from ictamp_drake.planning.proportional import Proportional, ProportionalConfig
from ictamp_drake.planning.rule import OpenPlan, Option
from ictamp_drake.planning.tree import ROOT, RunStep, Tree
from tests.refusals import refusal
from tests.toy_world import RIGHT, UP, TableEstimator, ToyConfiguration, ToyWorld, abstraction, toy_planner

WORLD = ToyWorld(size=(1, 1))
RIGHT_UP, UP_RIGHT = WORLD.plans()
DRAWS = 20_000


def grown_tree() -> Tree[ToyConfiguration]:
    """Two plans at the root; three nodes hold the rest of the first, with 0, 1 and 3 attempts."""
    tree = Tree(WORLD.start, abstraction(WORLD.start))
    tree.record_opening(RIGHT_UP, 10)
    tree.record_opening(UP_RIGHT, 4)
    for offset in (0.1, 0.2, 0.3):
        tree.record_step(ROOT, 0, Attempt(RIGHT, None, ToyConfiguration((1, 0), offset)))
    for node, attempts in ((2, 1), (3, 3)):
        for _ in range(attempts):
            tree.record_step(node, 2, Attempt(UP, Failure.SLIPPED))
    return tree


def frequencies(tree: Tree[ToyConfiguration], rule: Proportional[ToyConfiguration]) -> Counter[Option]:
    rng = np.random.default_rng(11)
    return Counter(rule.choose(tree, rng) for _ in range(DRAWS))


def assert_in_proportion(counts: Counter[Option], weights: dict[Option, float]) -> None:
    assert set(counts) == set(weights)
    expected = np.array(list(weights.values()))
    assert chisquare([counts[option] for option in weights], DRAWS * expected / expected.sum()).pvalue > 0.01


def expected_weights() -> dict[Option, float]:
    """Weights by hand from the paper: plan 2 first draws a node with 1 : 1/2 : 1/4, and is then scored by it."""
    nodes = {1: 1, 2: 1 / 2, 3: 1 / 4}
    chance = {node: weight / sum(nodes.values()) for node, weight in nodes.items()}
    fixed: dict[Option, float] = {OpenPlan(): 2.0 / 4, RunStep(0, 0): 0.6 / 4, RunStep(0, 1): 0.1}
    weights: defaultdict[Option, float] = defaultdict(float)
    for node, drawn in chance.items():
        score = 0.1 * nodes[node]
        total = sum(fixed.values()) + score
        weights[RunStep(node, 2)] += drawn * score / total
        for option, weight in fixed.items():
            weights[option] += drawn * weight / total
    return weights


def test_options_are_drawn_in_proportion_to_the_papers_scores() -> None:
    estimator = TableEstimator({RIGHT: 0.6, UP: 0.05})
    counts = frequencies(grown_tree(), ProportionalConfig(W=2.0, floor=0.1).create(RuleContext(estimator)))
    assert_in_proportion(counts, expected_weights())


def test_opening_is_no_option_once_the_generator_is_exhausted() -> None:
    tree = grown_tree()
    tree.exhausted = True
    counts = frequencies(tree, ProportionalConfig(W=1e6).create(RuleContext(Constant(1.0))))
    assert OpenPlan() not in counts


def test_without_plans_the_only_option_is_to_open_one_even_when_it_weighs_nothing() -> None:
    tree = Tree(WORLD.start, abstraction(WORLD.start))
    counts = frequencies(tree, ProportionalConfig(W=0.0).create(RuleContext(Constant(1.0))))
    assert set(counts) == {OpenPlan()}


def test_a_rollout_draws_its_next_configuration_among_the_nodes_that_hold_the_rest() -> None:
    tree = grown_tree()
    tree.record_step(ROOT, 0, Attempt(RIGHT, None, ToyConfiguration((1, 0), 0.4)))
    counts = frequencies(tree, ProportionalConfig().create(RuleContext(Constant(1.0))))
    newest = len(tree.nodes) - 1
    weights: dict[Option, float] = {
        RunStep(1, 2): 1,
        RunStep(2, 2): 1 / 2,
        RunStep(3, 2): 1 / 4,
        RunStep(newest, 2): 1,
    }
    assert_in_proportion(counts, weights)


def test_a_rollout_without_redrawing_goes_on_from_where_it_is() -> None:
    tree = grown_tree()
    tree.record_step(ROOT, 0, Attempt(RIGHT, None, ToyConfiguration((1, 0), 0.4)))
    counts = frequencies(tree, ProportionalConfig(redraw=False).create(RuleContext(Constant(1.0))))
    assert set(counts) == {RunStep(len(tree.nodes) - 1, 2)}


def test_each_step_is_estimated_once_and_all_new_ones_in_one_call() -> None:
    estimator = TableEstimator({RIGHT: 0.5, UP: 0.5})
    toy_planner(ToyWorld(size=(2, 2), success=0.5), estimator=estimator, rule=ProportionalConfig(W=50.0)).run()
    asked = [option for call in estimator.asked for option in call]
    assert len(asked) == len(set(asked))
    assert max(len(call) for call in estimator.asked) > 1
    assert all(estimator.asked)


@pytest.mark.parametrize("name", ["W", "floor"])
@pytest.mark.parametrize("value", [-1.0, float("nan")])
def test_a_negative_constant_is_refused_by_name(name: str, value: float) -> None:
    with refusal(Code.OUT_OF_RANGE, f"planners.completion-tree.{name}", value=value):
        replace(ProportionalConfig(), **{name: value})  # type: ignore[arg-type]
