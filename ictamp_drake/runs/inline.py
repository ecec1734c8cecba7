"""Tasks in this process: nothing to start, but nothing to fall back on when a task takes the process with it."""

import signal
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from typing import Any, TypeVar

from threadpoolctl import threadpool_limits  # type: ignore[import-untyped]

T = TypeVar("T")


class Inline:
    """This process; see `engine.Engine`. A task is over when `submit` returns.

    One that takes too long is ended at its next line of Python or the simulator's next step. Other native code that
    never returns cannot be ended.
    """

    def submit(self, function: Callable[..., T], *arguments: Any, timeout: float) -> Future[T]:
        """What the function returned; TimeoutError after so many seconds, another exception when it raised one."""
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
    """Raised in the midst of a task, which must not catch it."""


@contextmanager
def start_inline(start: Callable[..., None], *arguments: Any) -> Iterator[Inline]:
    """This process with one thread for each task, as workers have."""
    start(*arguments)
    with threadpool_limits(1):
        yield Inline()


@contextmanager
def _alarm(seconds: float) -> Iterator[None]:
    """Raise _OutOfTime in the block after so many seconds."""

    def ring(*_: object) -> None:
        raise _OutOfTime

    handler = signal.signal(signal.SIGALRM, ring)
    before = signal.setitimer(signal.ITIMER_REAL, max(seconds, 1e-6))
    try:
        yield
    finally:
        signal.setitimer(signal.ITIMER_REAL, *before)
        signal.signal(signal.SIGALRM, handler)
