"""Many jobs at once: isolated workers, a hard limit of time for each job, and a clean end on Ctrl-C."""

import shutil
import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path

from ictamp_drake.runs.board import Board
from ictamp_drake.runs.engine import Engine
from ictamp_drake.runs.folder import RESULTS
from ictamp_drake.runs.options import Conduct
from ictamp_drake.runs.pool import CONTEXT
from ictamp_drake.runs.records import Record, append
from ictamp_drake.runs.worker import CRASHED, HUNG, Finished, Job, run_job, start_worker

POLL = 0.2
"""Time between two looks at what the workers do [s]."""

Watch = Callable[[Board, Sequence[Record]], None]
"""Called at least every `POLL` seconds with the board and the records that are new since the last call."""


def sweep(jobs: Sequence[Job], folder: Path, conduct: Conduct, watch: Watch) -> bool:
    """Do all jobs; what each leaves is on the disk before it is told, its record last.

    A job whose process dies or exceeds the time limit by more than the grace becomes a record that says so. The first
    Ctrl-C lets the workers of this machine finish the step they are at and ends those of a cluster, the second one ends
    all at once.

    Returns:
        False when it was interrupted.
    """
    board = Board(CONTEXT, len(jobs))
    shared = conduct.engine.engine == "local"
    learned = any(job.method.learned for job in jobs)
    start = (start_worker, board if shared else None, learned, conduct.meshcat)
    with _ctrl_c_stops(board), conduct.engine.start(len(jobs), *start) as engine:
        _Sweep(jobs, folder, conduct, board, shared, watch).run(engine)
    return not board.stopping


@dataclass(frozen=True)
class _Sweep:
    jobs: Sequence[Job]
    folder: Path
    conduct: Conduct
    board: Board
    shared: bool
    watch: Watch

    def run(self, engine: Engine) -> None:
        """Hand all jobs to the engine, wait for them and tell what comes of them."""
        pending = {self._submitted(engine, slot): slot for slot in range(len(self.jobs))}
        while pending and (self.shared or not self.board.stopping):
            done = wait(pending, timeout=POLL, return_when=FIRST_COMPLETED).done
            records = [self._kept(future, pending.pop(future)) for future in done]
            self.watch(self.board, [record for record in records if record is not None])

    def _submitted(self, engine: Engine, slot: int) -> Future[Finished | None]:
        job = self.jobs[slot]
        timeout = job.method.time_limit + self.conduct.grace
        return engine.submit(run_job, slot if self.shared else 0, job, self.conduct.artefacts, timeout=timeout)

    def _kept(self, future: Future[Finished | None], slot: int) -> Record | None:
        """Write what came of a job, or what is known of one that came to nothing."""
        try:
            finished = future.result()
        except Exception as error:
            finished = Finished(self._broken(slot, error), {})
        if finished is None:
            return None
        folder = self.folder / finished.record.name
        shutil.rmtree(folder, ignore_errors=True)
        for name, content in finished.files.items():
            folder.mkdir(parents=True, exist_ok=True)
            (folder / name).write_bytes(content)
        append(finished.record, self.folder / RESULTS)
        return finished.record

    def _broken(self, slot: int, error: Exception) -> Record:
        self.board.finish(slot)
        job = self.jobs[slot]
        if isinstance(error, TimeoutError):
            seconds = job.method.time_limit + self.conduct.grace
            return job.broken(HUNG, seconds, f"the process was ended after {seconds:g} s")
        code = getattr(error, "exitcode", None)
        return job.broken(CRASHED, self.board.seconds(slot), f"the process died: {error!r}, exit code {code}")


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
