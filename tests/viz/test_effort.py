"""Figures of effort show the recorded values."""

import numpy as np
import pytest
from matplotlib.patches import Rectangle

from ictamp_drake.viz.effort import STAGES, depths, seconds_by_stage, stages, steps_by_depth
from tests.runs.recorded import run, table

RUNS = table(
    run("a", 0, 4.0, steps_by_depth=(1, 1)),
    run("a", 1, 8.0, steps_by_depth=(3, 1, 2)),
    run("b", 0, 9.0, level="hard", steps_by_depth=(8,), seconds_by_stage={"physics": 7.0, "dreaming": 2.0}),
    run("c", 0, 9.0, level="hard", steps_by_depth=()),
)


def test_seconds_are_means_in_the_order_of_the_stages() -> None:
    means = seconds_by_stage(RUNS)
    assert list(means) == ["setup", "motion", "physics", "dreaming"]
    assert means.loc[("easy", "a")].tolist() == [0.5, 1.5, 4.0, 0.0]
    assert means.loc[("hard", "b")].tolist() == [0.0, 0.0, 7.0, 2.0]


def test_bars_are_as_long_as_a_run() -> None:
    easy, hard = stages(RUNS).axes
    assert (easy.get_title(), hard.get_title()) == ("easy", "hard")
    bars = [patch for patch in hard.patches if isinstance(patch, Rectangle)]
    assert len(bars) == 4 * 3, "stages and strategies"
    ends = {round(bar.get_y() + bar.get_height() / 2): 0.0 for bar in bars}
    for bar in bars:
        row = round(bar.get_y() + bar.get_height() / 2)
        ends[row] = max(ends[row], bar.get_x() + bar.get_width())
    assert ends == pytest.approx({0: 0.0, 1: 9.0, 2: 9.0})


def test_steps_are_means_by_depth() -> None:
    means = steps_by_depth(RUNS[RUNS["level"] == "easy"])
    assert means.to_numpy().tolist() == [[2.0, 1.0, 1.0]]


def test_the_tree_has_a_panel_a_level_and_a_row_a_strategy_that_knows() -> None:
    easy, hard = depths(RUNS).axes
    assert [[text.get_text() for text in axes.texts] for axes in (easy, hard)] == [["2.0", "1.0", "1.0"], ["8.0"]]
    assert [label.get_text() for label in hard.get_yticklabels()] == ["b"]
    (image,) = hard.get_images()
    assert np.asarray(image.get_array()).tolist() == [[1.0]]


def test_every_stage_has_its_own_color() -> None:
    assert len(set(STAGES.values())) == len(STAGES)


@pytest.mark.parametrize("levels", [("easy",), ("easy", "hard")])
def test_no_stage_in_the_legend_is_cut_off(levels: tuple[str, ...]) -> None:
    figure = stages(table(*(run("a", level=level, seconds_by_stage=dict.fromkeys(STAGES, 1.0)) for level in levels)))
    figure.draw_without_rendering()
    legend = figure.legends[0].get_window_extent()
    assert figure.bbox.x0 <= legend.x0 < legend.x1 <= figure.bbox.x1
