"""Accuracy of success estimates against counted success, with intervals over scenes (paper, Figure 3).

Estimates are compared with the share of successes of each case and with the outcome of every single execution. Cases of
one scene are correlated, so the intervals come from samples of scenes.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.core.types import FloatArray
from ictamp_drake.learning.cases import Case, Counts, count_outcomes, halves
from ictamp_drake.learning.metrics import BINS, bins

RESAMPLES, LEVEL = 2000, 0.95
CEILING = "half of GT"
"""Name of the oracle that knows one half of the executions and is tested on the other."""


class Interval(NamedTuple):
    """A figure and its bounds with 95 % confidence."""

    value: float
    low: float
    high: float


class Score(NamedTuple):
    """A figure of n estimates and its range; of(counts, P, weight) takes weights of the cases, shape (m, n) -> (m,)."""

    of: Callable[[Counts, FloatArray, FloatArray], FloatArray]
    low: float = 0.0
    high: float = 1.0


Figures = Mapping[str, Interval]
"""Figures of an estimator by the names of `SCORES`, and "closer" when it is compared with another one."""


@dataclass(frozen=True, eq=False)
class Accuracy:
    """Accuracy of the estimators of one skill's success.

    Attributes:
        skill: Skill, pick or place.
        cases: Cases whose success was counted, n of them.
        counts: Executions of the cases.
        estimates: Estimates by name of the estimator, shape (n,) each; the first is compared with all others.
        figures: Figures by name of the estimator; those of the ceiling come last.
    """

    skill: str
    cases: Sequence[Case]
    counts: Counts
    estimates: Mapping[str, FloatArray]
    figures: Mapping[str, Figures]


def compare_estimators(skill: str, cases: Sequence[Case], estimates: Mapping[str, FloatArray]) -> Accuracy:
    """Compute the figures of all estimators, and compare the first estimator with every other."""
    counts = count_outcomes(cases)
    weight = resample_scenes(counts)
    first, *rivals = estimates
    figures = {first: figures_of(counts, estimates[first], weight)}
    for name in rivals:
        closer = share_closer(counts, estimates[first], estimates[name], weight)
        figures[name] = {**figures_of(counts, estimates[name], weight), "closer": closer}
    figures[CEILING] = _ceiling(cases, estimates[first])
    return Accuracy(skill, cases, counts, estimates, figures)


def _ceiling(cases: Sequence[Case], P: FloatArray) -> Figures:
    """Best figures possible with random outcomes: an oracle counts one half of the executions, see `halves`."""
    known, tested = halves(cases)
    weight = resample_scenes(tested)
    average = known.successes.sum() / known.attempts.sum()
    oracle = (known.successes + average) / (known.attempts + 1)  # never certain, so that log loss is finite
    # GT is the mean of two halves, so it differs from the true probability by half of their difference
    error = Interval(*(value / 2 for value in _figure("error", tested, known.share, weight)))
    closer = share_closer(tested, np.tile(P, 2), oracle, weight)
    return {**figures_of(tested, oracle, weight), "error": error, "closer": closer}


def figures_of(counts: Counts, P: FloatArray, weight: FloatArray) -> Figures:
    """Compute all figures of `SCORES`, with intervals from the weights of `resample_scenes`."""
    return {name: _figure(name, counts, P, weight) for name in SCORES}


def _figure(name: str, counts: Counts, P: FloatArray, weight: FloatArray) -> Interval:
    score = SCORES[name]
    value, *resamples = score.of(counts, P, np.concatenate([np.ones((1, len(counts))), weight]))
    return interval(float(value), np.array(resamples), score.low, score.high)


def share_closer(counts: Counts, P: FloatArray, Q: FloatArray, weight: FloatArray) -> Interval:
    """Share of the cases in which P is closer to GT than Q; ties count half."""
    difference = advantage(counts, P, Q)
    won = np.where(np.abs(difference) < 1e-12, 0.5, difference < 0)
    return interval(float(won.mean()), weight @ won / weight.sum(axis=1), 0.0, 1.0)


def advantage(counts: Counts, P: FloatArray, Q: FloatArray) -> FloatArray:
    """|GT - P| - |GT - Q|, negative where P is closer, shape (n,) (paper, Figure 3)."""
    return np.abs(counts.share - P) - np.abs(counts.share - Q)


def resample_scenes(counts: Counts, times: int = RESAMPLES) -> FloatArray:
    """Count each case in samples of scenes drawn with replacement, shape (times, n)."""
    scenes, number = np.unique(counts.scene, return_inverse=True)
    even = np.full(len(scenes), 1 / len(scenes))
    return generator(Stream.EVALUATION).multinomial(len(scenes), even, times)[:, number].astype(np.float64)


def interval(value: float, resamples: FloatArray, low: float, high: float) -> Interval:
    """Percentiles of the resamples, shifted so that their median is the figure; the median of errors is biased upward.

    Args:
        value: Figure of all cases.
        resamples: Figure of each sample, shape (m,); nan where it is undefined.
        low, high: Range of the figure.
    """
    tails = np.nanquantile(resamples, [(1 - LEVEL) / 2, 0.5, (1 + LEVEL) / 2])
    below, above = np.clip(value + tails[[0, 2]] - tails[1], low, high)
    return Interval(value, float(min(below, value)), float(max(above, value)))  # min and max only correct rounding


def _error(counts: Counts, P: FloatArray, weight: FloatArray) -> FloatArray:
    """Mean distance from GT over cases."""
    return weight @ np.abs(counts.share - P) / weight.sum(axis=1)


def _auc(counts: Counts, P: FloatArray, weight: FloatArray) -> FloatArray:
    """Probability that a success has a higher estimate than a failure; ties count half."""
    values, place = np.unique(P, return_inverse=True)
    won, lost = _outcomes(counts, weight, place, len(values))
    below = np.cumsum(lost, axis=1) - lost / 2
    return _ratio((won * below).sum(axis=1), won.sum(axis=1) * lost.sum(axis=1))


def _brier(counts: Counts, P: FloatArray, weight: FloatArray) -> FloatArray:
    """Mean squared distance from the outcomes."""
    won, lost = counts.successes, counts.attempts - counts.successes
    return weight @ (won * (1 - P) ** 2 + lost * P**2) / (weight @ counts.attempts)


def _brier_skill(counts: Counts, P: FloatArray, weight: FloatArray) -> FloatArray:
    """1 - Brier score / Brier score of the share of successes among all executions."""
    rate = weight @ counts.successes / (weight @ counts.attempts)
    return 1 - _ratio(_brier(counts, P, weight), rate * (1 - rate))


def _log_loss(counts: Counts, P: FloatArray, weight: FloatArray) -> FloatArray:
    """Mean negative logarithm of the probability that was estimated for the outcome."""
    P = np.clip(P, 1e-7, 1 - 1e-7)
    won, lost = counts.successes, counts.attempts - counts.successes
    return -(weight @ (won * np.log(P) + lost * np.log1p(-P))) / (weight @ counts.attempts)


def _ece(counts: Counts, P: FloatArray, weight: FloatArray) -> FloatArray:
    """Mean distance of estimate and frequency over bins of cases with about equal numbers of executions."""
    surplus = weight * (counts.attempts * P - counts.successes)
    return np.abs(_sum_by_place(surplus, bins(P, counts.attempts), BINS)).sum(axis=1) / (weight @ counts.attempts)


def _outcomes(counts: Counts, weight: FloatArray, place: NDArray[np.intp], size: int) -> tuple[FloatArray, FloatArray]:
    """Successes and failures at each place, shape (m, size) each."""
    failures = counts.attempts - counts.successes
    return _sum_by_place(weight * counts.successes, place, size), _sum_by_place(weight * failures, place, size)


def _sum_by_place(values: FloatArray, place: NDArray[np.intp], size: int) -> FloatArray:
    """Sums of the values with the same place, shape (m, n) -> (m, size)."""
    return values @ (place[:, None] == np.arange(size)).astype(np.float64)


def _ratio(above: FloatArray, below: FloatArray) -> FloatArray:
    """Quotients, nan where they are undefined."""
    return np.divide(above, below, out=np.full_like(above, np.nan), where=below > 0)


SCORES = {
    "error": Score(_error),
    "auc": Score(_auc),
    "brier": Score(_brier),
    "brier_skill": Score(_brier_skill, low=-np.inf),
    "log_loss": Score(_log_loss, high=np.inf),
    "ece": Score(_ece),
}
"""All figures of an estimator."""
