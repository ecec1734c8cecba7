"""Tasks in this process. There is nothing to start, but a task that dies takes the whole process with it."""

import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from typing import Any, TypeVar

from threadpoolctl import threadpool_limits  # type: ignore[import-untyped]

T = TypeVar("T")


class Inline:
    """Engine in this process. See `engine.Engine`. A task is finished when `submit` returns.

    A task that takes too long ends at its next line of Python or at the next step of the simulator. Other native code
    that never returns cannot be ended.
    """

    def submit(self, function: Callable[..., T], *arguments: Any, timeout: float) -> Future[T]:
        """Run the function and return a finished future.

        The future raises TimeoutError if the function exceeded `timeout` [s], or the exception of the function.
        """
        future: Future[T] = Future()
        try:
            with _alarm(timeout):
                future.set_result(function(*arguments))
        except _OutOfTime:
            future.set_exception(TimeoutError())
        except Exception as error:
            future.set_exception(error)
        return future


class _OutOfTime(BaseException):
    """Raised inside a task, which must not catch it."""


@contextmanager
def start_inline(start: Callable[..., None], *arguments: Any) -> Iterator[Inline]:
    """Prepare this process as an engine with one thread per task, like workers."""
    start(*arguments)
    with threadpool_limits(1):
        yield Inline()


@contextmanager
def _alarm(seconds: float) -> Iterator[None]:
    """Raise _OutOfTime in the block after `seconds` [s]."""

    def ring(*_: object) -> None:
        raise _OutOfTime

    handler = signal.signal(signal.SIGALRM, ring)
    before = signal.setitimer(signal.ITIMER_REAL, max(seconds, 1e-6))
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, *before)
        signal.signal(signal.SIGALRM, handler)
