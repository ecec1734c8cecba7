"""Wide scenes are scenes to start in; the table counts executions and goes on where it stopped."""

from collections.abc import Iterator, Mapping
from pathlib import Path
from typing import Any

import pytest

from benchmarks import robustness
from benchmarks.robustness import CHANGES, SIDES, WIDE, Options, find_scenes, make_wide_scene, write_table
from ictamp_drake.tamp.changes import Changes
from ictamp_drake.tamp.method import Method
from ictamp_drake.tamp.task import load


def test_wide_boxes_are_wide_and_the_same_every_time() -> None:
    for number in range(5):
        spec = make_wide_scene(number)
        assert spec == make_wide_scene(number)
        assert all(SIDES[0] <= side <= SIDES[1] for box in spec.boxes.values() for side in box.size[:2])
    assert make_wide_scene(0) != make_wide_scene(1)


def test_planning_can_begin_in_a_wide_scene() -> None:
    task = load(make_wide_scene(0), Method())
    assert not task.goal.holds(task.s)


def test_the_sets_take_turns_and_have_at_least_twenty_plans() -> None:
    scenes = list(find_scenes(Options()))
    groups = [group for group, _, _ in scenes]
    assert groups[:10] == ["easy", WIDE, "medium", WIDE, "hard", WIDE, "varied", WIDE, "easy", WIDE]
    assert groups.count(WIDE) >= 20
    assert len(groups) - groups.count(WIDE) >= 20
    assert len({name for _, name, _ in scenes}) == len(scenes)


def test_the_table_counts_what_was_run(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(robustness, "OUT", tmp_path / "table.md")
    rows: list[dict[str, Any]] = [
        {"set": group, "problem": f"{group}-{number}", "change": "none", "reached": number != 0, "missed": None}
        | ({"missed": "pick(a, b)", "how": "missing: in-hand(a)"} if number < 2 else {"how": None})
        | {"grasps": 1 + number}
        for group in ("easy", WIDE)
        for number in range(4)
    ]
    write_table([*rows, {"set": "hard", "problem": "hard-7", "change": "", "reached": None}])
    text = (tmp_path / "table.md").read_text()
    assert "| none | 3/4 | 3 of 4 (30 to 95 %) | 3 of 4 (30 to 95 %) |" in text
    assert "No plan was found for: hard-7." in text
    assert "| all four levels | none | 1 | 0 | 0 | 0 | 2 of 10 |" in text
    assert "In 2 other executions" in text


def test_a_run_goes_on_where_it_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that ends in the middle of a plan executes only what is missing."""
    executed: list[tuple[Any, str]] = []

    def execute_all(plan: Any, todo: Mapping[str, Changes]) -> Iterator[tuple[str, dict[str, Any]]]:
        for change in todo:
            yield change, {"reached": True, "missed": None, "how": None}
            executed.append((plan, change))

    def interrupt(plan: Any, todo: Mapping[str, Changes]) -> Iterator[tuple[str, dict[str, Any]]]:
        yield from list(execute_all(plan, dict(list(todo.items())[:3])))
        raise KeyboardInterrupt

    scenes = [("easy", "easy-000", None), ("easy", "easy-001", None)]
    monkeypatch.setattr(robustness, "OUT", tmp_path / "table.md")
    monkeypatch.setattr(robustness, "find_plan", lambda name, *_: name)
    monkeypatch.setattr(robustness, "find_scenes", lambda _: scenes)
    monkeypatch.setattr(robustness, "execute_all", interrupt)
    with pytest.raises(KeyboardInterrupt):
        robustness.run(Options(out=tmp_path / "run"))
    monkeypatch.setattr(robustness, "execute_all", execute_all)
    rows = robustness.run(Options(out=tmp_path / "run"))
    assert len(rows) == 2 * len(CHANGES)
    assert sorted(executed) == sorted((name, change) for _, name, _ in scenes for change in CHANGES)


def test_a_problem_without_a_plan_has_one_line() -> None:
    assert list(robustness.execute_all(None, CHANGES)) == [("", {"reached": None})]
