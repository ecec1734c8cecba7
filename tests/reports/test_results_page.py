"""The page of results is complete and plain."""

import re

import pytest

from ictamp_drake.reports.regime import Regime
from ictamp_drake.reports.results_page import Chapter, page
from tests.runs.recorded import run, table

FAST = [run(name, number, 2.0 if name == "a" else 4.0) for number in range(9) for name in "ab"]
ALONE = [run("c", 0), run("c", 1, solved=False)]
ABOUT = {"commit": "9760efb", "cores": "2"}
MORE = ABOUT | {"load": "2.0"}


@pytest.fixture(scope="module")
def text() -> str:
    paper, alone = (
        Regime("paper", table(*FAST), ABOUT, 60.0),
        Regime("alone", table(*ALONE, time_limit=None), MORE, None),
    )
    pictures = {what: f"results/paper_{what}.png" for what in ("success", "stages", "depths")}
    chapters = [
        Chapter.create(paper, "b", pictures),
        Chapter.create(alone, "c", {"success": "results/a lone.png", "stages": "results/alone.png"}),
    ]
    files = {name: f"results/{name}" for name in ("figure_2", "table_1.tex", "table_1.csv")}
    return page(
        chapters, "python -m report", {**files, "figure_1": "results/figure_1.svg", "figure_3": "../figure_3.png"}
    )


def test_it_begins_with_how_it_was_made(text: str) -> None:
    before, _, _ = text.partition("## What is and is not significant")
    assert "```\npython -m report\n```" in before
    assert "| regime | paper | alone |" in before
    assert "| commit | 9760efb | 9760efb |" in before
    assert "| load | - | 2.0 |" in before


def test_then_comes_what_is_shown(text: str) -> None:
    _, _, after = text.partition("## What is and is not significant")
    verdicts, _, _ = after.partition("\n## ")
    assert "**Better than `b`**\n\n- `a`: easy (0." in verdicts
    assert "`c` is the only strategy" in verdicts


def test_strategies_without_a_run_in_common_are_no_further_tests() -> None:
    lost = [run("b", number, solved=False) for number in range(9)]
    won = [run("a", number) for number in range(9)]
    alone, beside = (
        Chapter.create(Regime("", table(*won, *lost, *more), {}, 60.0), "b", {}) for more in ([], [run("c", 20)])
    )
    assert beside.p[0] == alone.p[0] == alone.comparisons[0].p < 0.01
    assert len(beside.p) == 2


def test_it_says_how_unsolved_runs_count(text: str) -> None:
    assert "an unsolved run counts as the limit of 60 s" in text
    assert "an unsolved run counts as the time that it took" in text


def test_pictures_stand_where_they_belong(text: str) -> None:
    assert re.findall(r"!\[(.*)\]\((.*)\)", text) == [
        ("Figure 2", "results/figure_2"),
        ("success, paper", "results/paper_success.png"),
        ("success, alone", "results/a%20lone.png"),
        ("Figure 1", "results/figure_1.svg"),
        ("stages, paper", "results/paper_stages.png"),
        ("stages, alone", "results/alone.png"),
        ("depths, paper", "results/paper_depths.png"),
        ("Figure 3", "../figure_3.png"),
    ]


def test_a_regime_is_in_every_section_that_has_something_of_it(text: str) -> None:
    sections = re.split(r"^## ", text, flags=re.MULTILINE)[1:]
    without = {
        name: [section.partition("\n")[0] for section in sections if f"### {name}\n" not in section]
        for name in ("paper", "alone")
    }
    common = ["Scenes", "A search over time", "How close P and Q are to counted success"]
    assert without["paper"] == common
    assert without["alone"] == [
        "Scenes",
        "Paired comparisons",
        "What is left to gain",
        "A search over time",
        "Where in the tree the steps go",
        "How close P and Q are to counted success",
    ]
    assert text.count("| easy | p_score | 45 of 55 |") == 1
    assert "\n\n\n" not in text
