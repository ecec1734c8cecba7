"""Table 1, for our runs and the paper's."""

import io
import math

import pandas as pd
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from ictamp_drake.reports.results_table import (
    PUBLISHED,
    as_csv,
    cells,
    format_number,
    latex,
    markdown,
    published_rows,
    table_1,
    wilson,
)
from ictamp_drake.scenes.levels import PAPER_LEVELS
from tests.runs.recorded import run, table

RUNS = table(
    run("P_score", 0, 4.0),
    run("P_score", 1, 8.0, low_level_steps=12),
    run("P_score", 2, 6.0, low_level_steps=9),
    run("P_score", 3, 61.0, solved=False, low_level_steps=400),
    run("ELS", 0, 30.0, solved=False),
    run("ELS", 0, 9.0, level="hard", high_level_plans=3),
)


def test_figures_are_of_the_solved_runs_and_unsolved_ones_count_with_the_limit() -> None:
    first, second, third = table_1("paper", RUNS)
    assert (first.level, first.strategy, first.runs, first.solved) == ("easy", "P_score", 4, 3)
    assert (first.mean_s, first.median_s, first.all_mean_s) == (6.0, 6.0, 19.5)
    assert (first.steps, first.median_steps, first.plans) == (9.0, 9.0, 1.0)
    assert (second.strategy, second.solved, second.all_mean_s) == ("ELS", 0, 60.0)
    assert math.isnan(second.mean_s)
    assert (third.level, third.plans) == ("hard", 3.0)


@given(st.integers(1, 60).flatmap(lambda runs: st.tuples(st.integers(0, runs), st.just(runs))))
def test_the_interval_of_a_share_is_wilsons(solved: tuple[int, int]) -> None:
    expected = stats.binomtest(*solved).proportion_ci(0.95, "wilson")
    found = wilson(solved[0] / solved[1], solved[1])
    assert (found.low, found.high) == pytest.approx((expected.low, expected.high), abs=1e-12)


def test_further_seeds_do_not_narrow_the_interval_of_a_share() -> None:
    once, often = (
        table_1(
            "", table(*(run("a", number, seed=seed, solved=number > 0) for number in range(4) for seed in range(seeds)))
        )
        for seeds in (1, 5)
    )
    assert once[0].share == often[0].share
    assert (often[0].runs, often[0].problems) == (20, 4)


def test_latex_shows_any_name() -> None:
    (line,) = [line for line in latex(table_1("", table(run(r"a_b & \c^2~{%}")))).splitlines() if "easy" in line]
    name = r"a\_b \& \textbackslash{}c\textasciicircum{}2\textasciitilde{}\{\%\}"
    assert line.split(" & ", 1)[1].startswith(name)


@pytest.mark.parametrize(
    ("value", "text"), [(math.nan, "-"), (0.0, "0.0"), (0.12345, "0.1"), (84.52, "84.5"), (1234.5, "1234.5")]
)
def test_figures_have_as_many_digits_as_the_papers(value: float, text: str) -> None:
    assert format_number(value) == text


def test_a_row_reads_as_in_the_paper() -> None:
    assert cells(table_1("paper", RUNS)[0]) == [
        *("easy", "P_score", "3 of 4", "75 % (30 % to 95 %)"),
        *("6.0", "6.0", "19.5", "1.00", "9.0", "9.0", "-"),
    ]


def test_a_plan_takes_the_arm_what_is_known_of_all_of_them() -> None:
    known = [run("a", number, plan_duration_s=seconds) for number, seconds in enumerate((50.0, 60.0))]
    unsolved = run("a", 2, solved=False)
    assert table_1("", table(*known, unsolved))[0].duration_s == 55.0
    assert math.isnan(table_1("", table(*known, unsolved, run("a", 3)))[0].duration_s)


def test_the_papers_rows_are_of_its_problems() -> None:
    rows = published_rows()
    assert {(row.level, row.problems) for row in rows} == {(name, level.count) for name, level in PAPER_LEVELS.items()}
    assert [row.solved for row in rows if row.strategy == "p_score"] == [45, 16, 1]
    assert all(math.isnan(row.mean_s) == (row.solved == 0) for row in rows)
    header = markdown(rows)[0]
    assert "median" not in header
    assert "mean time [s]" in header


def test_latex_has_a_block_a_source_and_a_rule_a_level() -> None:
    text = latex([*table_1("my_runs", RUNS), *published_rows()])
    lines = text.splitlines()
    assert lines[0] == r"\begin{tabular}{llrrrrrrrr}"
    assert r"easy & P\_score & 3 of 4 & 75 \% (30 \% to 95 \%) & 6.0 & 6.0 & 19.5 & 1.00 & 9.0 & 9.0 \\" in lines
    assert r"\multicolumn{10}{l}{\emph{my\_runs}} \\" in lines
    assert rf"\multicolumn{{10}}{{l}}{{\emph{{{PUBLISHED}}}}} \\" in lines
    assert lines.count(r"\midrule") == 2 + 2 + 3
    rows = [line for line in lines if line.endswith(r"\\") and "multicolumn" not in line]
    assert len(rows) == 1 + 3 + 15
    assert {row.count(" & ") for row in rows} == {9}


def test_the_figures_can_be_read_back() -> None:
    rows = [*table_1("paper", RUNS), *published_rows()]
    read = pd.read_csv(io.StringIO(as_csv(rows)))
    assert read["source"].tolist() == [row.source for row in rows]
    assert read["mean_s"].tolist() == pytest.approx([row.mean_s for row in rows], nan_ok=True)
    shares = [figure for row in rows for figure in row.share]
    assert read[["share", "share_low", "share_high"]].to_numpy().ravel().tolist() == pytest.approx(shares, abs=1e-5)
