"""Execution of one job or many at once, with a hard time limit for each job and a clean end on Ctrl-C."""

import shutil
import signal
from collections.abc import Callable, Iterator, Mapping, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path

from ictamp_drake.core.errors import IctampError
from ictamp_drake.runs.board import Board
from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.engine import Engine
from ictamp_drake.runs.folder import RESULTS
from ictamp_drake.runs.jobs import CRASHED, HUNG, Finished, Job, Pages
from ictamp_drake.runs.pool import CONTEXT, WorkerDied
from ictamp_drake.runs.records import Record, append
from ictamp_drake.runs.worker import begin_job, run_job, start_worker

POLL = 0.2
"""Time between two checks of the workers [s]."""

Watch = Callable[[Board, Sequence[Record]], None]
"""Callback at least every `POLL` seconds, with the board and the records that are new since the last call."""


def sweep(jobs: Sequence[Job], folder: Path, conduct: Conduct, watch: Watch, *, alone: bool = False) -> bool:
    """Run all jobs. The files of each job are written first, then its record, and then `watch` is called.

    If the process of a job dies, the job is tried once more. If it dies again, or exceeds the time limit by more than
    the grace period, the record says so. The first Ctrl-C lets the workers on this machine finish their current step
    and ends those of a cluster. The second Ctrl-C ends all workers immediately.

    Args:
        jobs: Jobs to run.
        folder: Folder of the run.
        conduct: Options of the run.
        watch: Callback that follows the progress.
        alone: Whether local jobs run in this process. This saves the start of workers and shows the result before its
            pages are made. But a job that dies takes the program with it, and one that hangs forever in native code
            cannot be ended.

    Returns:
        Whether the sweep finished. False when it was interrupted.
    """
    board = Board(CONTEXT, len(jobs))
    shared = conduct.engine.engine == "local"
    learned = any(job.suited.learned for job in jobs)
    start = (start_worker, board if shared else None, learned, conduct.meshcat)
    watch(board, [])
    if conduct.engine.is_inline(alone):
        board.watch = partial(watch, board, [])
    with _ctrl_c_stops(board), conduct.engine.start(len(jobs), *start, alone=alone) as engine:
        _Sweep(jobs, folder, conduct, board, watch, conduct.engine.is_inline(alone)).run(engine)
    return not board.stopping


@dataclass(frozen=True)
class _Sweep:
    jobs: Sequence[Job]
    folder: Path
    conduct: Conduct
    board: Board
    watch: Watch
    inline: bool
    _repeated: set[int] = field(default_factory=set)

    @property
    def shared(self) -> bool:
        """Whether workers share the board."""
        return self.conduct.engine.engine == "local"

    def run(self, engine: Engine) -> None:
        """Submit all jobs to the engine, wait for them, and report their results."""
        pending = {self._submit(engine, slot): slot for slot in range(len(self.jobs))}
        while pending and (self.shared or not self.board.stopping):
            if self.board.stopping:  # a job that no worker has begun needs none
                pending = {future: slot for future, slot in pending.items() if not future.cancel()}
            done = wait(pending, timeout=POLL, return_when=FIRST_COMPLETED).done
            slots = {future: pending.pop(future) for future in done}
            again = {slot for future, slot in slots.items() if self._repeat(future, slot)}
            pending |= {self._submit(engine, slot): slot for slot in again}
            finished = [self._collect(future, slot) for future, slot in slots.items() if slot not in again]
            self.watch(self.board, [self._keep(each) for each in finished if each is not None])
            for each in finished:
                if each is not None and each.pages is not None:
                    self._make_pages(engine, each.record, each.pages)

    def _repeat(self, future: Future[Finished | None], slot: int) -> bool:
        """Whether the process of a job died for the first time, so that the job is tried once more."""
        if slot in self._repeated or self.board.stopping or not isinstance(future.exception(), WorkerDied):
            return False
        self._repeated.add(slot)
        return True

    def _submit(self, engine: Engine, slot: int) -> Future[Finished | None]:
        job = self.jobs[slot]
        timeout = job.method.total_time_limit + self.conduct.grace
        task = partial(begin_job, folder=self.folder / job.name) if self.inline else run_job
        return engine.submit(task, slot if self.shared else 0, job, self.conduct.artefacts, timeout=timeout)

    def _collect(self, future: Future[Finished | None], slot: int) -> Finished | None:
        """Return the result of a job, or a failure record if it broke down."""
        try:
            return future.result()
        except Exception as error:
            return Finished(self._record_breakdown(slot, error), {})

    def _keep(self, finished: Finished) -> Record:
        """Write the files and the record of a job. A file that cannot be written costs only itself."""
        folder = self.folder / finished.record.name
        shutil.rmtree(folder, ignore_errors=True)
        error = _write(finished.files, folder)
        record = replace(finished.record, error=finished.record.error or error)
        try:
            append(record, self.folder / RESULTS)
        except IctampError:
            shutil.rmtree(folder, ignore_errors=True)  # makes room for the record
            record = replace(record, error=record.error or "its files were removed to make room for this record")
            append(record, self.folder / RESULTS)
        return record

    def _make_pages(self, engine: Engine, record: Record, make: Callable[[], Pages]) -> None:
        """Make the pages of a problem whose record is written. If that fails, write another record with the error."""
        try:
            files, error = engine.submit(make, timeout=self.conduct.grace).result()
        except TimeoutError:
            files, error = {}, f"the pages were given up after {self.conduct.grace:g} s"
        except OSError as failure:
            files, error = {}, f"the pages could not be made: {failure.strerror}"
        error = _write(files, self.folder / record.name) or error
        if error is not None:
            broken = replace(record, error=error)
            append(broken, self.folder / RESULTS)
            self.watch(self.board, [broken])

    def _record_breakdown(self, slot: int, error: Exception) -> Record:
        self.board.finish(slot)
        job = self.jobs[slot]
        if isinstance(error, TimeoutError):
            seconds = job.method.total_time_limit + self.conduct.grace
            return job.make_failure_record(HUNG, seconds, f"ended after {seconds:g} s")
        twice = " for the second time" if slot in self._repeated else ""
        return job.make_failure_record(CRASHED, self.board.seconds(slot), f"the process died{twice}: {error!r}")


def _write(files: Mapping[str, bytes], folder: Path) -> str | None:
    """Write files, and return which of them cannot be written, and why."""
    failed: dict[str, str] = {}
    for name, content in files.items():
        try:
            folder.mkdir(parents=True, exist_ok=True)
            _write_file(folder / name, content)
        except OSError as error:
            failed[name] = error.strerror or str(error)
            with suppress(OSError):
                (folder / name).unlink(missing_ok=True)
    return f"{', '.join(failed)} cannot be written: {next(iter(failed.values()))}" if failed else None


def _write_file(path: Path, content: bytes) -> None:
    path.write_bytes(content)


@contextmanager
def _ctrl_c_stops(board: Board) -> Iterator[None]:
    def stop(*_: object) -> None:
        if board.stopping:
            raise KeyboardInterrupt
        board.stop()

    before = signal.signal(signal.SIGINT, stop)
    try:
        yield
    finally:
        signal.signal(signal.SIGINT, before)
