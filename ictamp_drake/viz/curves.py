"""Figures of the share of problems that strategies solve within a time and within a number of low-level steps.

Runs are the rows of `reports.regime.tabulated`.
"""

from collections.abc import Iterator

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import LogLocator, NullFormatter, PercentFormatter, StrMethodFormatter

from ictamp_drake.core.types import FloatArray
from ictamp_drake.viz.figures import GRID

COLORS = (
    *("#0072b2", "#d55e00", "#009e73", "#cc79a7", "#e69f00", "#56b4e9", "#000000"),
    *("#882255", "#999933", "#888888", "#332288"),
)
"""Colors that are also distinct for color-blind readers (Okabe and Ito 2008, then Tol 2021)."""
DASHES: tuple[tuple[float, tuple[float, ...]], ...] = ((0, ()), (0, (5, 2)), (0, (1.5, 1.5)), (0, (6, 2, 1.5, 2)))
WIDTH, HEIGHT = 3.6, 2.6  # size of a panel [in]
BEYOND = 1.25
"""End of the curves as a multiple of the longest run."""


def success(runs: pd.DataFrame, time_limit: float | None) -> Figure:
    """Draw the share of runs solved within t seconds (top) and n low-level steps (bottom), one column per level.

    Curves extend to the time limit [s] or, if it is not known, beyond the longest run. A step in progress at the time
    limit, and its verification, may end later.
    """
    levels = list(runs["level"].cat.categories)
    figure = Figure(figsize=(max(5.0, WIDTH * len(levels)), 2 * HEIGHT + 0.4), layout="constrained")
    grid = figure.subplots(2, len(levels), squeeze=False, sharey=True)
    for level, (above, below) in zip(levels, grid.T, strict=True):
        part = runs[runs["level"] == level]
        _panel(above, part, "seconds", time_limit or BEYOND * part["seconds"].max())
        _panel(below, part, "steps", BEYOND * part["steps"].max())
        above.set(title=f"{level}, problems: {part['problem'].nunique()}", xlabel="time [s]")
        below.set(xlabel="low-level steps")
    for axes in grid[:, 0]:
        axes.set_ylabel("share solved")
    handles = grid[0, 0].get_lines()
    figure.legend(handles=handles, loc="outside lower center", ncols=min(4, len(handles)), frameon=False)
    return figure


def _panel(axes: Axes, runs: pd.DataFrame, figure: str, end: float) -> None:
    """Draw one curve per strategy, empty if the strategy did not run here, so that all panels have the same lines."""
    least, most = runs.loc[runs["solved"], figure].agg(["min", "max"])
    end = max(end, most)  # the end itself when most is nan
    for name, (color, dash) in zip(runs["strategy"].cat.categories, styles(), strict=False):
        of = runs[runs["strategy"] == name]
        solved = of.loc[of["solved"], figure].to_numpy(np.float64)
        reached, share = curve(solved, len(of), end) if len(of) else (np.empty(0), np.empty(0))
        axes.step(reached, share, where="post", color=color, ls=dash, lw=1.6, label=name)
    if least > 0:
        axes.set(xscale="log", xlim=(least / BEYOND, end))
        axes.xaxis.set_major_locator(LogLocator(subs=(1.0, 2.0, 5.0)))
        axes.xaxis.set_major_formatter(StrMethodFormatter("{x:g}"))
        axes.xaxis.set_minor_formatter(NullFormatter())
    axes.set_ylim(0, 1.03)
    axes.yaxis.set_major_formatter(PercentFormatter(1.0))
    axes.grid(color=GRID, lw=0.5)


def curve(solved: FloatArray, runs: int, end: float) -> tuple[FloatArray, FloatArray]:
    """Return the places at which the share of solved runs jumps and the new shares, from share 0 to place `end`.

    Args:
        solved: Time or steps of each solved run, in any order.
        runs: Number of all runs.
        end: Last place of the curve, not before any solved run.
    """
    places = np.sort(solved)
    shares = np.arange(1, len(places) + 1) / runs
    last = shares[-1] if len(shares) else 0.0
    return np.array([0.0, *places, end]), np.array([0.0, *shares, last])


def styles() -> Iterator[tuple[str, tuple[float, tuple[float, ...]]]]:
    """Yield the color and the dashes of each strategy, in order."""
    number = 0
    while True:
        yield COLORS[number % len(COLORS)], DASHES[number % len(DASHES)]
        number += 1
