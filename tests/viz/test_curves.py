"""Curves of solved problems jump where problems were solved."""

from itertools import islice

import numpy as np
from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.viz.curves import curve, styles, success
from tests.runs.recorded import run, table

RUNS = table(
    run("a", 0, 4.0),
    run("a", 1, 8.0),
    run("b", 0, 16.0),
    run("b", 1, 60.0, solved=False, low_level_steps=90),
    run("a", 0, 30.0, level="hard"),
)


@given(st.lists(st.floats(0.1, 60), max_size=20), st.integers(0, 5))
def test_a_curve_rises_from_nothing_to_the_share_of_the_solved(solved: list[float], unsolved: int) -> None:
    places, shares = curve(np.array(solved), len(solved) + unsolved, 60.0)
    assert places[0] == shares[0] == 0
    assert places[-1] == 60.0
    assert np.all(np.diff(places) >= 0)
    assert np.all(np.diff(shares) >= 0)
    assert np.isclose(shares[-1] * (len(solved) + unsolved), len(solved))
    for place in solved:
        within = shares[np.searchsorted(places, place, side="right") - 1]
        assert np.isclose(within * (len(solved) + unsolved), sum(other <= place for other in solved))


def test_a_line_a_strategy_and_a_column_a_level() -> None:
    figure = success(RUNS, 60.0)
    easy_time, hard_time, easy_steps, hard_steps = figure.axes
    assert [axes.get_title() for axes in (easy_time, hard_time)] == ["easy, problems: 2", "hard, problems: 1"]
    first, second = easy_time.get_lines()
    assert np.array(first.get_ydata()).tolist() == [0, 0.5, 1, 1]
    assert np.array(second.get_xdata()).tolist() == [0, 16, 60]
    assert np.array(second.get_ydata()).tolist() == [0, 0.5, 0.5]
    assert np.array(easy_steps.get_lines()[1].get_xdata()).tolist() == [0, 6, 112.5]
    assert len(hard_time.get_lines()) == len(hard_steps.get_lines()) == 2
    assert len(hard_time.get_lines()[1].get_xdata()) == 0, "did not run there"
    (legend,) = figure.legends
    assert [text.get_text() for text in legend.get_texts()] == ["a", "b"]


def test_what_was_solved_after_the_limit_is_in_sight() -> None:
    axes = success(table(run("a", 0, 4.0), run("a", 1, 66.0), run("b", 0, 9.0)), 60.0).axes[0]
    assert axes.get_xlim()[1] == 66.0
    assert [np.array(line.get_xdata())[-1] for line in axes.get_lines()] == [66.0, 66.0]


def test_where_nothing_is_solved_there_are_flat_lines() -> None:
    figure = success(table(run("a", solved=False, low_level_steps=0, steps_by_depth=())), None)
    assert np.array(figure.axes[0].get_lines()[0].get_ydata()).max() == 0
    figure.draw_without_rendering()


def test_many_strategies_can_be_told_apart() -> None:
    assert len(set(islice(styles(), 28))) == 28
