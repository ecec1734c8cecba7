"""Many problems at once: isolated workers, a hard limit of time for each problem, and a clean end on Ctrl-C."""

import signal
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import FIRST_COMPLETED, Future, wait
from contextlib import contextmanager
from dataclasses import dataclass

from pebble import ProcessPool

from ictamp_drake.runs.board import Board
from ictamp_drake.runs.folder import RESULTS
from ictamp_drake.runs.pool import CONTEXT, deaf_children, isolated
from ictamp_drake.runs.records import Record, append
from ictamp_drake.runs.worker import CRASHED, HUNG, Bench, Problem, broken, run_problem, start_worker

POLL = 0.2
"""Time between two looks at what the workers do [s]."""

Watch = Callable[[Board, Sequence[Record]], None]
"""Called at least every `POLL` seconds with the board and the records that are new since the last call."""


def sweep(problems: Sequence[Problem], bench: Bench, workers: int, grace: float, watch: Watch) -> bool:
    """Solve all problems; each one's record is on the disk before it is told.

    A problem whose process dies or exceeds the time limit by more than `grace` [s] becomes a record that says so. The
    first Ctrl-C lets the workers finish the step they are at, the second one ends them at once.

    Returns:
        False when it was interrupted.
    """
    board = Board(CONTEXT, len(problems))
    run = _Sweep(problems, bench, board, watch)
    count = min(workers, len(problems))
    with _ctrl_c_stops(board), isolated(count, start_worker, board, bench) as pool:
        run.follow(run.start(pool, timeout=bench.method.time_limit + grace))
    return not board.stopping


@dataclass(frozen=True)
class _Sweep:
    problems: Sequence[Problem]
    bench: Bench
    board: Board
    watch: Watch

    def start(self, pool: ProcessPool, timeout: float) -> dict[Future[Record | None], int]:
        """Hand all problems to the pool; returns the numbers of the problems."""
        with deaf_children():
            return {
                pool.schedule(run_problem, (slot, problem, self.bench), timeout=timeout): slot
                for slot, problem in enumerate(self.problems)
            }

    def follow(self, pending: dict[Future[Record | None], int]) -> None:
        """Wait for all problems and tell what comes of them."""
        while pending:
            done = wait(pending, timeout=POLL, return_when=FIRST_COMPLETED).done
            records = [self._record(future, pending.pop(future)) for future in done]
            self.watch(self.board, [record for record in records if record is not None])

    def _record(self, future: Future[Record | None], slot: int) -> Record | None:
        """What the worker has written, or what is written here because the worker could not."""
        try:
            return future.result()
        except TimeoutError as error:
            stop_reason, cause = HUNG, f"the process was ended after {error.args[1]:g} s"
        except Exception as error:
            stop_reason, cause = CRASHED, f"the process died: {error!r}, exit code {getattr(error, 'exitcode', None)}"
        record = broken(self.problems[slot], self.bench, stop_reason, self.board.seconds(slot), cause)
        append(record, self.bench.folder / RESULTS)
        self.board.finish(slot)
        return record


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
