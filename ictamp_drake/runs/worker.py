"""Work of a worker: solve one problem after the other. Workers leave no files behind."""

import gc
import multiprocessing
import traceback
from collections.abc import Iterator
from contextlib import contextmanager
from dataclasses import replace
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING

from ictamp_drake.planning.events import Listener
from ictamp_drake.runs.board import Board
from ictamp_drake.runs.jobs import CRASHED, Finished, Job, Pages
from ictamp_drake.runs.pool import CONTEXT, end_with_parent
from ictamp_drake.runs.records import record_of
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.tamp.artefacts import Artefacts, keep_plan, write_pages, write_result
from ictamp_drake.tamp.solve import Solution, solve
from ictamp_drake.tamp.task import prepare

if TYPE_CHECKING:
    from ictamp_drake.viz.live import LiveView


class _Process:
    """State of a worker process that persists between problems."""

    board: Board
    view: "LiveView | None" = None


def start_worker(board: Board | None, learned: bool, meshcat: bool) -> None:
    """Prepare a process: preload slow imports, and end with the parent process.

    Args:
        board: Board for progress and the stop flag. None without shared memory.
        learned: Whether trained networks will be needed.
        meshcat: Whether to show the planning live.
    """
    _load_modules(learned)
    end_with_parent()
    if multiprocessing.parent_process() is not None:
        gc.freeze()  # modules stay, so that the collections in `run_job` need not look at them
    _Process.board = board or Board(CONTEXT, 1)
    _Process.view = None
    if meshcat:
        from ictamp_drake.viz.live import LiveView  # noqa: PLC0415  (only where it is asked for)

        _Process.view = LiveView()
        _Process.board.url = _Process.view.url


def _load_modules(learned: bool) -> None:
    if learned:
        with _pause_garbage_collection():  # it would find nothing and take a sixth of the time
            import ictamp_drake.learning.models  # noqa: F401, PLC0415


@contextmanager
def _pause_garbage_collection() -> Iterator[None]:
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def run_job(slot: int, job: Job, artefacts: Artefacts) -> Finished | None:
    """Solve a problem and make its pages. Return None when the run was stopped before the problem began.

    Args:
        slot: Slot of the job on the board.
        job: Problem and method.
        artefacts: Files to keep.
    """
    finished = begin_job(slot, job, artefacts)
    if finished is not None and finished.pages is not None:
        files, error = finished.pages()
        finished = Finished(replace(finished.record, error=error), finished.files | files)
    gc.collect()  # Drake's diagrams and builders refer to each other: 7 MB in a few objects, which never seem urgent
    return finished


def begin_job(slot: int, job: Job, artefacts: Artefacts, folder: Path | None = None) -> Finished | None:
    """Solve a problem, but leave its pages to be made later in this process. See `run_job`.

    If the search goes on after its first plan, each plan is written into `folder` as soon as it is found.
    """
    board = _Process.board
    if board.stopping:
        return None
    board.start(slot)
    record, files, pages = None, dict[str, bytes](), None
    try:
        task = job.task or prepare(job.problem.spec, job.method, job.problem.name)
        listeners = _listeners(board, slot, task.spec)
        if folder is not None and artefacts != "none":
            listeners.append(partial(keep_plan, task, job.suited, folder))
        solution = solve(task, job.method, listeners=listeners, stop=lambda: board.stopping)
        record = record_of(job.problem.name, job.strategy, job.problem.level, job.method.seed, solution)
        if artefacts != "none":
            with _folder(job.problem.name) as temporary:
                write_result(solution, temporary)
                files = _contents(temporary)
        if artefacts == "all":
            pages = partial(_pages, slot, solution, job.problem.name)
    except Exception:
        record = record or job.make_failure_record(CRASHED, board.seconds(slot), "")
        record = replace(record, error=traceback.format_exc())
    if pages is None:
        board.finish(slot)
    return Finished(record, files, pages)


def _pages(slot: int, solution: Solution, name: str) -> Pages:
    error = None
    with _folder(name) as folder:
        try:
            write_pages(solution, folder)
        except Exception:
            error = traceback.format_exc()
        files = _contents(folder)
    _Process.board.finish(slot)
    return Pages(files, error)


@contextmanager
def _folder(name: str) -> Iterator[Path]:
    """Create a temporary folder with that name. It is removed after the block."""
    with TemporaryDirectory() as parent:
        folder = Path(parent) / name
        folder.mkdir()
        yield folder


def _contents(folder: Path) -> dict[str, bytes]:
    return {path.name: path.read_bytes() for path in sorted(folder.iterdir())}


def _listeners(board: Board, slot: int, spec: SceneSpec) -> list[Listener]:
    shown = [] if _Process.view is None else [_Process.view.listener(spec)]
    return [partial(board.tell, slot), *shown]
