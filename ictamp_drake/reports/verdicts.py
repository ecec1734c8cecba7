"""Summary and table of comparisons: which differences are significant and which are not."""

import math
from collections import defaultdict
from collections.abc import Sequence

from ictamp_drake.reports.accuracy import Interval
from ictamp_drake.reports.comparison import LEAST, Comparison
from ictamp_drake.reports.markdown import drop_empty_columns, table

SIGNIFICANT = 0.05

NOT_SHOWN = "no difference shown"

TIME, STEPS = ("faster", "slower"), ("fewer steps", "more steps")
"""Words for less and for more of each."""

TITLES: dict[frozenset[int] | None, str] = {
    frozenset({1}): "Better than `{}`",
    frozenset({-1}): "Worse than `{}`",
    frozenset({1, -1}): "Better than `{}` in one measure, worse in another",
    frozenset(): "No difference from `{}` shown",
    None: "No runs in common with `{}`",
}
"""Titles of groups of comparisons by the signs of their differences, see `_signs`; None for no runs to compare."""

HEADINGS = (
    "level",
    "strategy",
    "pairs",
    "solved",
    "only it",
    "only the reference",
    "p",
    "p (Holm)",
    "problems both solved",
    "pace ratio (95 %)",
    "time ratio (95 %)",
    "time",
    "steps ratio (95 %)",
    "steps",
)


def summary(comparisons: Sequence[Comparison], p: Sequence[float]) -> list[str]:
    """Summarize what is and is not significant, as lines in Markdown: groups of strategies, each with its levels.

    Args:
        comparisons: Comparisons with the same reference.
        p: Probabilities of the comparisons, adjusted by `comparison.adjust_for_multiplicity`.
    """
    groups = {signs: defaultdict[str, list[str]](list) for signs in TITLES}
    for each, adjusted in zip(comparisons, p, strict=True):
        shown = _signs(each, adjusted)
        signs = frozenset(sign for sign, _ in shown) if each.pairs else None
        figures = f" ({', '.join(text for _, text in shown)})" if shown else ""
        groups[signs][each.strategy].append(each.level + figures)
    parts = [
        [f"**{TITLES[signs].format(comparisons[0].reference)}**", ""]
        + [f"- `{name}`: {'; '.join(levels)}" for name, levels in strategies.items()]
        for signs, strategies in groups.items()
        if strategies
    ]
    return [line for part in parts for line in ("", *part)][1:]


def rows(comparisons: Sequence[Comparison], p: Sequence[float]) -> list[str]:
    """Format a table in Markdown with all figures behind the summary."""
    return table(*drop_empty_columns(HEADINGS, [_cells(*each) for each in zip(comparisons, p, strict=True)]), left=2)


def verdict(interval: Interval | None, less: str, more: str) -> str:
    """Put into words what a ratio and its interval show."""
    if interval is None:
        return "no problem in common"
    if math.isnan(interval.low):
        return f"fewer than {LEAST} problems"
    return less if interval.high < 1 else more if interval.low > 1 else NOT_SHOWN


def _signs(comparison: Comparison, p: float) -> list[tuple[int, str]]:
    """Every significant difference: 1 where the strategy is better and -1 where it is worse, with the figures."""
    shown = []
    if p < SIGNIFICANT:
        sign = 1 if comparison.only[0] > comparison.only[1] else -1
        this, other = comparison.solved
        solves = f"solves {'more' if sign > 0 else 'fewer'}, {this} against {other} of {comparison.pairs}"
        shown.append((sign, f"{solves}, p = {probability(p)}".replace("= <", "<")))
    time, steps = verdict(comparison.time, *TIME), verdict(comparison.steps, *STEPS)
    if time in TIME:
        shown.append((1 if time == TIME[0] else -1, f"{format_ratio(comparison.time)} of the time"))
    if steps in STEPS:
        shown.append((1 if steps == STEPS[0] else -1, f"{format_ratio(comparison.steps)} of the steps"))
    return shown


def _cells(comparison: Comparison, p: float) -> list[str]:
    return [
        comparison.level,
        comparison.strategy,
        str(comparison.pairs),
        "{} and {}".format(*comparison.solved),
        *map(str, comparison.only),
        probability(comparison.p),
        probability(p),
        str(comparison.both),
        format_ratio(comparison.pace),
        format_ratio(comparison.time),
        verdict(comparison.time, *TIME),
        format_ratio(comparison.steps),
        verdict(comparison.steps, *STEPS),
    ]


def probability(p: float) -> str:
    """Format a probability with two digits, or as an upper bound when it is very small."""
    return "< 0.0001" if p < 0.0001 else f"{p:.2g}"


def format_ratio(interval: Interval | None) -> str:
    """Format a ratio with its interval, or "-" for None."""
    if interval is None:
        return "-"
    bounds = "" if math.isnan(interval.low) else f" ({interval.low:.2f} to {interval.high:.2f})"
    return f"{interval.value:.2f}{bounds}"
