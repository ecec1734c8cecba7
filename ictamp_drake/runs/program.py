"""The frame of every program: command line, run, report, exit code."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from rich.console import Console

from ictamp_drake.runs.command import BROKEN, COMPLETE, INTERRUPTED, command
from ictamp_drake.runs.folder import RESULTS, opened
from ictamp_drake.runs.options import Conduct, Method
from ictamp_drake.runs.progress import Progress, counted
from ictamp_drake.runs.records import Record, read_records
from ictamp_drake.runs.sweep import sweep
from ictamp_drake.runs.table import report
from ictamp_drake.runs.worker import Bench, Problem

T = TypeVar("T")


@dataclass(frozen=True)
class Work:
    """What a program is to do.

    Attributes:
        name: of the run's folder.
        about: what the problems are, for config.yaml.
        problems: to be solved.
        method: how.
        conduct: how the run is carried out.
    """

    name: str
    about: dict[str, Any]
    problems: Sequence[Problem]
    method: Method
    conduct: Conduct


def main(name: str, options: type[T], work: Callable[[T], Work], arguments: Sequence[str] | None = None) -> int:
    """Run a program and return its exit code.

    Args:
        name: of its module.
        options: dataclass that its command line is derived from.
        work: what is to be done with these options.
        arguments: command line, that of the process by default.
    """
    interrupted = "Interrupted at once; what was finished before is kept."
    return command(name, options, lambda chosen, console: run(work(chosen), console), interrupted, arguments)


def run(work: Work, console: Console) -> int:
    """Solve what is not solved yet, show the results of all; returns the exit code.

    Raises:
        IctampError: see `folder.opened` and `Method.check`.
    """
    work.method.check()
    with opened(work.name, work.about, work.method, work.conduct) as folder:
        records = _records(work, folder)
        todo = [
            problem for problem in work.problems if not (problem.name in records and records[problem.name].is_final)
        ]
        done = len(work.problems) - len(todo)
        console.print(f"{folder}: {counted(len(todo), 'problem')} to solve, {done} done before", soft_wrap=True)
        complete = not todo or _sweep(work, folder, todo, console)
        records = _records(work, folder)
        console.print(report(list(records.values())))
        _print_where(console, work, folder, records, complete)
    if not complete:
        return INTERRUPTED
    return BROKEN if any(record.error is not None for record in records.values()) else COMPLETE


def _records(work: Work, folder: Path) -> dict[str, Record]:
    """What is known of the problems, in their order."""
    records = read_records(folder / RESULTS)
    return {problem.name: records[problem.name] for problem in work.problems if problem.name in records}


def _sweep(work: Work, folder: Path, todo: Sequence[Problem], console: Console) -> bool:
    conduct = work.conduct
    bench = Bench(folder, work.method, conduct.artefacts, conduct.meshcat)
    earlier = _records(work, folder).values()
    solved = sum(record.solved for record in earlier if record.is_final)
    with Progress(console, [problem.name for problem in todo], len(work.problems), solved) as progress:
        return sweep(todo, bench, conduct.workers, conduct.grace, progress)


def _print_where(console: Console, work: Work, folder: Path, records: Mapping[str, Record], complete: bool) -> None:
    lines = [f"\nRecords: {folder / RESULTS}"]
    solved = [name for name, record in records.items() if record.solved]
    if solved and work.conduct.artefacts == "all":
        lines.append(f"Replays: {folder / (solved[0] if len(solved) == 1 else '*') / 'replay.html'}")
    if not complete:
        lines.append(f"Interrupted; the same command with --out {folder} goes on.")
    console.print("\n".join(lines), soft_wrap=True)
