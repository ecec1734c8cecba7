"""Tasks on a Ray cluster. A task whose node dies is run again on another one; its result arrives once."""

import logging
import socket
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import ExitStack, contextmanager
from functools import cache
from typing import Any, TypeVar

import ray

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.runs.pool import Pool, start_pool

T = TypeVar("T")
Start = tuple[Callable[..., None], tuple[Any, ...]]

RETRIES = 3
"""Nodes on which a task may be lost."""


class Cluster:
    """Processes of all nodes, one for each core; see `engine.Engine`."""

    def __init__(self, start: Start) -> None:
        self._start = ray.put(start)
        self._task: Any = ray.remote(num_cpus=1, max_retries=RETRIES)(_run_isolated)

    def submit(self, function: Callable[..., T], *arguments: Any, timeout: float) -> Future[T]:
        """What a process will return; TimeoutError after so many seconds, another exception when it died."""
        return self._task.remote(self._start, function, arguments, timeout).future()


@contextmanager
def connect_cluster(address: str | None, start: Callable[..., None], *arguments: Any) -> Iterator[Cluster]:
    """A connection to a cluster, which ends with the block, and with it all tasks that are not done.

    Raises:
        IctampError: there is no cluster at the address.
    """
    _knock(address)
    ray.init(address=address, log_to_driver=False, logging_level=logging.ERROR)
    try:
        yield Cluster((start, arguments))
    finally:
        ray.shutdown()


def _knock(address: str | None) -> None:
    """Raise IctampError when nobody listens at a host and port; Ray itself would wait for minutes."""
    host, _, port = (address or "").removeprefix("ray://").rpartition(":")
    if port.isdigit():
        try:
            socket.create_connection((host, int(port)), timeout=10).close()
        except OSError as error:
            problem = f"no cluster answers at {{value}}: {error}"
            raise IctampError(Code.NOT_REACHABLE, problem, field="ray-address", value=address) from error


def _run_isolated(start: Start, function: Callable[..., T], arguments: tuple[Any, ...], timeout: float) -> T:
    """In Ray's own process, which must neither die nor hang: run the task in a process beside it."""
    return _pool(*start).submit(function, *arguments, timeout=timeout).result()


_kept = ExitStack()


@cache
def _pool(start: Callable[..., None], arguments: tuple[Any, ...]) -> Pool:
    """A process beside this one, which lasts as long."""
    return _kept.enter_context(start_pool(1, start, *arguments))
