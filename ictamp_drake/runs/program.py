"""The frame of every program: command line, run, report, exit code."""

import time
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any, TypeVar

from rich.console import Console

from ictamp_drake.robots.spec import DEFAULT
from ictamp_drake.runs.board import Board
from ictamp_drake.runs.command import BROKEN, COMPLETE, INTERRUPTED, UNSOLVED, command
from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.folder import RESULTS, open_run_folder
from ictamp_drake.runs.index import Index
from ictamp_drake.runs.jobs import Job
from ictamp_drake.runs.progress import Progress, format_clock, format_count
from ictamp_drake.runs.records import Record, read_records
from ictamp_drake.runs.table import format_results
from ictamp_drake.scenes.spec import locate_robot

T = TypeVar("T")


@dataclass(frozen=True)
class Work:
    """Work of a program.

    Attributes:
        name: Name of the run's folder.
        about: Problems and how they are solved, for config.yaml; see `folder.open_run_folder`.
        jobs: Jobs to do.
        conduct: Options for carrying out the run.
        robot: Robot that replaces those of the scenes, as given; None if none does.
    """

    name: str
    about: dict[str, Any]
    jobs: Sequence[Job]
    conduct: Conduct
    robot: str | None = None

    @property
    def single(self) -> bool:
        """Whether there is one problem to solve, rather than methods to compare on it or problems to sweep over."""
        return len(self.jobs) == 1 and not self.jobs[0].strategy


def main(name: str, options: type[T], work: Callable[[T], Work], arguments: Sequence[str] | None = None) -> int:
    """Run a program and return its exit code.

    Args:
        name: Name of the program's module.
        options: Dataclass from which the command line is derived.
        work: Function that turns options into work.
        arguments: Command-line arguments; by default those of the process.
    """
    interrupted = "Interrupted at once; what was finished before is kept."
    return command(name, options, lambda chosen, console: run(work(chosen), console), interrupted, arguments)


def run(work: Work, console: Console) -> int:
    """Do what is not done yet, show the results of all; returns the exit code.

    Raises:
        IctampError: The work cannot begin; see `folder.open_run_folder`, `Method.check`, `Method.suited_to` and
            `EngineConfig.check`.
    """
    work.conduct.engine.check()
    for job in {(job.strategy, job.problem.spec.robot): job for job in work.jobs}.values():
        job.suited.check()
    with open_run_folder(work.name, work.about, work.conduct) as folder:
        records = _records(work, folder)
        todo = [job for job in work.jobs if not (job.name in records and records[job.name].is_final)]
        done = len(work.jobs) - len(todo)
        for note in _notes(work):
            console.print(note, soft_wrap=True)
        console.print(f"{folder}: {format_count(len(todo), 'problem')} to solve, {done} done before", soft_wrap=True)
        index = Index(folder, [job.name for job in work.jobs])
        try:
            complete = not todo or _sweep(work, folder, todo, console, index)
        finally:
            index.write()
        records = _records(work, folder)
        complete = complete or all(job.name in records and records[job.name].is_final for job in work.jobs)
        console.print(format_results(list(records.values())))
        _print_where(console, work, index, records, complete)
    return _exit_code(work, records, complete)


def about_robot(robot: str | None) -> dict[str, str]:
    """Entry of `Work.about` for a robot that replaces those of the scenes; none for the Panda, as in earlier runs."""
    name = DEFAULT if robot is None else locate_robot(robot, Path.cwd())
    return {} if name == DEFAULT else {"robot": name}


def _notes(work: Work) -> list[str]:
    """Sentences about the robot and the parts that serve with it."""
    robot = [f"Robot: {work.robot}, in place of the scene's."] if work.robot is not None else []
    stand_ins = [job.method.tell_stand_ins(job.problem.spec.robot) for job in work.jobs]
    return list(filter(None, dict.fromkeys([*robot, *stand_ins])))


def _exit_code(work: Work, records: Mapping[str, Record], complete: bool) -> int:
    if not complete:
        return INTERRUPTED
    if any(job.name not in records or records[job.name].error is not None for job in work.jobs):
        return BROKEN
    if work.single and not all(record.solved for record in records.values()):
        return UNSOLVED
    return COMPLETE


def _records(work: Work, folder: Path) -> dict[str, Record]:
    """Records of the jobs so far, in the order of the jobs."""
    records = read_records(folder / RESULTS)
    return {job.name: records[job.name] for job in work.jobs if job.name in records}


def _sweep(work: Work, folder: Path, todo: Sequence[Job], console: Console, index: Index) -> bool:
    from ictamp_drake.runs.sweep import sweep  # noqa: PLC0415  (Drake takes long to load, and no help needs it)

    earlier = _records(work, folder).values()
    solved = sum(record.solved for record in earlier if record.is_final)
    start = time.monotonic()
    with Progress(console, [job.name for job in todo], len(work.jobs), solved) as progress:

        def watch(board: Board, new: Sequence[Record]) -> None:
            progress(board, new)
            index.add(new)

        complete = sweep(todo, folder, work.conduct, watch, alone=len(work.jobs) == 1)
    records = _records(work, folder)
    planning = sum(records[job.name].planning_time_s for job in todo if job.name in records)
    console.print(_effort(time.monotonic() - start, planning, work.conduct.engine.count_local_workers(len(todo))))
    return complete


def _effort(seconds: float, planning: float, workers: int) -> str:
    """Duration of a run, and the share of it that went into planning; the rest is harness and artefacts."""
    text = f"{format_clock(seconds)} for {planning:.0f} s of planning"
    if workers:
        text += f", {100 * planning / seconds / workers:.1f} % of the time of {format_count(workers, 'worker')}"
    return text


def _print_where(console: Console, work: Work, index: Index, records: Mapping[str, Record], complete: bool) -> None:
    folder = index.path.parent
    page = f"Page: {index.path}" if index.error is None else f"{index.path} could not be written: {index.error}"
    lines = [f"\nRecords: {folder / RESULTS}", page]
    if work.conduct.artefacts == "all":
        solved = [name for name, record in records.items() if record.solved]
        searched = [name for name, record in records.items() if not record.error]
        for what, names, file in (("Replays", solved, "replay.html"), ("Searches", searched, "search.html")):
            if names:
                lines.append(f"{what}: {folder / _pattern(names) / file}")
    if not complete:
        lines.append(f"Interrupted; the same command with --out {folder} goes on.")
    console.print("\n".join(lines), soft_wrap=True)


def _pattern(names: Sequence[str]) -> str:
    """Pattern of their folders, with one star per part of a name; a single job has its name."""
    return names[0] if len(names) == 1 else "/".join("*" for _ in names[0].split("/"))
