"""Wide scenes are scenes to start in; the table counts executions and goes on where it stopped."""

from pathlib import Path
from typing import Any

import pytest

from benchmarks import robustness
from benchmarks.robustness import CHANGES, SIDES, WIDE, Options, find_scenes, make_wide_scene, write_table
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
    assert not task.goal <= task.s


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
        {"set": group, "problem": f"{group}-{number}", "change": "none", "reached": number != 0, "missed": "pick(a, b)"}
        | {"how": "missing: in-hand(a)"}
        for group in ("easy", WIDE)
        for number in range(4)
    ]
    write_table([*rows, {"set": "hard", "problem": "hard-7", "change": "", "reached": None}])
    text = (tmp_path / "table.md").read_text()
    assert "| none | 3/4 | 3 of 4 (30 to 95 %) | 3 of 4 (30 to 95 %) |" in text
    assert "No plan was found for: hard-7." in text
    assert "| all four levels | none | 1 | 0 | 0 |" in text


def test_a_run_goes_on_where_it_stopped(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    """A run that ends in the middle of a plan executes only what is missing."""
    monkeypatch.setattr(robustness, "OUT", tmp_path / "table.md")
    monkeypatch.setattr(robustness, "find_plan", lambda name, *_: name)
    monkeypatch.setattr(robustness, "find_scenes", lambda _: [("easy", "easy-000", None), ("easy", "easy-001", None)])
    executed: list[tuple[str, str]] = []
    names = {id(changes): name for name, changes in CHANGES.items()}

    def execute(plan: Any, changes: Any) -> dict[str, Any]:
        executed.append((plan, names[id(changes)]))
        return {"reached": True, "missed": None, "how": None}

    def interrupt(plan: Any, changes: Any) -> dict[str, Any]:
        if len(executed) == 3:
            raise KeyboardInterrupt
        return execute(plan, changes)

    monkeypatch.setattr(robustness, "execute", interrupt)
    with pytest.raises(KeyboardInterrupt):
        robustness.run(Options(out=tmp_path / "run"))
    monkeypatch.setattr(robustness, "execute", execute)
    rows = robustness.run(Options(out=tmp_path / "run"))
    assert len(rows) == 2 * len(CHANGES)
    assert sorted(executed) == sorted((name, change) for name in ("easy-000", "easy-001") for change in CHANGES)
