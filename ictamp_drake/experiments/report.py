"""Tables, figures and a page of results from runs of several strategies (paper, Experiments: Table 1, Figures 1 to 3).

`python -m ictamp_drake.experiments.report --runs benchmarks/results/paper benchmarks/results/default`
"""

import os
import shlex
import sys
from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

from matplotlib.figure import Figure
from rich.console import Console

from ictamp_drake.core.checks import check_choice, check_different
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.files import make_folder, read_json, write_whole
from ictamp_drake.reports import results_table
from ictamp_drake.reports.pace import scale_to_equal_pace
from ictamp_drake.reports.regime import Regime, read_regime
from ictamp_drake.reports.results_page import Chapter, page
from ictamp_drake.runs.command import COMPLETE, command
from ictamp_drake.viz.curves import success
from ictamp_drake.viz.effort import depths, stages
from ictamp_drake.viz.figures import write_figures
from ictamp_drake.viz.gallery import examples, gallery
from ictamp_drake.viz.growth import draw_growth
from ictamp_drake.viz.layout import Layout

NAME = "ictamp_drake.experiments.report"


@dataclass(frozen=True)
class Report:
    """Report the results of runs of several strategies, and what they do not show.

    Attributes:
        runs: Folders of runs, one per regime. Each regime is named after its folder.
        out: Folder for tables and figures. The page gets the same name with the suffix .md.
        against: Reference strategy that all others are compared with. By default the first one of the first folder. A
            folder without this strategy uses its own first one.
        search: Record of a search, tree.json. Its growth is drawn if the file exists.
        accuracy: Figure of the estimators' accuracy. The page includes it if the file exists.
    """

    runs: tuple[Path, ...]
    out: Path = Path("docs/results")
    against: str | None = None
    search: Path = Path("benchmarks/results/search/tree.json")
    accuracy: Path = Path("benchmarks/estimator_accuracy/figure_3.png")

    def __post_init__(self) -> None:
        if self.out.name in ("", ".."):
            problem = "expected a folder with a name, which the page takes, e.g. docs/results, got {value}"
            raise IctampError(Code.BAD_NAME, problem, field="out", value=self.out)


def write_report(options: Report, console: Console, typed: str) -> int:
    """Read all runs, write the page with its tables and figures, and return the exit code.

    Raises:
        IctampError: A folder contains no runs or broken ones, two folders have the same name, the reference strategy
            does not exist, the search file is not a record of a search, or the folder for the page is not writable.
    """
    measured, out = _regimes(options.runs), options.out
    against = _choose_reference(options.against, measured)
    regimes = [_scale_to_equal_pace(regime, against) for regime in measured]
    search = _tree(options.search) if options.search.is_file() else None
    make_folder(out)
    chapters = [_chapter(regime, against, out) for regime in regimes]
    write_figures({"figure_2.png": lambda: gallery(examples())}, out)
    rows = [
        row for each in regimes for row in results_table.table_1(each.name, each.runs)
    ] + results_table.published_rows()
    write_whole(out / "table_1.csv", results_table.as_csv(rows))
    write_whole(out / "table_1.tex", results_table.latex(rows))
    files = {"figure_2": f"{out.name}/figure_2.png"}
    files |= {name: f"{out.name}/{name}" for name in ("table_1.csv", "table_1.tex")}
    if search is not None:
        draw_growth(search, out / "figure_1.svg")
        files["figure_1"] = f"{out.name}/figure_1.svg"
    if options.accuracy.is_file():
        files["figure_3"] = os.path.relpath(options.accuracy, out.parent)
    write_whole(out.with_name(f"{out.name}.md"), page(chapters, typed, files))
    console.print(f"{out}.md, with tables and pictures in {out}", soft_wrap=True)
    return COMPLETE


def _chapter(regime: Regime, against: str, out: Path) -> Chapter:
    """Compare the strategies of a regime and write its figures."""
    figures: dict[str, Callable[[], Figure]] = {
        "success": partial(success, regime.runs, regime.time_limit),
        "stages": partial(stages, regime.runs),
    }
    if regime.runs["depths"].map(len).any():
        figures["depths"] = partial(depths, regime.runs)
    write_figures({f"{regime.name}_{what}.png": draw for what, draw in figures.items()}, out)
    pictures = {what: f"{out.name}/{regime.name}_{what}.png" for what in figures}
    return Chapter.create(regime, _reference(regime, against), pictures)


def _scale_to_equal_pace(regime: Regime, against: str) -> Regime:
    return replace(regime, runs=scale_to_equal_pace(regime.runs, _reference(regime, against)))


def _reference(regime: Regime, against: str) -> str:
    return against if against in regime.strategies else regime.strategies[0]


def _tree(path: Path) -> dict[str, Any]:
    tree = read_json(path)
    try:
        Layout(tree)
    except (LookupError, TypeError, ValueError, AttributeError) as error:
        raise IctampError(Code.WRONG_TYPE, f"not the record of a search: {error!r}", file=path) from error
    return tree


def _regimes(folders: Sequence[Path]) -> list[Regime]:
    if not folders:
        raise IctampError(Code.EMPTY, "expected at least one folder", field="runs")
    regimes = [read_regime(folder) for folder in folders]
    names = [regime.name for regime in regimes]
    check_different("runs", names)
    return regimes


def _choose_reference(given: str | None, regimes: Sequence[Regime]) -> str:
    known = list(dict.fromkeys(name for regime in regimes for name in regime.strategies))
    if given is not None:
        check_choice("against", given, known)
    return given or known[0]


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the program and return its exit code."""
    given = sys.argv[1:] if arguments is None else list(arguments)
    typed = shlex.join(["python", "-m", NAME, *given])
    return command(NAME, Report, lambda options, console: write_report(options, console, typed), "Interrupted.", given)


if __name__ == "__main__":
    sys.exit(main())
