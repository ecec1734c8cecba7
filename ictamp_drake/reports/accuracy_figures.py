"""Pictures of the accuracy of success estimates against counted success (paper, Figure 3)."""

from collections.abc import Callable, Sequence
from pathlib import Path

import numpy as np
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.ticker import PercentFormatter

from ictamp_drake.core.types import FloatArray
from ictamp_drake.learning.metrics import bins
from ictamp_drake.reports.accuracy import Accuracy, advantage, resample_scenes
from ictamp_drake.viz.figures import GRID, LABEL, write_figures

CLOSER, FARTHER, OTHERS = "#1f6fb4", "#d1652b", ("#444444", "#7b4ea3", "#b08d00", "#3b8f6b", "#c0508c", "#8a8a8a")
WIDTH, HEIGHT = 4.6, 3.6  # size of a panel [in]
NARROW = 2.9  # side of a panel of a reliability diagram [in]
SHARE_BINS = 20


def draw_all(accuracies: Sequence[Accuracy], folder: Path) -> list[str]:
    """Write all pictures to a folder and return their names."""
    pictures: dict[str, Callable[[], Figure]] = {
        "figure_3.png": lambda: figure_3(accuracies),
        **{f"reliability_{each.skill}.png": lambda each=each: reliability(each) for each in accuracies},  # type: ignore[misc]
        "ground_truth.png": lambda: ground_truth(accuracies),
    }
    return write_figures(pictures, folder)


def figure_3(accuracies: Sequence[Accuracy]) -> Figure:
    """Draw |GT - P| - |GT - Q| of every case in ascending order, one panel per skill.

    One rival Q is shown by bars, all others by lines.
    """
    figure, panels = _panels(accuracies)
    for axes, accuracy in zip(panels, accuracies, strict=True):
        first, rival, *others = accuracy.estimates
        values, places = _sort_cases(accuracy, rival), np.arange(len(accuracy.counts)) + 0.5
        axes.bar(places, values, width=1.0, color=np.where(values < 0, CLOSER, FARTHER), label=rival)
        for name, color in zip(others, OTHERS, strict=False):
            axes.plot(places, _sort_cases(accuracy, name), color=color, lw=1.2, label=name)
        axes.axhline(0, color=LABEL, lw=0.8)
        axes.set_title(_verdict(accuracy), fontsize=10)
        axes.set(xlabel="cases in ascending order", ylabel=f"|GT - {first}| - |GT - Q|")
        axes.set(xlim=(0, len(values)), ylim=(-1, 1))
        axes.text(0.98, 0.03, f"below 0: {first} is closer", transform=axes.transAxes, ha="right", color=CLOSER)
        axes.text(0.98, 0.95, "above 0: Q is closer", transform=axes.transAxes, ha="right", color=FARTHER)
        *lines, bars = axes.get_legend_handles_labels()[0]  # bars come last there
        axes.legend(handles=[bars, *lines], loc="upper left", frameon=False, title="in place of Q", alignment="left")
    return figure


def _verdict(accuracy: Accuracy) -> str:
    first, rival, *_ = accuracy.estimates
    closer = accuracy.figures[rival]["closer"]
    share = f"{closer.value:.0%} ({closer.low:.0%} to {closer.high:.0%})"
    return f"{accuracy.skill}: {first} closer than {rival}\nin {share} of {len(accuracy.counts)} cases"


def reliability(accuracy: Accuracy) -> Figure:
    """Draw the success rate of cases with similar estimates, with intervals over scenes, one panel per estimator.

    Bars at the bottom are shares of the executions.
    """
    names = list(accuracy.estimates)
    columns = 3
    rows = -(-len(names) // columns)
    figure = Figure(figsize=(columns * NARROW, rows * NARROW + 0.5), layout="constrained")
    executions = f"{accuracy.counts.attempts.sum():.0f} executions in {len(accuracy.counts)} cases"
    figure.suptitle(f"{accuracy.skill}: how often what was estimated came true, {executions}", fontsize=11)
    grid = figure.subplots(rows, columns, squeeze=False, sharex=True, sharey=True)
    for axes, name in zip(grid.flat, names, strict=False):
        _reliability(axes, accuracy, name)
    for axes in grid.flat[len(names) :]:
        axes.set_axis_off()
    figure.supxlabel("estimate", fontsize=9)
    figure.supylabel("share of successes (points), share of executions (bars)", fontsize=9)
    return figure


def _reliability(axes: Axes, accuracy: Accuracy, name: str) -> None:
    P, counts = accuracy.estimates[name], accuracy.counts
    first = next(iter(accuracy.estimates))
    color = CLOSER if name == first else FARTHER if name.startswith("Q") else OTHERS[0]
    heights, edges = np.histogram(P, bins=SHARE_BINS, range=(0, 1), weights=counts.attempts / counts.attempts.sum())
    axes.stairs(heights, edges, fill=True, color=color, alpha=0.25)
    axes.plot([0, 1], [0, 1], color=LABEL, lw=0.8, ls=(0, (4, 3)))
    estimate, share, below, above = _bin_cases(accuracy, P)
    axes.errorbar(estimate, share, yerr=(below, above), color=color, fmt="o", ms=4, lw=1.0, capsize=0)
    ece = accuracy.figures[name]["ece"]
    axes.set_title(f"{name}: ECE {ece.value:.2f} ({ece.low:.2f} to {ece.high:.2f})", fontsize=9)
    axes.set(xlim=(-0.02, 1.02), ylim=(-0.02, 1.02), aspect="equal")
    axes.grid(color=GRID, lw=0.5)


def _bin_cases(accuracy: Accuracy, P: FloatArray) -> tuple[FloatArray, FloatArray, FloatArray, FloatArray]:
    """Mean estimate and share of successes in each bin, and the distances from the share to its bounds."""
    counts = accuracy.counts
    place = bins(P, counts.attempts)
    weight = resample_scenes(counts)
    points = []
    for number in np.unique(place):
        inside = place == number
        attempts, successes = counts.attempts[inside], counts.successes[inside]
        sampled = weight[:, inside] @ attempts
        shares = (weight[:, inside] @ successes)[sampled > 0] / sampled[sampled > 0]
        share = successes.sum() / attempts.sum()
        low, high = np.quantile(shares, [0.025, 0.975])
        points.append((np.average(P[inside], weights=attempts), share, max(0, share - low), max(0, high - share)))
    estimate, share, below, above = np.array(points).T
    return estimate, share, below, above


def ground_truth(accuracies: Sequence[Accuracy]) -> Figure:
    """Draw histograms of the share of successes over all cases, one panel per skill."""
    figure, panels = _panels(accuracies)
    for axes, accuracy in zip(panels, accuracies, strict=True):
        axes.hist(accuracy.counts.share, bins=SHARE_BINS, range=(0, 1), color=CLOSER, edgecolor="white")
        executions = np.median(accuracy.counts.attempts)
        axes.set_title(f"{accuracy.skill}: {len(accuracy.counts)} cases of {executions:.0f} executions", fontsize=10)
        axes.set(xlabel="GT, share of successes", ylabel="cases", xlim=(0, 1))
        axes.xaxis.set_major_formatter(PercentFormatter(1.0))
    return figure


def _panels(accuracies: Sequence[Accuracy]) -> tuple[Figure, list[Axes]]:
    figure = Figure(figsize=(WIDTH * len(accuracies), HEIGHT), layout="constrained")
    panels = figure.subplots(1, len(accuracies), squeeze=False)[0]
    return figure, list(panels)


def _sort_cases(accuracy: Accuracy, rival: str) -> FloatArray:
    first = next(iter(accuracy.estimates.values()))
    return np.sort(advantage(accuracy.counts, first, accuracy.estimates[rival]))
