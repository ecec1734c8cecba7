"""Comparisons in words and as a table."""

import math
from dataclasses import replace

import pytest

from ictamp_drake.reports.accuracy import Interval
from ictamp_drake.reports.comparison import Comparison
from ictamp_drake.reports.verdicts import probability, rows, summary, verdict

FASTER, EVEN, SLOWER = Interval(0.71, 0.6, 0.84), Interval(1.0, 0.9, 1.1), Interval(1.4, 1.2, 1.6)
SAME = Comparison("medium", "X", "Y", 37, (37, 37), (0, 0), 1.0, 37, None, EVEN, Interval(1.0, 1.0, 1.0))


def test_the_faster_one_is_better() -> None:
    assert summary([replace(SAME, time=FASTER)], [1.0]) == [
        "**Better than `Y`**",
        "",
        "- `X`: medium (0.71 (0.60 to 0.84) of the time)",
    ]


def test_the_slower_one_that_solves_more_is_both() -> None:
    both = replace(SAME, time=SLOWER, steps=SLOWER, solved=(37, 25), only=(12, 0), p=0.0005, both=25)
    title, _, line = summary([both], [0.004])
    assert title == "**Better than `Y` in one measure, worse in another**"
    assert line == (
        "- `X`: medium (solves more, 37 against 25 of 37, p = 0.004, 1.40 (1.20 to 1.60) of the time, "
        "1.40 (1.20 to 1.60) of the steps)"
    )


def test_the_loser_is_worse() -> None:
    title, _, line = summary([replace(SAME, solved=(20, 37), only=(0, 17), p=1e-6)], [1e-5])
    assert title == "**Worse than `Y`**"
    assert line == "- `X`: medium (solves fewer, 20 against 37 of 37, p < 0.0001)"


@pytest.mark.parametrize(
    ("solved", "p", "raised"), [((37, 37), 1.0, 1.0), ((37, 34), 0.25, 1.0), ((37, 30), 0.02, 0.2)]
)
def test_what_is_not_shown_is_called_so(solved: tuple[int, int], p: float, raised: float) -> None:
    lines = summary([replace(SAME, solved=solved, only=(solved[0] - solved[1], 0), p=p)], [raised])
    assert lines == ["**No difference from `Y` shown**", "", "- `X`: medium"]


def test_strategies_are_grouped_by_what_is_shown_and_levels_by_strategy() -> None:
    nothing = replace(SAME, pairs=0, solved=(0, 0), both=0, time=None, steps=None)
    faster = replace(SAME, strategy="Z", level="hard", time=FASTER)
    lines = summary([SAME, replace(SAME, level="hard"), replace(nothing, strategy="Z"), faster], [1.0] * 4)
    assert lines == [
        "**Better than `Y`**",
        "",
        "- `Z`: hard (0.71 (0.60 to 0.84) of the time)",
        "",
        "**No difference from `Y` shown**",
        "",
        "- `X`: medium; hard",
        "",
        "**No runs in common with `Y`**",
        "",
        "- `Z`: medium",
    ]


@pytest.mark.parametrize(
    ("interval", "text"),
    [
        (FASTER, "faster"),
        (SLOWER, "slower"),
        (EVEN, "no difference shown"),
        (Interval(0.5, 0.3, 1.0), "no difference shown"),
        (Interval(0.5, math.nan, math.nan), "fewer than 6 problems"),
        (None, "no problem in common"),
    ],
)
def test_a_ratio_is_put_plainly(interval: Interval | None, text: str) -> None:
    assert verdict(interval, "faster", "slower") == text


def test_the_table_holds_what_the_summary_says() -> None:
    faster = replace(SAME, time=FASTER, pace=SLOWER)
    lines = rows([faster, replace(SAME, time=None, steps=None, both=0)], [1.0, 1.0])
    ratios = "| 1.40 (1.20 to 1.60) | 0.71 (0.60 to 0.84) | faster |"
    assert f"| medium | X | 37 | 37 and 37 | 0 | 0 | 1 | 1 | 37 {ratios}" in lines[2]
    assert lines[3].endswith("| 0 | - | - | no problem in common | - | no problem in common |")


@pytest.mark.parametrize(("p", "text"), [(1.0, "1"), (0.3769, "0.38"), (0.00012, "0.00012"), (1e-6, "< 0.0001")])
def test_probabilities_are_short(p: float, text: str) -> None:
    assert probability(p) == text
