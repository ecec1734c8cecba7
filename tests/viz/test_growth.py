"""The picture of a search over time."""

import re
from pathlib import Path
from typing import Any

from ictamp_drake.viz.growth import draw_growth
from ictamp_drake.viz.layout import FOUND
from tests.toy_world import ToyWorld, toy_planner


def texts(path: Path) -> list[str]:
    return re.findall(r">([^<>]+)</text>", path.read_text())


def test_the_last_picture_holds_every_node_and_the_others_what_was_there(door: dict[str, Any], tmp_path: Path) -> None:
    draw_growth(door, tmp_path / "growth.svg", moments=3)
    shown = texts(tmp_path / "growth.svg")
    assert [text for text in shown if "step" in text] == ["7 steps, 1 plan", "15 steps, 1 plan", "23 steps, 1 plan"]
    for node in door["nodes"]:
        born = 0 if node["parent"] is None else [entry.get("child") for entry in door["log"]].index(node["index"]) + 1
        assert shown.count(str(node["index"])) == sum(born <= end for end in (8, 16, 24))


def test_calls_without_a_plan_have_no_picture(tmp_path: Path) -> None:
    record = toy_planner(ToyWorld(size=(1, 1), expansions=90, max_plans=1), max_expansions=10).run().tree.to_dict()
    draw_growth(record, tmp_path / "growth.svg", moments=3)
    shown = [text for text in texts(tmp_path / "growth.svg") if "step" in text]
    assert shown == ["0 steps, 1 plan", "1 step, 1 plan", "2 steps, 1 plan"]


def test_only_the_last_picture_tells_the_way_to_the_goal(door: dict[str, Any], tmp_path: Path) -> None:
    draw_growth(door, tmp_path / "all.svg", moments=1)
    assert FOUND in (tmp_path / "all.svg").read_text()
    unsolved = door | {"solution": None}
    draw_growth(unsolved, tmp_path / "unsolved.svg", moments=1)
    assert FOUND not in (tmp_path / "unsolved.svg").read_text()


def test_the_same_record_gives_the_same_file(door: dict[str, Any], tmp_path: Path) -> None:
    for name in ("one.svg", "two.svg"):
        draw_growth(door, tmp_path / name)
    assert (tmp_path / "one.svg").read_bytes() == (tmp_path / "two.svg").read_bytes()


def test_a_search_without_any_step_is_drawn_too(tmp_path: Path) -> None:
    record = toy_planner(ToyWorld(max_plans=0), steps=0).run().tree.to_dict()
    draw_growth(record, tmp_path / "growth.svg")
    assert texts(tmp_path / "growth.svg") == ["0 steps, 0 plans", "0"]
