"""Tables in Markdown about the search of each strategy: effort, failures and kinds of interference.

Runs are the rows of `regime.tabulate_runs`.
"""

import math
from collections import Counter
from collections.abc import Iterable

import numpy as np
import pandas as pd

from ictamp_drake.core.failures import Failure
from ictamp_drake.reports.markdown import table
from ictamp_drake.reports.results_table import format_number
from ictamp_drake.scenes.spec import INTERFERENCES
from ictamp_drake.viz.effort import seconds_by_stage

EFFORT = (
    "level",
    "strategy",
    "plans",
    "most plans",
    "steps",
    "failed steps",
    "time of a step [s]",
    "steps / skill",
    "overhead",
)

PLAIN = "plain"
"""Kind of interference of a problem without any."""

STEP_STAGES = ["sampling", "motion", "physics", "abstraction"]
"""Stages of a low-level step."""


def effort(runs: pd.DataFrame) -> list[str]:
    """Table of the effort of a run, solved or not: plans opened, low-level steps, their cost, and how many fail."""
    groups = runs.groupby(["level", "strategy"], observed=True)
    return table(EFFORT, [[*names, *_effort(group)] for names, group in groups], left=2)


def _effort(runs: pd.DataFrame) -> list[str]:
    steps = int(runs["steps"].sum())
    seconds = seconds_by_stage(runs).reindex(columns=STEP_STAGES).to_numpy(np.float64)
    return [
        format_number(runs["plans"].mean(), 2),
        str(runs["plans"].max()),
        format_number(runs["steps"].mean()),
        _share(int(runs["failed"].sum()), steps),
        format_number(np.nansum(seconds) * len(runs) / steps if steps else math.nan, 2),
        format_number((runs["steps"] / runs["length"].where(runs["length"] > 0)).median(), 2),
        format_number((runs["seconds"] / runs["replay"].where(runs["replay"] > 0)).median(), 2),
    ]


def stages(runs: pd.DataFrame) -> list[str]:
    """Table of the mean seconds of a run in each stage."""
    seconds = seconds_by_stage(runs)
    headings = ["level", "strategy", *(str(stage).replace("_", " ") for stage in seconds)]
    rows = zip(seconds.index, seconds.to_numpy(np.float64), strict=True)
    return table(headings, [[*names, *(format_number(mean, 2) for mean in means)] for names, means in rows], left=2)


def failures(runs: pd.DataFrame) -> list[str]:
    """Table of failed steps by cause, with their share of the strategy's steps; one column per strategy."""
    counts = {name: _sum_failures(group["failures"]) for name, group in runs.groupby("strategy", observed=True)}
    steps = runs.groupby("strategy", observed=True)["steps"].sum()
    causes = [cause.name for cause in Failure if any(cause.name in of for of in counts.values())]
    causes += sorted({name for of in counts.values() for name in of} - set(causes))
    rows = [[_sentence(cause), *(_share(of[cause], steps[name]) for name, of in counts.items())] for cause in causes]
    total = ["all", *(_share(of.total(), steps[name]) for name, of in counts.items())]
    return table(["failed steps", *counts], [*rows, total, ["steps", *map(str, steps)]])


def interference(runs: pd.DataFrame) -> list[str]:
    """Table of solved runs and their median time [s] by level and kind of interference; one column per strategy.

    A problem with several kinds counts for each of them; a level without any interference is left out.
    """
    strategies = list(runs["strategy"].cat.categories)
    rows = []
    for level, part in runs.groupby("level", observed=True):
        for kind in (PLAIN, *INTERFERENCES) if any(part["interference"]) else ():
            of = part[[kind in (kinds or (PLAIN,)) for kinds in part["interference"]]]
            if len(of):
                rows.append([level, kind, *(_solved_cell(of[of["strategy"] == name]) for name in strategies)])
    return table(["level", "interference", *strategies], rows, left=2) if rows else []


def _solved_cell(runs: pd.DataFrame) -> str:
    solved = runs[runs["solved"]]
    time = f", {format_number(solved['seconds'].median())} s" if len(solved) else ""
    return f"{len(solved)} of {len(runs)}{time}" if len(runs) else "-"


def _sum_failures(failures: Iterable[dict[str, int]]) -> Counter[str]:
    return sum(map(Counter, failures), Counter[str]())


def _sentence(cause: str) -> str:
    return str(Failure.__members__.get(cause, cause))


def _share(count: int, steps: int) -> str:
    """Format a count with its share, e.g. "12 (3.1 %)"."""
    return f"{count} ({count / steps:.1%})".replace("%", " %") if count else "0"
