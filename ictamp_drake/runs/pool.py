"""Isolated worker processes: one thread each, a hard limit of time for each task, and none outlives the program."""

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
"""How processes are started: Drake does not survive a fork."""


class Pool:
    """Processes of this machine; see `engine.Engine`."""

    def __init__(self, processes: "ProcessPool") -> None:
        self._processes = processes

    def submit(self, function: Callable[..., T], *arguments: Any, timeout: float) -> Future[T]:
        """What a process will return; TimeoutError after so many seconds, another exception when it died."""
        with _shield_children():
            return self._processes.schedule(function, arguments, timeout=timeout)


@contextmanager
def start_pool(workers: int, start: Callable[..., None], *arguments: Any) -> Iterator[Pool]:
    """A pool of worker processes, which end with the block.

    Args:
        workers: how many processes.
        start: called in each with the arguments before its first task; calls `end_with_parent`.
    """
    from pebble import ProcessPool  # noqa: PLC0415  (one problem needs no pool)

    for name in THREADS:
        os.environ[name] = "1"  # inherited by the workers, which share the cores already
    processes = ProcessPool(max_workers=workers, initializer=start, initargs=arguments, context=CONTEXT)
    try:
        yield Pool(processes)
    finally:
        processes.stop()  # type: ignore[no-untyped-call]
        processes.join()


@contextmanager
def _shield_children() -> Iterator[None]:
    """Processes and threads started here never see Ctrl-C, which a terminal sends to the whole family."""
    before = signal.pthread_sigmask(signal.SIG_BLOCK, {signal.SIGINT})
    try:
        yield
    finally:
        signal.pthread_sigmask(signal.SIG_SETMASK, before)


def end_with_parent() -> None:
    """From now on this process ends when its parent does, however that ends."""
    threading.Thread(target=_await_parent, daemon=True).start()


def _await_parent() -> None:
    parent = multiprocessing.parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)
