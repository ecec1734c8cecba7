"""What a worker process does: solve one problem after the other, each to a record on the disk."""

import shutil
import traceback
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path

from ictamp_drake.planning.events import Listener
from ictamp_drake.runs.artefacts import Artefacts, write_artefacts
from ictamp_drake.runs.board import Board
from ictamp_drake.runs.folder import RESULTS
from ictamp_drake.runs.options import Method
from ictamp_drake.runs.pool import end_with_parent
from ictamp_drake.runs.records import Record, append, record_of
from ictamp_drake.runs.solve import prepare, solve
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.viz.live import LiveView

CRASHED, HUNG = "CRASHED", "HUNG"
"""Why a problem ended that could not say so itself."""


@dataclass(frozen=True)
class Problem:
    """A scene file to be solved.

    Attributes:
        name: of its record and folder.
        path: of the scene file.
        level: easy, medium, hard or extreme; None for a scene of one's own.
    """

    name: str
    path: Path
    level: str | None = None


@dataclass(frozen=True)
class Bench:
    """What all problems of a run have in common.

    Attributes:
        folder: of the run.
        method: how problems are solved.
        artefacts: what is kept of each.
        meshcat: whether to show what is planned.
    """

    folder: Path
    method: Method
    artefacts: Artefacts
    meshcat: bool


class _Process:
    """What a worker process keeps between problems."""

    board: Board
    view: LiveView | None = None


def start_worker(board: Board, bench: Bench) -> None:
    """Make a process ready: loads what would be loaded in the midst of the first problem, and never outlives a run."""
    import ictamp_drake.symbolic.pddl  # noqa: PLC0415

    if bench.method.learned:
        import ictamp_drake.learning.models  # noqa: F401, PLC0415
    end_with_parent()
    _Process.board = board
    if bench.meshcat:
        _Process.view = LiveView()
        board.url = _Process.view.url


def run_problem(slot: int, problem: Problem, bench: Bench) -> Record | None:
    """Solve a problem, write what it leaves and then its record; None when the run was stopped before it began."""
    board = _Process.board
    if board.stopping:
        return None
    board.start(slot)
    folder = bench.folder / problem.name
    shutil.rmtree(folder, ignore_errors=True)
    record = None
    try:
        task = prepare(problem.path, bench.method)
        solution = solve(task, bench.method, _listeners(slot, task.spec), lambda: board.stopping)
        record = record_of(problem.name, problem.level, bench.method.seed, solution)
        write_artefacts(solution, folder, bench.artefacts)
    except Exception:
        record = record or broken(problem, bench, CRASHED, board.seconds(slot), "")
        record = replace(record, error=traceback.format_exc())
    append(record, bench.folder / RESULTS)
    board.finish(slot)
    return record


def broken(problem: Problem, bench: Bench, reason: str, seconds: float, error: str) -> Record:
    """The record of a problem that did not come to its end."""
    return Record(
        problem=problem.name,
        level=problem.level,
        seed=bench.method.seed,
        stop_reason=reason,
        planning_time_s=round(seconds, 4),
        error=error,
    )


def _listeners(slot: int, spec: SceneSpec) -> list[Listener]:
    shown = [] if _Process.view is None else [_Process.view.listener(spec)]
    return [partial(_Process.board.tell, slot), *shown]
