"""Tasks on a Ray cluster. If a node dies, its tasks run again on another node. Each result arrives once."""

import logging
import os
import socket
import sys
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
"""Maximum number of times that a task may be lost with its node."""


class Cluster:
    """Processes on all nodes, one per core. See `engine.Engine`."""

    def __init__(self, start: Start) -> None:
        self._start = ray.put(start)
        self._task: Any = ray.remote(num_cpus=1, max_retries=RETRIES)(_run_isolated)

    def submit(self, function: Callable[..., T], *arguments: Any, timeout: float) -> Future[T]:
        """Run a function in a process of the cluster.

        The future raises TimeoutError after `timeout` [s], and another exception when the process dies.
        """
        return self._task.remote(self._start, function, arguments, timeout).future()


@contextmanager
def connect_cluster(address: str | None, start: Callable[..., None], *arguments: Any) -> Iterator[Cluster]:
    """Connect to a cluster. The end of the block closes the connection and ends all unfinished tasks.

    Raises:
        IctampError: There is no cluster at the address.
    """
    _knock(address)
    _join_or_start(address)
    try:
        yield Cluster((start, arguments))
    finally:
        ray.shutdown()


def _join_or_start(address: str | None) -> None:
    """Connect to the cluster at the address or, by default, at RAY_ADDRESS or on this machine; else start one here."""
    quiet: dict[str, Any] = {"log_to_driver": False, "logging_level": logging.ERROR}
    try:
        ray.init(address=address or "auto", **quiet)
    except ConnectionError:
        if address or os.environ.get("RAY_ADDRESS"):
            raise
        print(OPEN_PORTS, file=sys.stderr)
        ray.init(address="local", include_dashboard=False, **quiet)


OPEN_PORTS = (
    "No Ray cluster runs here, so one is started. Its ports listen on all network interfaces of this machine, and only "
    "Ray's token (~/.ray/auth_token) keeps others from running code here; --engine local opens no port."
)
"""Warning before a cluster is started."""


def _knock(address: str | None) -> None:
    """Raise IctampError when nothing listens at the host and port. Ray itself would wait for minutes."""
    host, _, port = (address or "").removeprefix("ray://").rpartition(":")
    if port.isdigit():
        try:
            socket.create_connection((host, int(port)), timeout=10).close()
        except OSError as error:
            problem = f"no cluster answers at {{value}}: {error}"
            raise IctampError(Code.NOT_REACHABLE, problem, field="ray-address", value=address) from error


def _run_isolated(start: Start, function: Callable[..., T], arguments: tuple[Any, ...], timeout: float) -> T:
    """Run the task in a process beside Ray's own process, which must neither die nor hang."""
    return _pool(*start).submit(function, *arguments, timeout=timeout).result()


_kept = ExitStack()


@cache
def _pool(start: Callable[..., None], arguments: tuple[Any, ...]) -> Pool:
    """Return a process beside this one, which lives as long as this one."""
    return _kept.enter_context(start_pool(1, start, *arguments))
