"""The picture of a search: complete, and the same every time."""

from pathlib import Path
from typing import Any

import matplotlib.image
import pytest

from ictamp_drake.planning.proportional import ProportionalConfig
from ictamp_drake.viz.tree import draw_tree
from tests.toy_world import ToyWorld, toy_planner


def test_the_picture_holds_every_node_failure_and_plan(door: dict[str, Any], tmp_path: Path) -> None:
    draw_tree(door, tmp_path / "tree.svg", title="Door")
    svg = (tmp_path / "tree.svg").read_text()
    steps, failed, nodes = (door["summary"][key] for key in ("low_level_steps", "low_level_failures", "nodes"))
    tries = door["nodes"][0]["cnt"][0]
    for text in [str(node["index"]) for node in door["nodes"]] + [
        f"Door · solved · plans opened: 1 · steps: {steps} · failed: {failed} · nodes: {nodes}",
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


def test_a_plan_takes_the_expansions_of_all_calls_since_the_one_before(tmp_path: Path) -> None:
    world = ToyWorld(size=(1, 1), walls=((1, 0),), expansions=25)
    record = toy_planner(world, max_expansions=10).run().tree.to_dict()
    draw_tree(record, tmp_path / "tree.svg")
    svg = (tmp_path / "tree.svg").read_text()
    assert [entry["expanded"] for entry in record["log"] if entry["event"] == "opening"] == [10, 10, 5] * 2
    assert svg.count(": 25 expanded") == 2


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


def test_a_cause_of_another_version_is_drawn_too(door: dict[str, Any], tmp_path: Path) -> None:
    log = [entry | {"failure": "MELTED"} if entry.get("failure") else entry for entry in door["log"]]
    draw_tree({**door, "log": log}, tmp_path / "tree.svg")
    assert "MELTED" in (tmp_path / "tree.svg").read_text()
