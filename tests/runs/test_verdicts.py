"""Comparisons in words."""

import math
from dataclasses import replace

import pytest

from ictamp_drake.learning.accuracy import Interval
from ictamp_drake.runs.comparison import Comparison
from ictamp_drake.runs.verdicts import probability, rows, sentences, verdict

FASTER, EVEN, SLOWER = Interval(0.71, 0.6, 0.84), Interval(1.0, 0.9, 1.1), Interval(1.4, 1.2, 1.6)
SAME = Comparison("medium", "X", "Y", 37, (37, 37), (0, 0), 1.0, 37, EVEN, Interval(1.0, 1.0, 1.0))


def test_the_faster_one_is_called_so() -> None:
    assert sentences([replace(SAME, time=FASTER)], [1.0]) == [
        "medium: **`X` is faster than `Y`.** It solves as many (37 and 37 of 37; p = 1); on the 37 problems that both "
        "solve it takes 0.71 (0.60 to 0.84) of the time and 1.00 (1.00 to 1.00) of the steps."
    ]


def test_the_slower_one_that_solves_more_is_called_both() -> None:
    worse = replace(SAME, time=SLOWER, steps=SLOWER, solved=(37, 25), only=(12, 0), p=0.0005, both=25)
    (sentence,) = sentences([worse], [0.004])
    assert sentence.startswith("medium: **`X` solves more, is slower, needs more steps than `Y`.**")
    assert "It solves 12 more (37 and 25 of 37; p = 0.0005, 0.004 by Holm)" in sentence


def test_the_loser_is_called_so() -> None:
    (sentence,) = sentences([replace(SAME, solved=(20, 37), only=(0, 17), p=1e-5)], [1e-4])
    assert sentence.startswith("medium: **`X` solves fewer than `Y`.** It solves 17 fewer")
    assert "p < 0.0001, 0.0001 by Holm" in sentence


@pytest.mark.parametrize(
    ("solved", "p", "raised"), [((37, 37), 1.0, 1.0), ((37, 34), 0.25, 1.0), ((37, 30), 0.02, 0.2)]
)
def test_what_is_not_shown_is_called_so(solved: tuple[int, int], p: float, raised: float) -> None:
    (sentence,) = sentences([replace(SAME, solved=solved, only=(solved[0] - solved[1], 0), p=p)], [raised])
    assert sentence.startswith("medium: **no difference shown between `X` and `Y`.**")


def test_what_cannot_be_compared_says_why() -> None:
    nothing = replace(SAME, pairs=0, solved=(0, 0), both=0, time=None, steps=None)
    alone = replace(nothing, pairs=3, solved=(2, 0), only=(2, 0), p=0.5)
    assert sentences([nothing, alone], [1.0, 1.0]) == [
        "medium: `X` and `Y` have no run in common.",
        "medium: **no difference shown between `X` and `Y`.** It solves 2 more (2 and 0 of 3; p = 0.5), and no problem "
        "is solved by both.",
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


def test_the_table_holds_what_the_sentences_say() -> None:
    lines = rows([replace(SAME, time=FASTER), replace(SAME, time=None, steps=None, both=0)], [1.0, 1.0])
    assert "| medium | X | 37 | 37 and 37 | 0 | 0 | 1 | 1 | 37 | 0.71 (0.60 to 0.84) | faster |" in lines[2]
    assert lines[3].endswith("| 0 | - | no problem in common | - | no problem in common |")


@pytest.mark.parametrize(("p", "text"), [(1.0, "1"), (0.3769, "0.38"), (0.00012, "0.00012"), (1e-6, "< 0.0001")])
def test_probabilities_are_short(p: float, text: str) -> None:
    assert probability(p) == text
