"""Comparisons, summed up and as a table: what is shown, and what is not."""

import math
from collections import defaultdict
from collections.abc import Sequence

from ictamp_drake.reports.accuracy import Interval
from ictamp_drake.reports.comparison import LEAST, Comparison
from ictamp_drake.reports.markdown import drop_empty_columns, table

SIGNIFICANT = 0.05

NOT_SHOWN = "no difference shown"

TIME, STEPS = ("faster", "slower"), ("fewer steps", "more steps")
"""What less and more of each is called."""

TITLES: dict[frozenset[int] | None, str] = {
    frozenset({1}): "Better than `{}`",
    frozenset({-1}): "Worse than `{}`",
    frozenset({1, -1}): "Better than `{}` in one figure and worse in another",
    frozenset(): "No difference to `{}` shown",
    None: "No run in common with `{}`",
}
"""Of groups of comparisons by the signs of what is shown, see `_signs`; None where there is nothing to compare."""

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
    """What is and is not shown, as lines in Markdown: strategies in groups, with the levels where it is so.

    Args:
        comparisons: with the same reference.
        p: their probabilities as `comparison.adjust_for_multiplicity` has them.
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
    """The lines of a table in Markdown with everything that the summary rests on."""
    return table(*drop_empty_columns(HEADINGS, [_cells(*each) for each in zip(comparisons, p, strict=True)]), left=2)


def verdict(interval: Interval | None, less: str, more: str) -> str:
    """What a ratio and its interval show."""
    if interval is None:
        return "no problem in common"
    if math.isnan(interval.low):
        return f"fewer than {LEAST} problems"
    return less if interval.high < 1 else more if interval.low > 1 else NOT_SHOWN


def _signs(comparison: Comparison, p: float) -> list[tuple[int, str]]:
    """Every difference that is shown: 1 where the strategy is better and -1 where it is worse, and the figures."""
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
    """Two digits, and no more than a bound for what is very small."""
    return "< 0.0001" if p < 0.0001 else f"{p:.2g}"


def format_ratio(interval: Interval | None) -> str:
    """With its interval, "-" for none."""
    if interval is None:
        return "-"
    bounds = "" if math.isnan(interval.low) else f" ({interval.low:.2f} to {interval.high:.2f})"
    return f"{interval.value:.2f}{bounds}"
