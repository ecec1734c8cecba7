"""The page of a run agrees with its records and the files beside them."""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest

from ictamp_drake.runs import index
from ictamp_drake.runs.index import Index
from ictamp_drake.runs.records import Record
from ictamp_drake.tamp.torque_use import TorqueUse
from tests.runs import recorded

SOLVED = recorded.run("els", 0)
BLOCKED = replace(
    recorded.run("els", 1, solved=False),
    high_level_plans=1,
    blocked={"pick(red_box, table)": {"GOAL_IN_COLLISION": 30}},
    obstacles={"pick(red_box, table)": {"blue_box": 30}},
)
BROKEN = replace(recorded.run("els", 2, solved=False), stop_reason="CRASHED", error="Traceback\nOSError: no space\n")


def read(page: Path) -> dict[str, Any]:
    found = re.search(r"const run = (.*);$", page.read_text(), re.MULTILINE)
    assert found is not None
    return dict(json.loads(found[1]))


def written(folder: Path, *records: Record, names: tuple[str, ...] = ()) -> dict[str, Any]:
    made = Index(recorded.folder_of(folder, records), names)
    made.write()
    assert made.error is None
    return read(made.path)


def test_an_entry_tells_what_its_record_tells(tmp_path: Path) -> None:
    run = written(tmp_path / "out", SOLVED, BLOCKED, BROKEN)
    assert run["title"] == "out"
    solved, blocked, broken = run["entries"]
    assert (solved["problem"], solved["strategy"], solved["level"]) == ("easy-000", "els", "easy")
    assert (solved["solved"], solved["seconds"], solved["skills"], solved["steps"]) == (True, 4.0, 6, 6)
    assert (solved["reason"], solved["details"], solved["error"]) == ("", [], "")
    assert (blocked["solved"], blocked["skills"]) == (False, None)
    assert "blue_box (30)" in blocked["details"][0]
    assert broken["error"] == BROKEN.error


def test_a_plan_is_shown_with_the_torque_that_it_needs(tmp_path: Path) -> None:
    torque = TorqueUse(share=0.6, joint="panda_joint2", step=3)
    (entry,) = written(tmp_path / "out", replace(SOLVED, torque=torque))["entries"]
    assert entry["details"] == [str(torque)]


def test_only_what_is_there_is_linked(tmp_path: Path) -> None:
    odd = replace(SOLVED, problem="50 % $HOME #1? \"a\": 'ü'")
    folder = recorded.folder_of(tmp_path / "out", [odd, BLOCKED])
    for record, files in ((odd, ["scene.png", "replay.html", "plan.yaml"]), (BLOCKED, ["search.html"])):
        for file in files:
            path = folder / record.name / file
            path.parent.mkdir(parents=True, exist_ok=True)
            path.touch()
    made = Index(folder, [])
    made.write()
    with_plan, without = read(made.path)["entries"]
    assert with_plan["links"].keys() == {"replay", "plan"}
    assert without["links"].keys() == {"search"}
    assert without["picture"] == ""
    for address in (with_plan["picture"], *with_plan["links"].values(), *without["links"].values()):
        assert (folder / unquote(address)).exists()


def test_problems_that_wait_are_counted(tmp_path: Path) -> None:
    assert written(tmp_path / "out", SOLVED, names=(SOLVED.name, "els/0/easy-007"))["waiting"] == 1


def test_new_records_are_shown_but_not_at_every_turn(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    now = 100.0
    monkeypatch.setattr(index.time, "monotonic", lambda: now)
    made = Index(recorded.folder_of(tmp_path / "out", []), [])
    made.add([])
    assert not made.path.exists(), "there is nothing to show"
    made.add([SOLVED])
    made.add([BLOCKED])
    assert len(read(made.path)["entries"]) == 1
    now += index.EVERY
    made.add([])
    assert len(read(made.path)["entries"]) == 2


def test_a_page_that_cannot_be_written_costs_nothing_else(tmp_path: Path) -> None:
    made = Index(recorded.folder_of(tmp_path / "out", [SOLVED]), [])
    (made.path / "in-the-way").mkdir(parents=True)
    made.add([BLOCKED])
    assert made.error is not None
    assert {path.name for path in made.path.parent.iterdir()} == {"config.yaml", "results.jsonl", "index.html"}
