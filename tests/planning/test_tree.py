"""The tree records what happened and makes no decisions."""

import json

import pytest

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Attempt, Skeleton
from ictamp_drake.planning.tree import ROOT, Opening, Step, Tree
from tests.toy_world import ToyConfiguration, ToyWorld, abstraction, encode

WORLD = ToyWorld(size=(1, 1))
RIGHT_UP, UP_RIGHT = WORLD.plans()


@pytest.fixture
def tree() -> Tree[ToyConfiguration]:
    return Tree(WORLD.start, abstraction(WORLD.start))


def success(plan: Skeleton, cell: tuple[int, int], offset: float = 0.25) -> Attempt[ToyConfiguration]:
    return Attempt(plan.actions[0], None, ToyConfiguration(cell, offset))


def test_an_opened_plan_is_held_by_the_root_with_count_zero(tree: Tree[ToyConfiguration]) -> None:
    assert tree.record_opening(RIGHT_UP, 12) == Opening(plan=0, expanded=12)
    assert tree.record_opening(None, 1000) == Opening(plan=None, expanded=1000)
    assert tree.root.cnt == {0: 0}
    assert tree.holders == [[ROOT]]


def test_a_success_is_a_node_with_the_rest_of_the_plan(tree: Tree[ToyConfiguration]) -> None:
    tree.record_opening(RIGHT_UP, 12)
    step = tree.record_step(ROOT, 0, success(RIGHT_UP, (1, 0)))
    assert step.child == 1
    assert tree.nodes[1].s == RIGHT_UP.states[1]
    assert tree.nodes[1].cnt == {1: 0}
    assert tree.plans[1] == RIGHT_UP.suffix(1)
    assert tree.root.cnt == {0: 1}


def test_a_failure_only_counts(tree: Tree[ToyConfiguration]) -> None:
    tree.record_opening(RIGHT_UP, 12)
    step = tree.record_step(ROOT, 0, Attempt(RIGHT_UP.actions[0], Failure.SLIPPED, WORLD.start))
    assert step.child is None
    assert len(tree.nodes) == 1
    assert tree.root.cnt == {0: 1}


def test_nodes_share_one_plan_when_they_hold_the_same(tree: Tree[ToyConfiguration]) -> None:
    tree.record_opening(RIGHT_UP, 12)
    for offset in (0.1, 0.2):
        tree.record_step(ROOT, 0, success(RIGHT_UP, (1, 0), offset))
    assert tree.holders[1] == [1, 2]
    assert tree.open_plans == [0, 1]


def test_a_plan_opened_twice_keeps_its_count(tree: Tree[ToyConfiguration]) -> None:
    tree.record_opening(RIGHT_UP, 12)
    tree.record_step(ROOT, 0, Attempt(RIGHT_UP.actions[0], Failure.SLIPPED))
    tree.record_opening(RIGHT_UP, 1)
    assert tree.root.cnt == {0: 1}
    assert tree.holders == [[ROOT]]


def test_the_empty_plan_marks_the_goal_and_is_not_open(tree: Tree[ToyConfiguration]) -> None:
    tree.record_opening(RIGHT_UP, 12)
    tree.record_step(ROOT, 0, success(RIGHT_UP, (1, 0)))
    tree.record_step(1, 1, success(RIGHT_UP.suffix(1), (1, 1)))
    assert [tree.is_finished(node) for node in tree.nodes] == [False, False, True]
    assert tree.open_plans == [0, 1]
    assert [attempt.action for attempt in tree.path(2)] == list(RIGHT_UP.actions)
    assert tree.path(ROOT) == ()
    assert tree.lineage(2) == (ROOT, 1, 2)
    assert tree.lineage(ROOT) == (ROOT,)


def test_a_grafted_plan_goes_on_from_where_its_first_actions_led() -> None:
    world = ToyWorld(size=(2, 1))
    _, right_up_right, up_first = world.plans()
    tree = Tree(world.start, abstraction(world.start))
    right_twice = next(world.plans())
    tree.record_opening(right_twice, 1)
    tree.record_step(ROOT, 0, success(right_twice, (1, 0)))
    tree.record_step(1, 1, success(right_twice.suffix(1), (2, 0)))
    tree.record_opening(up_first, 1, graft=True)
    assert [len(node.cnt) for node in tree.nodes] == [2, 1, 1]
    tree.record_opening(right_up_right, 1, graft=True)
    assert [len(node.cnt) for node in tree.nodes] == [3, 2, 1]
    (grafted,) = tree.nodes[1].cnt.keys() - {1}
    assert tree.plans[grafted] == right_up_right.suffix(1)
    assert tree.holders[grafted] == [1]


def test_a_finished_node_is_given_nothing_more(tree: Tree[ToyConfiguration]) -> None:
    tree.record_opening(RIGHT_UP, 1)
    tree.record_step(ROOT, 0, success(RIGHT_UP, (1, 0)))
    tree.record_step(1, 1, success(RIGHT_UP.suffix(1), (1, 1)))
    tree.record_opening(RIGHT_UP, 1, graft=True)
    assert [len(node.cnt) for node in tree.nodes] == [1, 1, 1]


def test_a_plan_from_elsewhere_is_refused(tree: Tree[ToyConfiguration]) -> None:
    with pytest.raises(ValueError, match="state of the root"):
        tree.record_opening(RIGHT_UP.suffix(1), 1)


def test_a_success_without_successor_is_refused_and_not_counted(tree: Tree[ToyConfiguration]) -> None:
    tree.record_opening(RIGHT_UP, 12)
    with pytest.raises(ValueError, match="without a successor"):
        tree.record_step(ROOT, 0, Attempt(RIGHT_UP.actions[0], None))
    assert tree.root.cnt == {0: 0}


def test_log_summary_and_dictionary_tell_the_same_story(tree: Tree[ToyConfiguration]) -> None:
    tree.record_opening(None, 1000)
    tree.record_opening(UP_RIGHT, 12)
    tree.record_step(ROOT, 0, Attempt(UP_RIGHT.actions[0], Failure.NO_PATH, rejections=(Failure.GOAL_IN_COLLISION,)))
    tree.record_step(ROOT, 0, success(UP_RIGHT, (0, 1)))
    tree.record_step(1, 1, success(UP_RIGHT.suffix(1), (1, 1)))
    tree.candidates[2] = True
    assert [type(entry) for entry in tree.log] == [Opening, Opening, Step, Step, Step]
    assert tree.summary() == {
        "nodes": 3,
        "depth": 2,
        "high_level_plans": 1,
        "high_level_calls": 2,
        "high_level_expansions": 1012,
        "low_level_steps": 3,
        "low_level_failures": 1,
        "candidates": 1,
    }
    record = json.loads(json.dumps(tree.to_dict(encode)))
    assert record == tree.to_dict(encode)
    assert record["solution"] == 2
    assert record["plans"] == [["up()", "right()"], ["right()"], []]
    assert record["nodes"][1] == {
        "index": 1,
        "parent": 0,
        "depth": 1,
        "action": "up()",
        "state": ["at(0, 1)"],
        "plans": [1],
        "cnt": [1],
        "c": [0, 1, 0.25],
    }
    assert record["log"][2] == {
        "event": "step",
        "node": 0,
        "plan": 0,
        "action": "up()",
        "k": None,
        "failure": "NO_PATH",
        "rejections": ["GOAL_IN_COLLISION"],
        "child": None,
    }
    assert "c" not in tree.to_dict()["nodes"][0]
