"""Bounds on what is left to gain: the quickest strategy of each problem, and a search in which nothing fails.

The first is the virtual best solver of algorithm portfolios (e.g. Xu et al. 2012). It knows beforehand which strategy
will be the quickest on a problem, so no choice among them gains more. The second holds for any strategy, since every
plan is executed at least once; runs of earlier versions executed it twice, to verify the whole.
"""

from collections.abc import Callable

import numpy as np
import pandas as pd

from ictamp_drake.reports.comparison import PROBLEM, compare_strategies
from ictamp_drake.reports.markdown import table
from ictamp_drake.reports.verdicts import format_ratio

NAME = ""
"""Label of the bound among the strategies; empty, so it cannot clash with one."""


def headroom(runs: pd.DataFrame, bound: Callable[[pd.DataFrame], pd.DataFrame]) -> list[str]:
    """Table in Markdown of the bound as a multiple of each strategy's time, a column per level; empty for one strategy.

    Args:
        runs: Table of `regime.tabulate_runs`, with the times of `pace.scale_to_equal_pace`.
        bound: One of the functions below.
    """
    strategies = list(runs["strategy"].cat.categories)
    if len(strategies) < 2:
        return []
    without_pace = bound(runs).assign(strategy=NAME, pace=np.nan)  # its times are at equal pace already
    both = pd.concat([runs, without_pace])
    comparisons = {name: compare_strategies(both, NAME, name) for name in strategies}
    levels = [each.level for each in comparisons[strategies[0]]]
    rows = [[name, *(format_ratio(each.time) for each in of)] for name, of in comparisons.items()]
    return table(["strategy", *levels], rows)


def virtual_best(runs: pd.DataFrame) -> pd.DataFrame:
    """Select for each problem and seed the quickest run that solved it, or any run if none did."""
    quickest_first = runs.sort_values(["solved", "seconds"], ascending=[False, True], kind="stable")
    return quickest_first.drop_duplicates([*PROBLEM, "seed"])


def quickest_executions(runs: pd.DataFrame) -> pd.DataFrame:
    """Select for each problem and seed the plan that is the quickest to execute, with the time that this takes."""
    plans = runs[runs["solved"] & runs["replay"].notna()]
    plans = plans.assign(seconds=plans["executions"] * plans["replay"]).sort_values("seconds", kind="stable")
    return plans.drop_duplicates([*PROBLEM, "seed"])
