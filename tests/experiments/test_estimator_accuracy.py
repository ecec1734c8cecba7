"""The program that compares estimators with counted success, as users run it."""

import csv
from pathlib import Path

import pytest

from ictamp_drake.experiments import estimator_accuracy as program
from ictamp_drake.learning.cases import read_cases
from ictamp_drake.learning.dataset import fingerprint
from tests.learning.counted import folder_of, picks
from tests.learning.synthetic import write_untrained
from tests.runs.programs import run

MIXED = ("--walk.sources.optimization", "0.5", "--walk.sources.perturbed", "0.5", "--walk.sources.uniform", "0")
SHORT = ("--walk.states", "3", "--walk.draws", "6", "--workers", "1")
RATES = ("--base-rate.pick", "0.6", "--base-rate.place", "0.7")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with attempts at several cases and with untrained networks."""
    folder = tmp_path_factory.mktemp("accuracy")
    made = run("experiments.collect", "--scenes", "100000:100002", "--out", "gt", *SHORT, *MIXED, folder=folder)
    assert made.returncode == 0, made.stderr
    write_untrained(folder / "networks")
    return folder


@pytest.fixture(scope="module")
def printed(folder: Path) -> str:
    """Output of the program, which writes to the folder `out`."""
    given = ("--ground-truth", "gt", "--checkpoints", "networks", "--out", "out", "--least", "6", *RATES)
    done = run("experiments.estimator_accuracy", *given, folder=folder)
    assert done.returncode == 0, done.stderr
    return done.stdout


@pytest.mark.slow
def test_estimators_are_compared_in_both_skills(folder: Path, printed: str) -> None:
    for skill in ("pick", "place"):
        cases = read_cases(folder / "gt", skill, least=6)
        assert f"{skill}: {len(cases)} cases in 2 scenes, {sum(map(len, cases))} executions" in printed
    assert "Table, cases and pictures: out" in printed
    names = {path.name for path in (folder / "out").iterdir()}
    pictures = {"figure_3.png", "reliability_pick.png", "reliability_place.png", "ground_truth.png"}
    assert names == {"table.md", "cases.csv", *pictures}


@pytest.mark.slow
def test_the_table_says_where_it_comes_from(folder: Path, printed: str) -> None:
    page = (folder / "out" / "table.md").read_text()
    assert "`python -m ictamp_drake.experiments.estimator_accuracy --ground-truth gt" in page
    assert fingerprint(folder / "gt") in page
    assert "- commit: `" in page
    assert "drake 1." in page
    rows = [line for line in page.splitlines() if line.startswith("| ") and "---" not in line]
    assert all(cell.strip() in printed for row in rows for cell in row.strip("|").split("|"))


@pytest.mark.slow
def test_every_case_has_all_estimates(folder: Path, printed: str) -> None:
    assert printed
    with (folder / "out" / "cases.csv").open() as file:
        rows = list(csv.DictReader(file))
    assert len(rows) == sum(len(read_cases(folder / "gt", skill, least=6)) for skill in ("pick", "place"))
    for row in rows:
        assert row["attempts"] == "6"
        assert row["base rate"] == {"pick": "0.600000", "place": "0.700000"}[row["action"]]
        learned = [float(row[name]) for name in row if name == "P" or name.startswith("Q ")]
        assert len(set(learned)) == len(learned) >= 4
        assert all(0 < each < 1 for each in learned)


@pytest.mark.parametrize(
    ("arguments", "place"),
    [
        (["--ground-truth", "nowhere"], "nowhere: "),
        (["--ground-truth", "{few}"], "{few}: "),
        (["--ground-truth", "{few}", "--least", "3"], "{few}: "),
        (["--ground-truth", "{few}", "--sampler", "best"], "{few}: "),
        (["--ground-truth", "{few}", "--least", "1"], "least: "),
        (["--ground-truth", "{few}", "--skills", "push"], "skills: "),
        (["--ground-truth", "{few}", "--skills"], "skills: "),
        (["--ground-truth", "{few}", "--skills", "pick", "pick"], "skills: "),
        (["--ground-truth", "{few}", "--checkpoints", "none"], "none/pick_estimator.safetensors: "),
        (["--ground-truth", "{few}", "--base-rate.pick", "2"], "base-rate.pick: "),
    ],
)
def test_mistakes_are_answered_with_a_sentence(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], place: str
) -> None:
    few = folder_of(tmp_path / "few", picks(3, [True] * 3), picks(4, [True] * 3))
    networks = write_untrained(tmp_path / "networks")
    given = [each.format(few=few) for each in arguments]
    assert program.main(["--checkpoints", str(networks), *RATES, "--out", str(tmp_path / "out"), *given]) == 2
    error = capsys.readouterr().err
    assert error.startswith(place.format(few=few))
    assert error.count("\n") == 1
    assert not (tmp_path / "out").exists()
