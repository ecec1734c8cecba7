"""The picture of a search: laid out without overlaps, complete, and the same every time."""

import json
from collections import defaultdict
from pathlib import Path
from typing import Any

import matplotlib.image
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.planning.proportional import ProportionalConfig
from ictamp_drake.viz.tree import abbreviations, draw_tree, rows
from tests.toy_world import ToyWorld, toy_planner

GOLDEN = Path(__file__).parents[1] / "golden"


@pytest.fixture
def door() -> dict[str, Any]:
    """The record of a search in which nothing but a narrow door makes steps fail, read from its file."""
    record: dict[str, Any] = json.loads((GOLDEN / "door.json").read_text())["tree"]
    return record


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


def test_the_picture_holds_every_node_failure_and_plan(door: dict[str, Any], tmp_path: Path) -> None:
    draw_tree(door, tmp_path / "tree.svg", title="Door")
    svg = (tmp_path / "tree.svg").read_text()
    steps, failed, nodes = (door["summary"][key] for key in ("low_level_steps", "low_level_failures", "nodes"))
    tries = door["nodes"][0]["cnt"][0]
    for text in [str(node["index"]) for node in door["nodes"]] + [
        f"Door   solved   plans opened: 1   steps: {steps}   failed: {failed}   nodes: {nodes}",
        f"plan 0, after step 0: 10 expanded, tried {tries}×",
        f"grasp or placement in collision ({failed})",
    ]:
        assert f">{text}</text>" in svg
    stubs = {(step["node"], step["action"]) for step in door["log"] if step.get("failure")}
    assert svg.count("× up</text>") == len(stubs)


def test_the_same_record_gives_the_same_file(door: dict[str, Any], tmp_path: Path) -> None:
    for name in ("one.svg", "two.svg"):
        draw_tree(door, tmp_path / name)
    assert (tmp_path / "one.svg").read_bytes() == (tmp_path / "two.svg").read_bytes()


@pytest.mark.parametrize("max_plans", [0, 1])
def test_a_search_without_any_step_is_drawn_too(max_plans: int, tmp_path: Path) -> None:
    record = toy_planner(ToyWorld(max_plans=max_plans), steps=0).run().tree.to_dict()
    draw_tree(record, tmp_path / "tree.png")
    assert matplotlib.image.imread(tmp_path / "tree.png").min() < 0.5


def test_a_large_tree_with_refused_plans_and_many_openings_is_drawn(tmp_path: Path) -> None:
    world = ToyWorld(size=(4, 4), success=0.85)
    result = toy_planner(world, steps=250, rule=ProportionalConfig(W=30.0), verify=lambda _: False).run()
    draw_tree(result.tree.to_dict(), tmp_path / "tree.svg")
    svg = (tmp_path / "tree.svg").read_text()
    assert "not solved" in svg
    assert f"and {result.high_level_plans - 12} more plans" in svg
