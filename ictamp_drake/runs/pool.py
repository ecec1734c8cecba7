"""Isolated worker processes with one thread each and a hard time limit per task. None outlives the program."""

import multiprocessing
import os
import signal
import threading
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from multiprocessing import get_context
from typing import TYPE_CHECKING, Any, TypeVar

if TYPE_CHECKING:
    from pebble import ProcessPool

T = TypeVar("T")

THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "VECLIB_MAXIMUM_THREADS")

CONTEXT = get_context("spawn")
"""Start method of processes: Drake does not survive a fork."""


class Pool:
    """Processes on this machine. See `engine.Engine`."""

    def __init__(self, processes: "ProcessPool") -> None:
        self._processes = processes

    def submit(self, function: Callable[..., T], *arguments: Any, timeout: float) -> Future[T]:
        """Run a function in a worker process.

        The future raises TimeoutError after `timeout` [s], and another exception when the process dies.
        """
        with _shield_children():
            return self._processes.schedule(function, arguments, timeout=timeout)


@contextmanager
def start_pool(workers: int, start: Callable[..., None], *arguments: Any) -> Iterator[Pool]:
    """Start a pool of worker processes. They stop at the end of the block.

    Args:
        workers: Number of processes.
        start: Function called with `arguments` in each process before its first task. It calls `end_with_parent`.
        *arguments: Arguments of `start`.
    """
    from pebble import ProcessPool  # noqa: PLC0415  (one problem needs no pool)

    for name in THREADS:
        os.environ[name] = "1"  # inherited by the workers, which already share the cores
    processes = ProcessPool(max_workers=workers, initializer=start, initargs=arguments, context=CONTEXT)
    try:
        yield Pool(processes)
    finally:
        processes.stop()  # type: ignore[no-untyped-call]
        processes.join()


@contextmanager
def _shield_children() -> Iterator[None]:
    """Block Ctrl-C for processes and threads started here. A terminal sends it to the whole process group."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def end_with_parent() -> None:
    """Make this process end when its parent ends, for whatever reason."""
    threading.Thread(target=_await_parent, daemon=True).start()


def _await_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
