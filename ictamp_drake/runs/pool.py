"""Isolated worker processes with one thread each and a hard time limit per task. None outlives the program.

Each worker has its own pipe and a thread here that waits for it. A worker that dies therefore affects no other, and at
most the task that it works on: it receives a task only when it is ready.
"""

import multiprocessing
import os
import queue
import signal
import tempfile
import threading
import traceback
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field
from multiprocessing import get_context, resource_tracker
from multiprocessing.connection import Connection
from multiprocessing.context import SpawnProcess
from typing import Any, TypeVar

T = TypeVar("T")

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")

CONTEXT = get_context("spawn")
"""Start method of processes: Drake does not survive a fork."""

TASKS = 50
"""Number of tasks after which a worker is replaced, since it grows by 5 to 11 MB with each problem."""

STARTS = 10
"""Number of workers in a row that may die before they are ready for a task."""

START_LIMIT = 600.0
"""Time limit for the start of a worker [s]."""

Start = tuple[Callable[..., None], tuple[Any, ...]]


class WorkerDied(Exception):  # noqa: N818  (an event, not a mistake)
    """The process of a worker ended while it worked on a task, or no worker could start."""


@dataclass(frozen=True)
class _Task:
    """A function to run.

    Attributes:
        future: Future of the result.
        call: Function and arguments.
        timeout: Time limit [s].
    """

    future: Future[Any]
    call: tuple[Callable[..., Any], tuple[Any, ...]]
    timeout: float


class Pool:
    """Processes on this machine. See `engine.Engine`."""

    def __init__(self, workers: int, start: Start, scratch: str) -> None:
        self._tasks: queue.SimpleQueue[_Task | None] = queue.SimpleQueue()
        self._seats = [_Seat(self._tasks, start, scratch) for _ in range(workers)]
        self._threads = [threading.Thread(target=seat.serve, daemon=True) for seat in self._seats]
        for thread in self._threads:
            thread.start()

    def submit(self, function: Callable[..., T], *arguments: Any, timeout: float) -> Future[T]:
        """Run a function in a worker process.

        The future raises TimeoutError after `timeout` [s], WorkerDied when the process dies, and the exception of the
        function when there is one. It can be cancelled until a worker has begun.
        """
        future: Future[T] = Future()
        self._tasks.put(_Task(future, (function, arguments), timeout))
        return future

    def stop(self) -> None:
        """End all workers at once. Futures that are not done remain so."""
        for seat in self._seats:
            seat.stop()
        for _ in self._threads:
            self._tasks.put(None)
        for thread in self._threads:
            thread.join()


class _Seat:
    """The place of one worker, which is replaced when it dies or has done enough."""

    def __init__(self, tasks: "queue.SimpleQueue[_Task | None]", start: Start, scratch: str) -> None:
        self._tasks = tasks
        self._start = start
        self._scratch = scratch
        self._worker: _Worker | None = None
        self._stopped = False
        self._lock = threading.Lock()

    def serve(self) -> None:
        """Give one task after the other to the worker, until the pool stops."""
        signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        while not self._stopped and (task := self._tasks.get()) is not None:
            try:
                self._run(task)
            except Exception as error:
                self._remove()
                if not self._stopped:
                    _fail(task.future, error)

    def stop(self) -> None:
        """End the worker, and start no other."""
        with self._lock:
            self._stopped = True
            if self._worker is not None:
                self._worker.kill()

    def _run(self, task: _Task) -> None:
        worker = self._ready_worker(task.future)
        if worker is None or not task.future.set_running_or_notify_cancel():
            return
        worker.tasks += 1
        result, error = worker.ask(task.call, task.timeout)
        if error is None:
            task.future.set_result(result)
        else:
            task.future.set_exception(error)
        if worker.tasks >= TASKS:
            self._remove()

    def _ready_worker(self, future: Future[Any]) -> "_Worker | None":
        """Return a worker that waits for a task; None when the task is cancelled or the pool stops meanwhile."""
        for _ in range(STARTS):
            if self._worker is None:
                self._add()
            if self._stopped or self._worker is None:
                return None
            if self._worker.is_ready(future.cancelled):
                return self._worker
            if future.cancelled():
                future.set_running_or_notify_cancel()
                return None
            self._remove()
        raise WorkerDied(f"{STARTS} workers in a row died before they could start")

    def _add(self) -> None:
        with self._lock:
            if not self._stopped:
                self._worker = _start_worker(self._start, self._scratch)

    def _remove(self) -> None:
        with self._lock:
            worker, self._worker = self._worker, None
        if worker is not None:
            worker.kill()


@dataclass
class _Worker:
    """A process and the pipe to it.

    Attributes:
        process: The process.
        pipe: This end of the pipe.
        tasks: Number of tasks so far.
        ready: Whether it waits for tasks.
    """

    process: SpawnProcess
    pipe: Connection
    tasks: int = 0
    ready: bool = field(default=False)

    def is_ready(self, cancelled: Callable[[], bool]) -> bool:
        """Wait until the worker is ready; False when it died, took too long, or the task was cancelled.

        Raises:
            Exception: The start function failed.
        """
        if self.ready:
            return self.process.is_alive()
        waited = 0.0
        try:
            while not self.pipe.poll(_TICK):
                waited += _TICK
                if cancelled() or waited > START_LIMIT:
                    return False
            _, error = self.pipe.recv()
        except (EOFError, OSError):
            return False
        if error is not None:
            raise error
        self.ready = True
        return True

    def ask(self, call: object, timeout: float) -> tuple[Any, Exception | None]:
        """Return the result of a call and the error, one of which is None.

        Raises:
            TimeoutError: The call takes longer than `timeout` [s].
            WorkerDied: The process died.
        """
        try:
            self.pipe.send(call)
            if not self.pipe.poll(timeout):
                raise TimeoutError
            answer: tuple[Any, Exception | None] = self.pipe.recv()
        except TimeoutError:
            raise
        except (EOFError, OSError) as error:
            self.process.join(_TICK)
            raise WorkerDied(f"the worker died with exit code {self.process.exitcode}") from error
        return answer

    def kill(self) -> None:
        """End the process at once."""
        self.process.kill()
        self.process.join()


_TICK = 0.2
"""Time between two looks at what may have been cancelled [s]."""

_SPAWNING = threading.Lock()


def _start_worker(start: Start, scratch: str) -> _Worker:
    """Start a process that ignores Ctrl-C, which a terminal sends to the whole process group."""
    with _SPAWNING:
        resource_tracker.ensure_running()  # whose own start would allow SIGINT again
        before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
        try:
            here, there = CONTEXT.Pipe()
            process = CONTEXT.Process(target=_work, args=(there, start, scratch), daemon=True)
            process.start()
            there.close()  # so that the end of the process is the end of the pipe
        finally:
            signal.pthread_sigmask(signal.SIG_SETMASK, before)
    return _Worker(process, here)


def _work(pipe: Connection, start: Start, scratch: str) -> None:
    """Run tasks in a worker process until the pipe is closed."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)
    tempfile.tempdir = scratch
    function, arguments = start
    with suppress(EOFError, OSError):  # the program has ended
        while True:
            _answer(pipe, function, arguments)
            function, arguments = pipe.recv()


def _answer(pipe: Connection, function: Callable[..., Any], arguments: tuple[Any, ...]) -> None:
    try:
        result, error = function(*arguments), None
    except Exception as raised:
        raised.add_note(traceback.format_exc())
        result, error = None, raised
    _send(pipe, result, error)


def _send(pipe: Connection, result: Any, error: Exception | None) -> None:
    """Send an answer, or why it cannot be sent."""
    try:
        pipe.send((result, error))
    except OSError:
        raise  # the program has ended
    except Exception as unsendable:
        pipe.send((None, RuntimeError(f"{error or unsendable!r}")))


def _fail(future: Future[Any], error: Exception) -> None:
    """Set the exception of a task that may not have begun."""
    if future.running() or future.set_running_or_notify_cancel():
        future.set_exception(error)


@contextmanager
def start_pool(workers: int, start: Callable[..., None], *arguments: Any) -> Iterator[Pool]:
    """Start a pool of worker processes. They stop at the end of the block, and leave no temporary files.

    Args:
        workers: Number of processes.
        start: Function called with `arguments` in each process before its first task. It calls `end_with_parent`.
        *arguments: Arguments of `start`.
    """
    for name in THREADS:
        os.environ[name] = "1"  # inherited by the workers, which already share the cores
    with tempfile.TemporaryDirectory(prefix="ictamp-", ignore_cleanup_errors=True) as scratch:
        pool = Pool(workers, (start, arguments), scratch)
        try:
            yield pool
        finally:
            pool.stop()


def end_with_parent() -> None:
    """Make this process end when its parent ends, for whatever reason."""
    threading.Thread(target=_await_parent, daemon=True).start()


def _await_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
