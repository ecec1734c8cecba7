"""Accuracy of estimators as a table on the screen, as a page in Markdown, and case by case as CSV."""

import csv
import io
from collections.abc import Mapping, Sequence
from typing import Any

from rich import box
from rich.console import Group, RenderableType
from rich.table import Table
from rich.text import Text

from ictamp_drake.learning.cases import halves
from ictamp_drake.reports.accuracy import CEILING, Accuracy, Figures, Interval
from ictamp_drake.reports.markdown import table

COLUMNS = {
    "error": "error",
    "closer": "{first} closer",
    "auc": "AUC",
    "brier": "Brier",
    "brier_skill": "Brier skill",
    "log_loss": "log loss",
    "ece": "ECE",
}
"""Headings of the figures."""

SHORT = ("error", "brier", "log_loss")
"""Figures shown without their interval."""

LEGEND = (
    "error: mean |GT - estimate| over cases, GT being a case's share of successes.",
    "{first} closer: share of the cases in which {first} is closer to GT than this estimator; ties count half.",
    "AUC, Brier score, log loss, ECE: of the estimates against the outcome of every single execution.",
    "Brier skill: 1 - Brier score / that of the share of successes among all executions.",
    "In brackets: 95 % intervals from samples of scenes.",
    f"{CEILING}: what can be reached where outcomes are random, by an oracle that counts one half of the executions of "
    "each case and is tested on the other; its error is how far GT is from the true probability on average.",
)


def format_accuracies(accuracies: Sequence[Accuracy]) -> Group:
    """Format the accuracies for the screen: a table for each skill, and the legend."""
    parts: list[RenderableType] = []
    for accuracy in accuracies:
        shown = Table(box=box.SIMPLE_HEAD, pad_edge=False, padding=(0, 1, 0, 0))
        for number, heading in enumerate(_headings(accuracy)):
            shown.add_column(heading, justify="right" if number else "left", no_wrap=True)
        for row in _rows(accuracy):
            shown.add_row(*row)
        parts += [Text(), Text(_title(accuracy), "bold"), shown]
    return Group(*parts, *(Text(line, "dim") for line in _legend(accuracies[0])))


def markdown(accuracies: Sequence[Accuracy], about: Mapping[str, Any], pictures: Sequence[str]) -> str:
    """Format the accuracies as a page in Markdown, with the pictures beside it and facts about its origin."""
    lines = ["# Accuracy of the estimators of success", ""]
    for accuracy in accuracies:
        lines += [f"## {_title(accuracy)}", "", *table(_headings(accuracy), _rows(accuracy)), ""]
    lines += [*(f"- {line}" for line in _legend(accuracies[0])), ""]
    for picture in pictures:
        lines += [f"![{picture.partition('.')[0].replace('_', ' ')}]({picture})", ""]
    return "\n".join([*lines, "## Made by", "", *(f"- {key}: `{value}`" for key, value in about.items()), ""])


def _title(accuracy: Accuracy) -> str:
    counts = accuracy.counts
    scenes = len(set(counts.scene.tolist()))
    rate = counts.successes.sum() / counts.attempts.sum()
    return (
        f"{accuracy.skill}: {len(counts)} cases in {scenes} scenes, {counts.attempts.sum():.0f} executions, "
        f"{rate:.0%} of them succeeded"
    )


def _headings(accuracy: Accuracy) -> list[str]:
    return ["estimator", *(heading.format(first=_first(accuracy)) for heading in COLUMNS.values())]


def _legend(accuracy: Accuracy) -> list[str]:
    return [line.format(first=_first(accuracy)) for line in LEGEND]


def _first(accuracy: Accuracy) -> str:
    return next(iter(accuracy.estimates))


def _rows(accuracy: Accuracy) -> list[list[str]]:
    return [[name, *(cell(figures, key) for key in COLUMNS)] for name, figures in accuracy.figures.items()]


def cell(figures: Figures, key: str) -> str:
    """Format a figure, e.g. "0.71 (0.64, 0.78)", or return "" when the estimator does not have it."""
    if key not in figures:
        return ""
    figure: Interval = figures[key]
    return f"{figure.value:.3f}" if key in SHORT else f"{figure.value:z.2f} ({figure.low:z.2f}, {figure.high:z.2f})"


def as_csv(accuracies: Sequence[Accuracy]) -> str:
    """Format one row per case: the case, its successes in all draws and in every second draw, and all estimates."""
    names = list(accuracies[0].estimates)
    file = io.StringIO()
    writer = csv.writer(file, lineterminator="\n")
    header = ["scene", "state", "action", "box", "place", "attempts", "successes", "GT"]
    writer.writerow([*header, "half_attempts", "half_successes", *names])
    for accuracy in accuracies:
        _, half = halves(accuracy.cases)
        counts = accuracy.counts
        for number, case in enumerate(accuracy.cases):
            tried = [counts.attempts[number], counts.successes[number], half.attempts[number], half.successes[number]]
            attempts, successes, *second = map(int, tried)
            where = [case.scene, case.state, case.action.name, *case.action.args]
            estimates = [f"{accuracy.estimates[name][number]:.6f}" for name in names]
            writer.writerow([*where, attempts, successes, f"{counts.share[number]:.6f}", *second, *estimates])
    return file.getvalue()
