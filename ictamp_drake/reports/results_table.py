"""The paper's Table 1 for our runs and for the paper's own, in Markdown, LaTeX and CSV."""

import dataclasses
import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import groupby

import pandas as pd
from scipy.special import ndtri

from ictamp_drake.reports.accuracy import LEVEL, Interval
from ictamp_drake.reports.markdown import drop_empty_columns, table
from ictamp_drake.reports.published import TABLE_1

HEADINGS = (
    "level",
    "strategy",
    "solved",
    "share (95 %)",
    "mean time [s]",
    "median time [s]",
    "mean time, all [s]",
    "plans",
    "steps",
    "median steps",
    "duration [s]",
)

PUBLISHED = "published"
"""Source of the paper's own rows."""


@dataclass(frozen=True)
class ResultRow:
    """A strategy on a level. Means and medians are over the solved runs, and nan when there are none.

    Attributes:
        source: Name of the regime, or `PUBLISHED`.
        level, strategy: Names of the level and the strategy.
        runs: Number of runs; a problem with one seed is one run.
        problems: Number of different problems.
        solved: Number of solved runs.
        share: Share of solved runs, see `wilson`.
        mean_s, median_s: Mean and median time [s].
        all_mean_s: Mean time of all runs; an unsolved run counts with the time limit if that is known [s].
        plans: Mean number of high-level plans.
        steps, median_steps: Mean and median number of low-level steps.
        duration_s: Mean time that the arm needs for a plan [s]; also nan when it is not known for each plan.
    """

    source: str
    level: str
    strategy: str
    runs: int
    problems: int
    solved: int
    share: Interval
    mean_s: float = math.nan
    median_s: float = math.nan
    all_mean_s: float = math.nan
    plans: float = math.nan
    steps: float = math.nan
    median_steps: float = math.nan
    duration_s: float = math.nan


def table_1(source: str, runs: pd.DataFrame) -> list[ResultRow]:
    """Compute one row for each level and each strategy that ran there.

    Args:
        source: Name of the regime.
        runs: Table of the runs, see `regime.tabulate_runs`.
    """
    groups = runs.groupby(["level", "strategy"], observed=True)
    return [_row(source, str(level), str(strategy), group) for (level, strategy), group in groups]


def _row(source: str, level: str, strategy: str, runs: pd.DataFrame) -> ResultRow:
    solved = runs[runs["solved"]]
    problems = runs["problem"].nunique()
    return ResultRow(
        source=source,
        level=level,
        strategy=strategy,
        runs=len(runs),
        problems=problems,
        solved=len(solved),
        share=wilson(len(solved) / len(runs), problems),
        mean_s=solved["seconds"].mean(),
        median_s=solved["seconds"].median(),
        all_mean_s=runs["counted"].mean(),
        plans=solved["plans"].mean(),
        steps=solved["steps"].mean(),
        median_steps=solved["steps"].median(),
        duration_s=solved["duration"].mean(skipna=False),
    )


def published_rows() -> list[ResultRow]:
    """Rows of the paper's Table 1, with our intervals."""
    return [
        ResultRow(
            source=PUBLISHED,
            level=row.level,
            strategy=row.strategy,
            runs=row.problems,
            problems=row.problems,
            solved=row.solved,
            share=wilson(row.solved / row.problems, row.problems),
            **{
                name: math.nan if value is None else value
                for name, value in (("mean_s", row.seconds), ("plans", row.plans), ("steps", row.steps))
            },
        )
        for row in TABLE_1
    ]


def wilson(share: float, problems: int) -> Interval:
    """Share with Wilson's interval of 95 %.

    Args:
        share: Share of the runs.
        problems: Number of problems that were run. Seeds of one problem are not independent, so further seeds do not
            narrow the interval; it is then too wide rather than too narrow.
    """
    z = float(ndtri((1 + LEVEL) / 2))
    scale = 1 + z**2 / problems
    centre = (share + z**2 / (2 * problems)) / scale
    half = z * math.sqrt(share * (1 - share) / problems + z**2 / (4 * problems**2)) / scale
    return Interval(share, max(0.0, centre - half), min(1.0, centre + half))


def format_number(value: float, digits: int = 1) -> str:
    """Format a number with this many digits after the point, or "-" for nan."""
    return "-" if math.isnan(value) else f"{value:.{digits}f}"


def cells(row: ResultRow) -> list[str]:
    """Format the cells below `HEADINGS`."""
    times = map(format_number, (row.mean_s, row.median_s, row.all_mean_s))
    steps = map(format_number, (row.steps, row.median_steps, row.duration_s))
    share = f"{row.share.value:.0%} ({row.share.low:.0%} to {row.share.high:.0%})".replace("%", " %")
    return [row.level, row.strategy, f"{row.solved} of {row.runs}", share, *times, format_number(row.plans, 2), *steps]


def markdown(rows: Sequence[ResultRow]) -> list[str]:
    """Format the lines of a table in Markdown, without empty columns."""
    return table(*drop_empty_columns(HEADINGS, list(map(cells, rows))), left=2)


def latex(rows: Sequence[ResultRow]) -> str:
    """Format a LaTeX tabular for the package booktabs, with a rule between levels and a heading for each source."""
    headings, body = drop_empty_columns(HEADINGS, list(map(cells, rows)))
    lines = [rf"\begin{{tabular}}{{ll{'r' * (len(headings) - 2)}}}", r"\toprule", _line(headings)]
    for source, part in groupby(zip(rows, body, strict=True), key=lambda pair: pair[0].source):
        lines += [r"\midrule", rf"\multicolumn{{{len(headings)}}}{{l}}{{\emph{{{_escape_latex(source)}}}}} \\"]
        for level, group in groupby(part, key=lambda pair: pair[0].level):
            lines.append(r"\midrule")
            for number, (_, values) in enumerate(group):
                lines.append(_line([level if number == 0 else "", *values[1:]]))
    return "\n".join([*lines, r"\bottomrule", r"\end{tabular}", ""])


def as_csv(rows: Sequence[ResultRow]) -> str:
    """Format all figures as CSV, with six significant digits."""
    bounds = ({"share_low": row.share.low, "share_high": row.share.high} for row in rows)
    values = [
        dataclasses.asdict(row) | {"share": row.share.value} | more for row, more in zip(rows, bounds, strict=True)
    ]
    return pd.DataFrame(values).to_csv(index=False, float_format="%.6g", lineterminator="\n")


def _line(values: Sequence[str]) -> str:
    return " & ".join(map(_escape_latex, values)) + r" \\"


def _escape_latex(text: str) -> str:
    """Escape the characters that LaTeX treats as commands."""
    words = {"\\": r"\textbackslash{}", "~": r"\textasciitilde{}", "^": r"\textasciicircum{}"}
    return "".join(words.get(each, rf"\{each}" if each in "&%$#_{}" else each) for each in text)
