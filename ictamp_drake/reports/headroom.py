"""Bounds on what is left to gain: the quickest strategy of each problem, and a search in which nothing fails.

The first is the virtual best solver of algorithm portfolios (e.g. Xu et al. 2012): it knows in advance which strategy
will be the quickest on a problem, so no choice among the strategies gains more. The second bounds the gain of any
strategy, since every plan is executed at least once. Runs of earlier versions executed it twice, to verify it as a
whole.
"""

from collections.abc import Callable

import numpy as np
import pandas as pd

from ictamp_drake.reports.comparison import PROBLEM, compare_strategies
from ictamp_drake.reports.markdown import table
from ictamp_drake.reports.verdicts import format_ratio

NAME = ""
"""Name of the bound among the strategies; empty, so that it equals none of theirs."""


def headroom(runs: pd.DataFrame, bound: Callable[[pd.DataFrame], pd.DataFrame]) -> list[str]:
    """Format the bound as a multiple of each strategy's time, one column per level, in Markdown.

    Args:
        runs: Table of the runs, see `regime.tabulate_runs`, with times scaled by `pace.scale_to_equal_pace`.
        bound: Function that computes the bound, one of those below.

    Returns:
        Lines of the table; none when there is a single strategy.
    """
    strategies = list(runs["strategy"].cat.categories)
    if len(strategies) < 2:
        return []
    without_pace = bound(runs).assign(strategy=NAME, pace=np.nan)  # its times are already at equal pace
    both = pd.concat([runs, without_pace])
    comparisons = {name: compare_strategies(both, NAME, name) for name in strategies}
    levels = [each.level for each in comparisons[strategies[0]]]
    rows = [[name, *(format_ratio(each.time) for each in of)] for name, of in comparisons.items()]
    return table(["strategy", *levels], rows)


def virtual_best(runs: pd.DataFrame) -> pd.DataFrame:
    """Quickest run that solved each problem and seed, or any run when none did."""
    quickest_first = runs.sort_values(["solved", "seconds"], ascending=[False, True], kind="stable")
    return quickest_first.drop_duplicates([*PROBLEM, "seed"])


def quickest_executions(runs: pd.DataFrame) -> pd.DataFrame:
    """Plan that is the quickest to execute of those found for each problem and seed, with the time of its execution."""
    plans = runs[runs["solved"] & runs["replay"].notna()]
    plans = plans.assign(seconds=plans["executions"] * plans["replay"]).sort_values("seconds", kind="stable")
    return plans.drop_duplicates([*PROBLEM, "seed"])
