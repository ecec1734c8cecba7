"""Figures of estimates against counted success."""

from pathlib import Path

import numpy as np
import pytest
from matplotlib.image import imread
from matplotlib.patches import Rectangle

from ictamp_drake.reports.accuracy import Accuracy, advantage, compare_estimators
from ictamp_drake.reports.accuracy_figures import draw_all, figure_3, ground_truth, reliability
from tests.learning.counted import case


@pytest.fixture(scope="module")
def accuracy() -> Accuracy:
    rng = np.random.default_rng(0)
    cases = [case(number // 2, (rng.random(20) < number / 24).tolist()) for number in range(24)]
    names = ("P", "Q of 1 draw", "Q mean of 64")
    return compare_estimators(
        "pick", cases, {**{name: rng.random(24) for name in names}, "base rate": np.full(24, 0.5)}
    )


def test_figure_3_shows_every_case_in_ascending_order(accuracy: Accuracy) -> None:
    (axes,) = figure_3([accuracy]).axes
    bars = [patch.get_height() for patch in axes.patches if isinstance(patch, Rectangle)]
    expected = advantage(accuracy.counts, accuracy.estimates["P"], accuracy.estimates["Q of 1 draw"])
    assert bars == sorted(expected.tolist())
    assert "P closer than Q of 1 draw" in axes.get_title()
    legend = axes.get_legend()
    assert legend is not None
    assert [text.get_text() for text in legend.get_texts()] == ["Q of 1 draw", "Q mean of 64", "base rate"]


def test_reliability_has_a_panel_an_estimator(accuracy: Accuracy) -> None:
    titles = [axes.get_title() for axes in reliability(accuracy).axes if axes.axison]
    assert [title.partition(":")[0] for title in titles] == list(accuracy.estimates)


def test_all_cases_are_in_the_histogram(accuracy: Accuracy) -> None:
    for axes in ground_truth([accuracy, accuracy]).axes:
        assert sum(patch.get_height() for patch in axes.patches if isinstance(patch, Rectangle)) == 24


def test_pictures_are_written_and_the_same_every_time(accuracy: Accuracy, tmp_path: Path) -> None:
    names = draw_all([accuracy], tmp_path)
    assert sorted(path.name for path in tmp_path.iterdir()) == sorted(names)
    before = {name: (tmp_path / name).read_bytes() for name in names}
    for name in names:
        height, width = imread(tmp_path / name).shape[:2]
        assert min(height, width) > 300
    draw_all([accuracy], tmp_path)
    assert {name: (tmp_path / name).read_bytes() for name in names} == before
