"""Uniform allocation: all options are equally likely."""

from collections import Counter

import numpy as np
from scipy.stats import chisquare

from ictamp_drake.core.protocols import RuleContext
from ictamp_drake.core.types import Attempt
from ictamp_drake.estimators.constant import Constant
from ictamp_drake.planning.rule import OpenPlan, Option
from ictamp_drake.planning.tree import ROOT, RunStep, Tree
from ictamp_drake.planning.uniform import UniformAllocation, UniformAllocationConfig
from tests.toy_world import RIGHT, ToyConfiguration, ToyWorld, abstraction

WORLD = ToyWorld(size=(1, 1))


def grown_tree() -> Tree[ToyConfiguration]:
    tree = Tree(WORLD.start, abstraction(WORLD.start))
    for plan in WORLD.plans():
        tree.record_opening(plan, 1)
    for offset in (0.1, 0.2):
        tree.record_step(ROOT, 0, Attempt(RIGHT, None, ToyConfiguration((1, 0), offset)))
    return tree


def counts(tree: Tree[ToyConfiguration]) -> Counter[Option]:
    rule: UniformAllocation[ToyConfiguration] = UniformAllocationConfig().create(RuleContext(Constant(1.0)))
    rng = np.random.default_rng(2)
    return Counter(rule.choose(tree, rng) for _ in range(10_000))


def test_opening_and_every_step_of_every_node_are_equally_likely() -> None:
    found = counts(grown_tree())
    assert set(found) == {OpenPlan(), RunStep(ROOT, 0), RunStep(ROOT, 1), RunStep(1, 2), RunStep(2, 2)}
    assert chisquare(list(found.values())).pvalue > 0.01


def test_opening_is_no_option_once_the_generator_is_exhausted() -> None:
    tree = grown_tree()
    tree.exhausted = True
    assert OpenPlan() not in counts(tree)
