"""Estimates and counted success: laws of the metrics and their intervals."""

from itertools import pairwise

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from ictamp_drake.core.types import FloatArray
from ictamp_drake.learning.cases import Case, Counts, count_outcomes
from ictamp_drake.learning.metrics import BINS, bins, metrics
from ictamp_drake.reports.accuracy import (
    CEILING,
    SCORES,
    advantage,
    compare_estimators,
    figures_of,
    interval,
    resample_scenes,
    share_closer,
)
from tests.learning.counted import case

PROBABILITY = st.floats(0, 1)


@st.composite
def counts(draw: st.DrawFn) -> Counts:
    """Cases in at least two scenes, with successes and failures."""
    size = draw(st.integers(2, 12))
    attempts = np.array(draw(st.lists(st.integers(1, 9), min_size=size, max_size=size)), dtype=np.float64)
    successes = np.array([float(draw(st.integers(0, int(each)))) for each in attempts])
    assume(0 < successes.sum() < attempts.sum())
    scene = np.array([0, 1, *draw(st.lists(st.integers(0, 3), min_size=size - 2, max_size=size - 2))])
    return Counts(scene, attempts, successes)


@st.composite
def judged_cases(draw: st.DrawFn, estimators: int = 1) -> tuple[Counts, list[FloatArray]]:
    """Cases with the estimates of each estimator."""
    found = draw(counts())
    lists = st.lists(PROBABILITY, min_size=len(found), max_size=len(found))
    return found, [np.array(draw(lists)) for _ in range(estimators)]


def singly(found: Counts, P: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Estimate and outcome of every execution."""
    pairs = zip(found.attempts.astype(int), found.successes.astype(int), strict=True)
    outcomes = [np.arange(attempts) < successes for attempts, successes in pairs]
    return np.repeat(P, found.attempts.astype(int)), np.concatenate(outcomes).astype(np.float64)


def simulate_cases(scenes: int = 60, cases: int = 3, executions: int = 40) -> tuple[list[Case], FloatArray]:
    """Cases whose true probabilities share a component per scene, and these probabilities."""
    rng = np.random.default_rng(0)
    logits = np.repeat(rng.normal(0.5, 1.5, scenes), cases) + rng.normal(size=scenes * cases)
    truth = 1 / (1 + np.exp(-logits))
    draws = rng.random((len(truth), executions)) < truth[:, None]
    return [case(number // cases, each.tolist()) for number, each in enumerate(draws)], truth


@given(judged_cases())
def test_an_estimator_that_says_GT_is_never_farther(given_: tuple[Counts, list[FloatArray]]) -> None:
    found, (Q,) = given_
    assert (advantage(found, found.share, Q) <= 0).all()
    share = share_closer(found, found.share, Q, resample_scenes(found, 20))
    assert share.value >= 0.5
    assert figures_of(found, found.share, resample_scenes(found, 20))["error"] == (0, 0, 0)


@given(judged_cases(2))
def test_swapped_estimators_have_the_other_share(given_: tuple[Counts, list[FloatArray]]) -> None:
    found, (P, Q) = given_
    weight = resample_scenes(found, 50)
    one, other = share_closer(found, P, Q, weight), share_closer(found, Q, P, weight)
    np.testing.assert_allclose(
        [one.value, one.low, one.high], 1 - np.array([other.value, other.high, other.low]), atol=1e-12
    )


@given(judged_cases())
def test_intervals_hold_their_figures_and_keep_to_the_range(given_: tuple[Counts, list[FloatArray]]) -> None:
    found, (P,) = given_
    for name, figure in figures_of(found, P, resample_scenes(found, 50)).items():
        assert SCORES[name].low <= figure.low <= figure.value <= figure.high <= SCORES[name].high


@given(judged_cases())
def test_figures_are_those_of_single_executions(given_: tuple[Counts, list[FloatArray]]) -> None:
    found, (P,) = given_
    figures, expected = figures_of(found, P, resample_scenes(found, 2)), metrics(*singly(found, P))
    for name in ("auc", "brier", "brier_skill", "log_loss"):
        assert figures[name].value == pytest.approx(expected[name], abs=1e-9)


def test_the_ece_is_that_of_single_executions_when_bins_part_no_case() -> None:
    cases, truth = simulate_cases()
    assert len(cases) % BINS == 0
    found = count_outcomes(cases)
    expected = metrics(*singly(found, truth**2))["ece"]
    assert figures_of(found, truth**2, resample_scenes(found, 2))["ece"].value == pytest.approx(expected)


@given(counts())
def test_the_base_rate_has_neither_skill_nor_calibration_error(found: Counts) -> None:
    rate = np.full(len(found), found.successes.sum() / found.attempts.sum())
    figures = figures_of(found, rate, resample_scenes(found, 2))
    assert figures["brier_skill"].value == pytest.approx(0, abs=1e-9)
    assert figures["ece"].value == pytest.approx(0, abs=1e-9)
    assert figures["auc"].value == 0.5


@given(judged_cases())
def test_equal_estimates_share_a_bin_and_bins_are_in_order(given_: tuple[Counts, list[FloatArray]]) -> None:
    found, (P,) = given_
    pairs = sorted(zip(P.tolist(), bins(P, found.attempts).tolist(), strict=True))
    for (below, lower), (above, upper) in pairwise(pairs):
        assert 0 <= lower <= upper < BINS
        assert lower == upper or below < above


@given(counts())
def test_samples_take_scenes_as_a_whole(found: Counts) -> None:
    weight = resample_scenes(found, 20)
    for scene in set(found.scene.tolist()):
        assert (np.ptp(weight[:, found.scene == scene], axis=1) == 0).all()
    _, first = np.unique(found.scene, return_index=True)
    assert (weight[:, first].sum(axis=1) == len(first)).all()


def test_an_interval_is_as_wide_as_the_figure_varies() -> None:
    """For the mean of one number per scene: its standard error times 1.96 on either side."""
    P = np.random.default_rng(0).random(400)
    found = Counts(np.arange(400), np.ones(400), np.arange(400) % 2.0)
    error = figures_of(found, P, resample_scenes(found))["error"]
    expected = 1.96 * np.abs(found.share - P).std() / 20
    np.testing.assert_allclose([error.value - error.low, error.high - error.value], expected, rtol=0.1)


def test_undefined_samples_are_left_out() -> None:
    assert interval(0.5, np.array([np.nan, 0.4, 0.6, np.nan, 0.5]), 0, 1) == pytest.approx((0.5, 0.405, 0.595))


def test_nothing_is_better_than_the_ceiling_but_the_truth() -> None:
    cases, truth = simulate_cases()
    rng = np.random.default_rng(1)
    noisy = np.clip(truth + rng.normal(scale=0.2, size=len(truth)), 0.01, 0.99)
    accuracy = compare_estimators(
        "pick", cases, {"truth": truth, "noisy": noisy, "rate": np.full(len(truth), truth.mean())}
    )
    true, ceiling = accuracy.figures["truth"], accuracy.figures[CEILING]
    for name in ("brier", "log_loss"):
        assert true[name].value < ceiling[name].value < accuracy.figures["noisy"][name].value
    assert ceiling["error"].value == pytest.approx(true["error"].value, rel=0.15)
    assert true["auc"].value > ceiling["auc"].value > accuracy.figures["noisy"]["auc"].value
    assert accuracy.figures["noisy"]["closer"].low > 0.6
    assert accuracy.figures["rate"]["closer"].value > 0.8
    assert "closer" not in true
