"""Round robin: every plan gets its turn."""

import numpy as np

from ictamp_drake.planning.round_robin import RoundRobinConfig
from ictamp_drake.planning.tree import Opening, Tree
from tests.toy_world import ToyConfiguration, ToyWorld, toy_planner

STUCK = ToyWorld(size=(1, 2), success=0.4, walls=((1, 2),))


def rounds(tree: Tree[ToyConfiguration]) -> list[list[int]]:
    """Plans that were run between two openings."""
    found: list[list[int]] = [[]]
    for entry in tree.log:
        if isinstance(entry, Opening):
            found.append([])
        else:
            found[-1].append(entry.plan)
    return found


def test_a_round_runs_every_plan_once_and_those_nearest_to_the_goal_first() -> None:
    tree = toy_planner(STUCK, steps=60, rule=RoundRobinConfig()).run().tree
    before_first, *between, _ = rounds(tree)
    assert before_first == []
    assert between
    for plans in between:
        assert len(plans) == len(set(plans))
        lengths = [len(tree.plans[plan]) for plan in plans]
        assert lengths == sorted(lengths)


def test_without_further_plans_the_rounds_go_on() -> None:
    tree = toy_planner(STUCK, steps=90, rule=RoundRobinConfig()).run().tree
    assert tree.exhausted
    served = np.bincount([step.plan for step in tree.steps[-30:]], minlength=len(tree.plans))
    shares = [served[plan] for plan in tree.open_plans]
    assert max(shares) - min(shares) <= 1
