"""The accuracy of estimators in words and numbers."""

import csv
import io

import numpy as np
import pytest
from rich.console import Console

from ictamp_drake.reports.accuracy import CEILING, Accuracy, Interval, compare_estimators
from ictamp_drake.reports.accuracy_table import as_csv, cell, format_accuracies, markdown
from tests.learning.counted import case


@pytest.fixture(scope="module")
def accuracies() -> list[Accuracy]:
    found = []
    for skill in ("pick", "place"):
        rng = np.random.default_rng(len(skill))
        cases = [case(scene, (rng.random(10) < scene / 8).tolist(), skill) for scene in range(8)]
        estimates = {"P": np.linspace(0.1, 0.9, 8), "Q of 1 draw": rng.random(8), "base rate": np.full(8, 0.5)}
        found.append(compare_estimators(skill, cases, estimates))
    return found


def test_figures_stand_with_their_intervals() -> None:
    figures = {"auc": Interval(0.712, 0.64, 0.7777), "brier": Interval(0.2, 0.1, 0.3)}
    assert cell(figures, "auc") == "0.71 (0.64, 0.78)"
    assert cell(figures, "brier") == "0.200"
    assert cell(figures, "closer") == ""
    assert cell({"brier_skill": Interval(-0.001, -0.2, 0.0)}, "brier_skill") == "0.00 (-0.20, 0.00)"


def test_the_report_fits_a_screen_and_has_a_row_an_estimator(accuracies: list[Accuracy]) -> None:
    console = Console(width=120)
    with console.capture() as capture:
        console.print(format_accuracies(accuracies))
    printed = capture.get()
    assert "…" not in printed
    assert "pick: 8 cases in 8 scenes, 80 executions" in printed
    for name in ("P", "Q of 1 draw", "base rate", CEILING):
        assert sum(line.strip().startswith(f"{name} ") for line in printed.splitlines()) >= 2
    assert "P closer: share of the cases in which P is closer to GT" in printed


def test_the_page_holds_both_skills_pictures_and_provenance(accuracies: list[Accuracy]) -> None:
    page = markdown(accuracies, {"command": "python -m it"}, ["figure_3.png"])
    assert page.count("| estimator | error | P closer |") == 2
    assert "![figure 3](figure_3.png)" in page
    assert "- command: `python -m it`" in page
    widths = {line.count("|") for line in page.splitlines() if line.startswith("|")}
    assert widths == {9}


def test_the_cases_can_be_read_back(accuracies: list[Accuracy]) -> None:
    rows = list(csv.DictReader(io.StringIO(as_csv(accuracies))))
    assert [row["action"] for row in rows] == ["pick"] * 8 + ["place"] * 8
    for row, each in zip(rows, accuracies[0].cases, strict=False):
        assert int(row["successes"]) == each.outcomes.sum()
        assert (int(row["attempts"]), int(row["half_attempts"])) == (10, 5)
        assert int(row["half_successes"]) == each.outcomes[1::2].sum()
        assert float(row["GT"]) == each.outcomes.mean()
    np.testing.assert_allclose([float(row["P"]) for row in rows[:8]], accuracies[0].estimates["P"], atol=1e-6)
