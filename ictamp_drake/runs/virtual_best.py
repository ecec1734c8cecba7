"""The virtual best strategy, which knows beforehand which of all others will be the quickest on each problem.

It bounds what any choice among them can gain: the virtual best solver of algorithm portfolios (e.g. Xu et al. 2012).
"""

import pandas as pd

from ictamp_drake.runs.comparison import PROBLEM, compared
from ictamp_drake.runs.markdown import table
from ictamp_drake.runs.verdicts import shown_ratio

NAME = "virtual best"


def headroom(runs: pd.DataFrame) -> list[str]:
    """Its time as a multiple of each strategy's, a column a level; in Markdown, and nothing of a single strategy.

    Args:
        runs: see `regime.tabulated`.
    """
    strategies = list(runs["strategy"].cat.categories)
    if len(strategies) < 2:
        return []
    both = pd.concat([runs, virtual_best(runs)])
    comparisons = {name: compared(both, NAME, name) for name in strategies}
    levels = [each.level for each in comparisons[strategies[0]]]
    rows = [[name, *(shown_ratio(each.time) for each in of)] for name, of in comparisons.items()]
    return table(["strategy", *levels], rows)


def virtual_best(runs: pd.DataFrame) -> pd.DataFrame:
    """Of every problem and seed the quickest run that solved it, or any run when none did."""
    quickest_first = runs.sort_values(["solved", "seconds"], ascending=[False, True], kind="stable")
    return quickest_first.drop_duplicates([*PROBLEM, "seed"]).assign(strategy=NAME)
