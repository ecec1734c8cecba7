"""The program that reports the results of runs, as users run it."""

import json
from pathlib import Path

import pytest
from matplotlib.image import imread

from ictamp_drake.experiments import report as program
from ictamp_drake.runs.records import Record
from tests.runs import recorded
from tests.runs.programs import run

GOLDEN = Path(__file__).parents[1] / "golden" / "walls.json"


def records() -> list[Record]:
    """Two strategies on two levels, with some problems that one of them did not solve."""
    return [
        recorded.run(name, number, 3.0 + number + 2 * (name == "b"), level=level, solved=name == "a" or number % 3 > 0)
        for level in ("easy", "hard")
        for number in range(8)
        for name in "ab"
    ]


def written(folder: Path) -> dict[str, bytes]:
    return {str(path.relative_to(folder)): path.read_bytes() for path in folder.rglob("*") if path.is_file()}


@pytest.mark.slow
def test_the_page_and_all_that_it_shows_are_written_the_same_every_time(tmp_path: Path) -> None:
    recorded.folder_of(tmp_path / "runs" / "paper", records())
    recorded.folder_of(tmp_path / "runs" / "default", records()[::-1])
    (tmp_path / "tree.json").write_text(json.dumps(json.loads(GOLDEN.read_text())["tree"]))
    found = []
    for hash_seed in (0, 1):
        given = ("--runs", "runs/paper", "runs/default", "--out", "docs/results", "--search", "tree.json")
        done = run("experiments.report", *given, folder=tmp_path, hash_seed=hash_seed)
        assert done.returncode == 0, done.stderr
        found.append(written(tmp_path / "docs"))
    assert found[0] == found[1]
    drawn = [f"{regime}_{what}.png" for regime in ("paper", "default") for what in ("success", "stages", "depths")]
    names = ["table_1.csv", "table_1.tex", "figure_1.svg", "figure_2.png", *drawn]
    assert set(found[0]) == {"results.md", *(f"results/{name}" for name in names)}
    page = found[0]["results.md"].decode()
    assert (
        "python -m ictamp_drake.experiments.report --runs runs/paper runs/default --out docs/results --search" in page
    )
    assert all(f"(results/{name})" in page for name in names)
    assert "somewhere" not in page, "no paths of a machine"
    assert str(tmp_path) not in page
    for name in [name for name in names if name.endswith(".png")]:
        assert min(imread(tmp_path / "docs" / "results" / name).shape[:2]) > 150


@pytest.mark.slow
def test_the_reference_can_be_chosen_and_a_folder_without_it_takes_its_own(tmp_path: Path) -> None:
    recorded.folder_of(tmp_path / "paper", records())
    recorded.folder_of(tmp_path / "default", [recorded.run("c"), recorded.run("d")])
    given = ["--runs", str(tmp_path / "paper"), str(tmp_path / "default"), "--out", str(tmp_path / "out")]
    assert program.main([*given, "--against", "b"]) == 0
    page = (tmp_path / "out.md").read_text()
    assert "Reference: `b`." in page
    assert "Reference: `c`." in page


@pytest.mark.parametrize(
    ("arguments", "place"),
    [
        (["--runs", "{folder}/nowhere"], "runs: "),
        (["--runs", "{folder}/broken"], "{folder}/broken/results.jsonl, line 2: "),
        (["--runs", "{folder}/paper", "--against", "c"], "against: "),
        (["--runs", "{folder}/paper", "{folder}/paper"], "runs: "),
        (["--runs", "{folder}/paper", "--search", "{folder}/paper/config.yaml"], "{folder}/paper/config.yaml: "),
        (["--runs", "{folder}/paper", "--search", "{folder}/empty.json"], "{folder}/empty.json: "),
        (["--runs", "{folder}/paper", "--search", "{folder}/other.json"], "{folder}/other.json: "),
        (["--runs", "{folder}/paper", "--out", "."], "out: "),
        (["--runs", "{folder}/paper", "--out", "{folder}/empty.json/results"], "{folder}/empty.json/results: "),
        (["--runs"], "runs: "),
    ],
)
def test_mistakes_are_answered_with_a_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], place: str
) -> None:
    recorded.folder_of(tmp_path / "paper", records())
    broken = recorded.folder_of(tmp_path / "broken", records()[:1])
    with (broken / "results.jsonl").open("a") as file:
        file.write('{"problem": "easy-0')
    (tmp_path / "empty.json").write_text("{}")
    (tmp_path / "other.json").write_text('{"nodes": [1], "log": [2]}')
    given = [each.format(folder=tmp_path) for each in arguments]
    assert program.main(["--out", str(tmp_path / "out"), *given]) == 2
    error = capsys.readouterr().err
    assert error.startswith(place.format(folder=tmp_path))
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()
