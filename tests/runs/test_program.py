"""Final output of a program."""

from io import StringIO
from pathlib import Path

import pytest
from rich.console import Console

from ictamp_drake.core.decoding import decode
from ictamp_drake.core.reading import parse
from ictamp_drake.runs import program
from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.index import INDEX
from ictamp_drake.runs.jobs import Job, Problem
from ictamp_drake.runs.program import Work, run
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.tamp.method import Method
from tests.runs import recorded
from tests.runs.programs import SCENE


@pytest.mark.parametrize(
    ("strategy", "count", "place"),
    [
        ("", 1, "easy-000/search.html"),
        ("", 2, "*/search.html"),
        ("els", 1, "els/0/easy-000/search.html"),
        ("els", 2, "*/*/*/search.html"),
    ],
)
def test_pictures_are_found_where_it_says_that_they_are(strategy: str, count: int, place: str, tmp_path: Path) -> None:
    records = [recorded.run(strategy, number) for number in range(count)]
    out = recorded.folder_of(tmp_path / "out", records, {"program": "packing"})
    jobs = [Job(Problem(record.problem, decode(SceneSpec, parse(SCENE))), Method(), strategy) for record in records]
    printed = StringIO()
    assert run(Work("packing", {"program": "packing"}, jobs, Conduct(out=out)), Console(file=printed)) == 0
    assert f"Searches: {out / place}\n" in printed.getvalue()
    assert str(out / INDEX) in printed.getvalue()
    assert (out / INDEX).exists()


@pytest.mark.parametrize(
    ("changes", "strategy", "code"),
    [
        ([{}], "", 0),
        ([{"solved": False}], "", 1),
        ([{"solved": False}], "els", 0),
        ([{"solved": False}, {}], "", 0),
        ([{"error": "a page could not be made"}], "", 1),
        ([{"error": "the process died", "solved": False, "stop_reason": "CRASHED"}, {}], "", 1),
    ],
)
def test_the_exit_code_tells_solved_from_not_solved_and_sound_from_broken(
    changes: list[dict[str, object]], strategy: str, code: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(program, "_sweep", lambda *_: True)  # what broke is not tried again
    records = [recorded.run(strategy, number, **change) for number, change in enumerate(changes)]
    out = recorded.folder_of(tmp_path / "out", records, {"program": "packing"})
    jobs = [Job(Problem(record.problem, decode(SceneSpec, parse(SCENE))), Method(), strategy) for record in records]
    assert run(Work("packing", {"program": "packing"}, jobs, Conduct(out=out)), Console(file=StringIO())) == code


def test_a_page_that_cannot_be_written_costs_only_itself(tmp_path: Path) -> None:
    record = recorded.run("", 0)
    out = recorded.folder_of(tmp_path / "out", [record], {"program": "packing"})
    (out / INDEX / "in-the-way").mkdir(parents=True)
    job = Job(Problem(record.problem, decode(SceneSpec, parse(SCENE))), Method())
    printed = StringIO()
    assert run(Work("packing", {"program": "packing"}, [job], Conduct(out=out)), Console(file=printed)) == 0
    assert f"{out / INDEX} could not be written" in printed.getvalue()
