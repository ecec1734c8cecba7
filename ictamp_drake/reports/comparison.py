"""Statistical comparison of two strategies that ran the same problems with the same seeds.

Seeds of one problem belong together: tests and resampling always use whole problems, never single runs.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import pandas as pd
from scipy import stats

from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.core.types import FloatArray
from ictamp_drake.reports.accuracy import LEVEL, RESAMPLES, Interval

LEAST = 6
"""Minimum number of problems for an interval: five all differ in one direction by chance alone in 1 of 16 samples."""

KNOWN = 0.75
"""Share of the runs whose machine pace must be known before times are compared at equal pace."""

ALL = "all levels"
PROBLEM = ["level", "problem"]
"""Columns that identify a problem."""


@dataclass(frozen=True)
class Comparison:
    """A strategy compared with the reference.

    Attributes:
        level: Level of the problems, or `ALL`.
        strategy, reference: Names of the strategy and the reference.
        pairs: Number of pairs of runs of the same problem with the same seed.
        solved: Number of pairs that the strategy solved, and number that the reference solved.
        only: Number of pairs that only the strategy solved, and number that only the reference solved.
        p: Probability of a split at least as uneven as `only` if both were equally good, see `even_split`.
        both: Number of problems that both solved with the same seed.
        pace: Computing time for a second of the plan as a multiple of the reference's, median over these problems; far
            from 1 when the machine was not equally fast for both; see `ratio`. None when there are no such problems, or
            when the pace is known for fewer than `KNOWN` of the runs.
        time, steps: Time (divided by the pace where that is known) and number of low-level steps as multiples of the
            reference's, medians over these problems.
    """

    level: str
    strategy: str
    reference: str
    pairs: int
    solved: tuple[int, int]
    only: tuple[int, int]
    p: float
    both: int
    pace: Interval | None
    time: Interval | None
    steps: Interval | None


def compare_strategies(runs: pd.DataFrame, strategy: str, reference: str) -> list[Comparison]:
    """Compare two strategies on each level, and on all levels together when there are several.

    Args:
        runs: Table of the runs, see `regime.tabulate_runs`.
        strategy: Name of the strategy.
        reference: Name of the reference.
    """
    first, second = (runs[runs["strategy"] == name] for name in (strategy, reference))
    pairs = first.merge(second, on=["level", "problem", "seed"], suffixes=("", "_reference"), validate="1:1")
    levels = list(runs["level"].cat.categories)
    parts = {level: pairs[pairs["level"] == level] for level in levels} | ({ALL: pairs} if len(levels) > 1 else {})
    return [_comparison(level, strategy, reference, part) for level, part in parts.items()]


def _comparison(level: str, strategy: str, reference: str, pairs: pd.DataFrame) -> Comparison:
    pairs = pairs.assign(difference=pairs["solved"].astype(int) - pairs["solved_reference"].astype(int))
    both = pairs[pairs["solved"] & pairs["solved_reference"]]
    known = both[["pace", "pace_reference"]].notna().all(axis=1).mean() >= KNOWN
    return Comparison(
        level=level,
        strategy=strategy,
        reference=reference,
        pairs=len(pairs),
        solved=(int(pairs["solved"].sum()), int(pairs["solved_reference"].sum())),
        only=(int((pairs["difference"] > 0).sum()), int((pairs["difference"] < 0).sum())),
        p=even_split(pairs.groupby(PROBLEM, observed=True)["difference"].sum().tolist()),
        both=len(both[PROBLEM].drop_duplicates()),
        pace=ratio(both, "pace") if known else None,
        time=ratio(both, "paced" if known else "seconds"),
        steps=ratio(both, "steps"),
    )


def even_split(differences: Sequence[int]) -> float:
    """Exact two-sided probability of a sum at least as far from 0 if each difference had either sign with equal chance.

    With one seed, differences are -1, 0 and 1, and this is McNemar's exact test. With several seeds, those of a problem
    stay together.

    Args:
        differences: Solved runs of one strategy minus solved runs of the other, for each problem.
    """
    chance = np.ones(1)
    for size in np.abs([each for each in differences if each]):
        flip = np.zeros(2 * size + 1)
        flip[[0, -1]] = 0.5
        chance = np.convolve(chance, flip)
    sums = np.arange(len(chance)) - len(chance) // 2
    return min(1.0, float(chance[np.abs(sums) >= abs(sum(differences))].sum()))


def adjust_for_multiplicity(p: Sequence[float]) -> list[float]:
    """Adjust probabilities for multiple tests (Holm 1979), however the tests depend on each other."""
    order = np.argsort(p, kind="stable")
    raised = np.maximum.accumulate(np.asarray(p)[order] * np.arange(len(p), 0, -1)).clip(max=1.0)
    return raised[np.argsort(order, kind="stable")].tolist()


def ratio(both: pd.DataFrame, figure: str) -> Interval | None:
    """Median over problems of one strategy's figure as a multiple of the other's, with an interval over problems.

    A problem with several seeds counts once, with the median of its ratios. Medians are taken of logarithms, so that
    swapping the strategies gives the inverse. A figure that is 0 or unknown has no ratio. With fewer than `LEAST`
    problems the bounds are nan.
    """
    positive = both[(both[figure] > 0) & (both[f"{figure}_reference"] > 0)]
    logarithms = positive.assign(logarithm=np.log(positive[figure] / positive[f"{figure}_reference"]))
    problems = logarithms.groupby(PROBLEM, observed=True)["logarithm"].median().to_numpy(np.float64)
    if not len(problems):
        return None
    low, high = _bounds(problems) if len(problems) >= LEAST else (np.nan, np.nan)
    return Interval(*(float(np.exp(value)) for value in (np.median(problems), low, high)))


def _bounds(problems: FloatArray) -> tuple[float, float]:
    """Bootstrap interval of the median, by percentiles."""
    found = stats.bootstrap(
        (problems,),
        np.median,
        n_resamples=RESAMPLES,
        confidence_level=LEVEL,
        method="percentile",
        rng=generator(Stream.EVALUATION),
    )
    return found.confidence_interval.low, found.confidence_interval.high
