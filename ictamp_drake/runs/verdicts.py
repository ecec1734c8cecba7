"""Comparisons in words and as a table: what is shown, and what is not."""

import math
from collections.abc import Sequence

from ictamp_drake.learning.accuracy import Interval
from ictamp_drake.runs.comparison import LEAST, Comparison
from ictamp_drake.runs.markdown import table

SIGNIFICANT = 0.05

NOT_SHOWN = "no difference shown"

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
    "time ratio (95 %)",
    "time",
    "steps ratio (95 %)",
    "steps",
)


def sentences(comparisons: Sequence[Comparison], p: Sequence[float]) -> list[str]:
    """A sentence a comparison; `p` are the probabilities as `comparison.adjusted` has them."""
    return [_sentence(each, adjusted) for each, adjusted in zip(comparisons, p, strict=True)]


def rows(comparisons: Sequence[Comparison], p: Sequence[float]) -> list[str]:
    """The lines of a table in Markdown with everything that the sentences rest on."""
    return table(HEADINGS, [_cells(each, adjusted) for each, adjusted in zip(comparisons, p, strict=True)], left=2)


def verdict(interval: Interval | None, less: str, more: str) -> str:
    """What a ratio and its interval show."""
    if interval is None:
        return "no problem in common"
    if math.isnan(interval.low):
        return f"fewer than {LEAST} problems"
    return less if interval.high < 1 else more if interval.low > 1 else NOT_SHOWN


def _sentence(comparison: Comparison, p: float) -> str:
    """E.g. "easy: **A is faster than B.** It solves as many (37 and 37 of 37; p = 1) and takes ..."."""
    this, other = f"`{comparison.strategy}`", f"`{comparison.reference}`"
    if not comparison.pairs:
        return f"{comparison.level}: {this} and {other} have no run in common."
    found = _differences(comparison, p)
    headline = f"{this} {', '.join(found)} than {other}" if found else f"{NOT_SHOWN} between {this} and {other}"
    return f"{comparison.level}: **{headline}.** {_solved(comparison, p)}{_ratios(comparison)}."


def _differences(comparison: Comparison, p: float) -> list[str]:
    won, lost = comparison.only
    solved = [f"solves {'more' if won > lost else 'fewer'}"] if p < SIGNIFICANT else []
    time = verdict(comparison.time, "is faster", "is slower")
    steps = verdict(comparison.steps, "needs fewer steps", "needs more steps")
    return [*solved, *(each for each in (time, steps) if each.startswith(("is", "needs")))]


def _solved(comparison: Comparison, p: float) -> str:
    this, other = comparison.solved
    more = f"{abs(this - other)} {'more' if this > other else 'fewer'}" if this != other else "as many"
    raised = f", {probability(p)} by Holm" if comparison.p < SIGNIFICANT else ""
    test = f"p = {probability(comparison.p)}".replace("= <", "<")
    return f"It solves {more} ({this} and {other} of {comparison.pairs}; {test}{raised})"


def _ratios(comparison: Comparison) -> str:
    if comparison.time is None:
        return ", and no problem is solved by both"
    ratios = f"{_ratio(comparison.time)} of the time"
    ratios += "" if comparison.steps is None else f" and {_ratio(comparison.steps)} of the steps"
    problems = f"{comparison.both} problem{'s' if comparison.both > 1 else ''}"
    return f"; on the {problems} that both solve it takes {ratios}"


def _cells(comparison: Comparison, p: float) -> list[str]:
    time = verdict(comparison.time, "faster", "slower")
    steps = verdict(comparison.steps, "fewer", "more")
    return [
        comparison.level,
        comparison.strategy,
        str(comparison.pairs),
        "{} and {}".format(*comparison.solved),
        *map(str, comparison.only),
        probability(comparison.p),
        probability(p),
        str(comparison.both),
        _ratio(comparison.time),
        time,
        _ratio(comparison.steps),
        steps,
    ]


def probability(p: float) -> str:
    """Two digits, and no more than a bound for what is very small."""
    return "< 0.0001" if p < 0.0001 else f"{p:.2g}"


def _ratio(interval: Interval | None) -> str:
    if interval is None:
        return "-"
    bounds = "" if math.isnan(interval.low) else f" ({interval.low:.2f} to {interval.high:.2f})"
    return f"{interval.value:.2f}{bounds}"
