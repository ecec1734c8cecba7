"""What can be said of two strategies that ran the same problems with the same seeds.

Seeds of one problem belong together: whatever is tested or resampled are problems, never single runs.
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
"""Problems that an interval needs: of five that all differ in one direction, 1 in 16 samples would by chance alone."""

KNOWN = 0.75
"""Share of the runs of which the machine's pace must be known for times to be compared at equal pace."""

ALL = "all levels"
PROBLEM = ["level", "problem"]
"""Columns that name a problem."""


@dataclass(frozen=True)
class Comparison:
    """A strategy beside the reference.

    Attributes:
        level: of the problems, or `ALL`.
        strategy, reference: their names.
        pairs: runs of the same problem with the same seed.
        solved: how many of them the strategy solved, and how many the reference.
        only: how many of them only the strategy solved, and how many only the reference.
        p: probability of so uneven a split of these if both were equally good, see `even_split`.
        both: problems that both solved with the same seed.
        pace: median over these of the computing time for a second of the plan as a multiple of the reference's, far
            from 1 when the machine was not equally fast for both; see `ratio`. None when there are no such problems, or
            when it is known of fewer than `KNOWN` of the runs.
        time, steps: the same of time, divided by the pace where that is known, and of low-level steps.
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
    """Both strategies on each level, and on all levels when there are several; of `runs` see `regime.tabulate_runs`."""
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

    With one seed, differences are -1, 0 and 1, and this is McNemar's exact test. With several, those of a problem keep
    together.

    Args:
        differences: for each problem, how many more runs of it the one strategy solved than the other.
    """
    chance = np.ones(1)
    for size in np.abs([each for each in differences if each]):
        flip = np.zeros(2 * size + 1)
        flip[[0, -1]] = 0.5
        chance = np.convolve(chance, flip)
    sums = np.arange(len(chance)) - len(chance) // 2
    return min(1.0, float(chance[np.abs(sums) >= abs(sum(differences))].sum()))


def adjust_for_multiplicity(p: Sequence[float]) -> list[float]:
    """The same probabilities when all of them are looked at (Holm 1979), for whatever way they depend on each other."""
    order = np.argsort(p, kind="stable")
    raised = np.maximum.accumulate(np.asarray(p)[order] * np.arange(len(p), 0, -1)).clip(max=1.0)
    return raised[np.argsort(order, kind="stable")].tolist()


def ratio(both: pd.DataFrame, figure: str) -> Interval | None:
    """Median over problems of one strategy's figure as a multiple of the other's, with an interval over problems.

    A problem with several seeds counts once, with the median of its ratios; medians are taken of logarithms, so that
    the other way round is the inverse. What is 0 or not known has no ratio. Below `LEAST` problems the bounds are nan.
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
