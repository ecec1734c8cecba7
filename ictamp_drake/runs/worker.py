"""What a worker process does: solve one problem after the other. It leaves nothing on the disk."""

import traceback
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import NamedTuple

from ictamp_drake.core.errors import IctampError
from ictamp_drake.planning.events import Listener
from ictamp_drake.runs.artefacts import Artefacts, write_artefacts
from ictamp_drake.runs.board import Board
from ictamp_drake.runs.options import Method
from ictamp_drake.runs.pool import CONTEXT, end_with_parent
from ictamp_drake.runs.records import Record, record_of, run_name
from ictamp_drake.runs.solve import Solution, prepare, solve
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.viz.live import LiveView

CRASHED, HUNG = "CRASHED", "HUNG"
"""Why a problem ended that could not say so itself."""


@dataclass(frozen=True)
class Problem:
    """A scene file to be solved.

    Attributes:
        name: of its record.
        path: of the scene file.
        level: easy, medium, hard, extreme or varied; None for a scene of one's own.
    """

    name: str
    path: Path
    level: str | None = None

    def __post_init__(self) -> None:
        if self.name.startswith("."):  # what is left of it goes to a folder with its name
            raise IctampError(f"{self.path}: the name of a scene is '{self.name}', but must not begin with a dot")


@dataclass(frozen=True)
class Job:
    """A problem and how it is to be solved.

    Attributes:
        problem: the problem.
        method: options and seed.
        strategy: name of the method, empty when there is only one.
    """

    problem: Problem
    method: Method
    strategy: str = ""

    @property
    def name(self) -> str:
        """Of its record and folder."""
        return run_name(self.problem.name, self.strategy, self.method.seed)

    def broken(self, reason: str, seconds: float, error: str) -> Record:
        """The record of a job that did not come to its end."""
        return Record(
            problem=self.problem.name,
            strategy=self.strategy,
            level=self.problem.level,
            seed=self.method.seed,
            stop_reason=reason,
            planning_time_s=round(seconds, 4),
            error=error,
        )


class Finished(NamedTuple):
    """What came of a job.

    Attributes:
        record: of it.
        files: what is kept besides, content by name.
    """

    record: Record
    files: dict[str, bytes]


class _Process:
    """What a worker process keeps between problems."""

    board: Board
    view: LiveView | None = None


def start_worker(board: Board | None, learned: bool, meshcat: bool) -> None:
    """Make a process ready: loads what would be loaded in the midst of the first problem, and never outlives a run.

    Args:
        board: to tell progress and hear the word to stop; None where no memory is shared.
        learned: whether trained networks will be needed.
        meshcat: whether to show what is planned.
    """
    if learned:
        import ictamp_drake.learning.models  # noqa: F401, PLC0415
    end_with_parent()
    _Process.board = board or Board(CONTEXT, 1)
    if meshcat:
        _Process.view = LiveView()
        _Process.board.url = _Process.view.url


def run_job(slot: int, job: Job, artefacts: Artefacts) -> Finished | None:
    """Solve a problem; None when the run was stopped before it began.

    Args:
        slot: of the job on the board.
        job: the problem and its method.
        artefacts: what is kept.
    """
    board = _Process.board
    if board.stopping:
        return None
    board.start(slot)
    record, files = None, dict[str, bytes]()
    try:
        task = prepare(job.problem.path, job.method)
        solution = solve(task, job.method, _listeners(board, slot, task.spec), lambda: board.stopping)
        record = record_of(job.problem.name, job.strategy, job.problem.level, job.method.seed, solution)
        files = _artefacts(solution, job.problem.name, artefacts)
    except Exception:
        record = record or job.broken(CRASHED, board.seconds(slot), "")
        record = replace(record, error=traceback.format_exc())
    board.finish(slot)
    return Finished(record, files)


def _artefacts(solution: Solution, name: str, which: Artefacts) -> dict[str, bytes]:
    with TemporaryDirectory() as parent:
        folder = Path(parent) / name
        folder.mkdir()
        write_artefacts(solution, folder, which)
        return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def _listeners(board: Board, slot: int, spec: SceneSpec) -> list[Listener]:
    shown = [] if _Process.view is None else [_Process.view.listener(spec)]
    return [partial(board.tell, slot), *shown]
