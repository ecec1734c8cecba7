"""Figures of a search's time by stage and its steps by depth. Runs are the rows of `reports.regime.tabulated`."""

import numpy as np
import pandas as pd
from matplotlib.axes import Axes
from matplotlib.figure import Figure

from ictamp_drake.core.types import FloatArray
from ictamp_drake.viz.figures import LABEL

STAGES = {
    "setup": "#bbbbbb",
    "plan_generator": "#e69f00",
    "selection": "#d55e00",
    "sampling": "#cc79a7",
    "motion": "#56b4e9",
    "physics": "#0072b2",
    "abstraction": "#000000",
    "verification": "#009e73",
}
"""Stages of a run in order, with their colors."""
ROW, WIDTH, MARGIN = 0.3, 3.6, 0.9  # height of a strategy's row, width of a panel, outer margin [in]


def stages(runs: pd.DataFrame) -> Figure:
    """Draw the mean seconds of a run by stage, with one bar per strategy and one panel per level."""
    means = seconds_by_stage(runs)
    levels = list(means.index.unique("level"))
    strategies = list(runs["strategy"].cat.categories)
    size = (WIDTH * len(levels) + 1.5, ROW * len(strategies) + 2 * MARGIN)
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(1, len(levels), squeeze=False, sharey=True)[0]
    for axes, level in zip(panels, levels, strict=True):
        _bars(axes, means.loc[level].reindex(strategies))
        axes.set(title=level, xlabel="seconds a run")
    handles, labels = panels[0].get_legend_handles_labels()
    names = [label.replace("_", " ") for label in labels]
    figure.legend(handles, names, loc="outside lower center", ncols=min(3 * len(levels), len(names)), frameon=False)
    return figure


def _bars(axes: Axes, means: pd.DataFrame) -> None:
    left = np.zeros(len(means))
    for number, stage in enumerate(map(str, means)):
        width = means[stage].fillna(0.0).to_numpy(np.float64)
        color = STAGES.get(stage, f"C{number}")
        axes.barh(list(means.index), width, left=left, height=0.7, color=color, label=stage)
        left += width
    axes.set_ylim(len(means) - 0.5, -0.5)
    axes.tick_params(axis="y", length=0)
    axes.set_xlim(left=0)


def seconds_by_stage(runs: pd.DataFrame) -> pd.DataFrame:
    """Mean seconds of the runs of each level and strategy (index) in each stage (columns)."""
    seconds = pd.DataFrame(runs["stages"].tolist(), index=runs.index).fillna(0.0)
    named = [*(stage for stage in STAGES if stage in seconds), *sorted(set(map(str, seconds)) - set(STAGES))]
    return seconds[named].groupby([runs["level"], runs["strategy"]], observed=True).mean()


def depths(runs: pd.DataFrame) -> Figure:
    """Draw the mean low-level steps of a run by starting depth, with one row per strategy and one panel per level.

    Darker cells have a larger share of the strategy's steps. Runs without recorded depths are left out.
    """
    known = runs[runs["depths"].map(len) > 0]
    levels = list(known["level"].unique())
    means = {level: steps_by_depth(known[known["level"] == level]) for level in levels}
    columns = max(map(len, (mean.columns for mean in means.values())))
    rows = [len(mean) for mean in means.values()]
    size = (2.2 + 0.48 * columns, ROW * sum(rows) + 0.55 * len(rows) + 0.4)
    figure = Figure(figsize=size, layout="constrained")
    panels = figure.subplots(len(levels), 1, squeeze=False, sharex=True, height_ratios=rows)[:, 0]
    for axes, (level, mean) in zip(panels, means.items(), strict=True):
        _heat(axes, mean, columns)
        axes.set_title(level, loc="left")
    panels[-1].set_xlabel("depth of the node that a step starts from")
    return figure


def _heat(axes: Axes, means: pd.DataFrame, columns: int) -> None:
    values: FloatArray = means.to_numpy(np.float64)
    share = values / values.sum(axis=1, keepdims=True)
    darkest = max(0.3, share.max())
    axes.imshow(share, cmap="Blues", vmin=0, vmax=darkest, aspect="auto")
    for (row, column), value in np.ndenumerate(values):
        color = "white" if share[row, column] > 0.55 * darkest else LABEL
        axes.text(column, row, f"{value:.1f}" if value else "", ha="center", va="center", color=color, fontsize=8)
    axes.set_yticks(range(len(means)), list(means.index))
    axes.set_xticks(range(columns))
    axes.set_xlim(-0.5, columns - 0.5)
    axes.tick_params(length=0)
    axes.spines[:].set_visible(False)


def steps_by_depth(runs: pd.DataFrame) -> pd.DataFrame:
    """Mean low-level steps per run of each strategy (index) by depth (columns)."""
    counts = pd.DataFrame([dict(enumerate(depths)) for depths in runs["depths"]], index=runs.index).fillna(0)
    return counts.groupby(runs["strategy"], observed=True).mean()
