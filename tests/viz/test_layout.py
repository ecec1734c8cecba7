"""The layout of a search's picture has no overlaps."""

import math
from collections import defaultdict
from itertools import combinations
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.viz.layout import PLAN_COLORS, Layout, abbreviations, rows


@st.composite
def trees(draw: st.DrawFn) -> tuple[list[int | None], int]:
    """Parents of nodes, then of stubs, and the number of nodes."""
    nodes = draw(st.integers(1, 60))
    stubs = draw(st.lists(st.integers(0, nodes - 1), max_size=60))
    return [None, *(draw(st.integers(0, node - 1)) for node in range(1, nodes)), *stubs], nodes


@given(trees())
def test_no_two_items_share_a_place_and_no_line_meets_a_branch(tree: tuple[list[int | None], int]) -> None:
    parents, nodes = tree
    levels = rows(parents, nodes)
    depths = [0]
    children: defaultdict[int, list[int]] = defaultdict(list)
    for item, parent in enumerate(parents[1:], start=1):
        assert parent is not None
        depths.append(depths[parent] + 1)
        children[parent].append(item)
    assert len(set(zip(depths, levels, strict=True))) == len(parents)
    for item in range(nodes):
        assert not children[item] or min(levels[child] for child in children[item]) == levels[item]
        bottom = max((levels[child] for child in children[item]), default=levels[item])
        for other in range(nodes):
            if other != item and depths[other] == depths[item]:
                assert not levels[item] <= levels[other] <= bottom


def test_preferred_items_are_level_with_their_parent() -> None:
    assert rows([None, 0, 0, 2, 2], nodes=5, preferred=frozenset({2, 4})) == [0, 2, 0, 1, 0]


def test_stubs_are_next_to_the_first_child() -> None:
    assert rows([None, 0, 0, 0], nodes=3) == [0, 0, 2, 1]


@pytest.mark.parametrize(
    ("actions", "labels"),
    [
        (["pick(red_box, rack)", "place(red_box, table)"], ["pick red rack", "place red table"]),
        (["pick(box_1, box_2)"], ["pick box_1 box_2"]),
        (["up()"], ["up"]),
    ],
    ids=["heads suffice", "heads alike", "no objects"],
)
def test_abbreviations_stay_distinct(actions: list[str], labels: list[str]) -> None:
    assert abbreviations(actions) == dict(zip(actions, labels, strict=True))


def test_plans_can_be_told_apart_by_their_colors() -> None:
    for one, other in combinations(PLAN_COLORS, 2):
        assert math.dist(one, other) > 0.1


def test_every_item_says_when_it_came(door: dict[str, Any]) -> None:
    layout = Layout(door)
    for node, born in zip(layout.nodes[1:], layout.born[1:], strict=True):
        assert door["log"][born - 1]["child"] == node["index"]
    for stub in layout.stubs:
        first = door["log"][stub.born - 1]
        assert (first["node"], first["action"]) == (stub.node, stub.action)
        assert first["failure"] is not None
    assert sum(stub.causes.total() for stub in layout.stubs) == door["summary"]["low_level_failures"]


def test_the_solution_is_the_way_to_the_verified_node(door: dict[str, Any]) -> None:
    layout = Layout(door)
    assert {0, door["solution"]} <= layout.solution
    assert sorted(layout.nodes[node]["depth"] for node in layout.solution) == list(range(len(layout.solution)))
