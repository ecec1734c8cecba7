"""Engines that run tasks: isolated processes on this machine or on a Ray cluster, or this process itself."""

import os
from collections.abc import Callable, Iterator
from concurrent.futures import Future
from contextlib import contextmanager
from dataclasses import dataclass
from importlib.util import find_spec
from typing import Any, Literal, Protocol, TypeVar

from ictamp_drake.core.checks import check_range
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.runs.inline import start_inline
from ictamp_drake.runs.pool import start_pool

T = TypeVar("T")


class Engine(Protocol):
    """Runner of tasks."""

    def submit(self, function: Callable[..., T], *arguments: Any, timeout: float) -> Future[T]:
        """Run a function and return the future of its result.

        The future raises TimeoutError after `timeout` [s], and another exception if the function or its process dies.
        """


@dataclass(frozen=True)
class EngineConfig:
    """Options of the engine that runs tasks.

    Attributes:
        engine: Engine that runs the tasks: processes on this machine (local), or on a Ray cluster with one process per
            core (ray, needs `pip install "ictamp_drake[ray]"`).
        workers: Number of processes on this machine.
        ray_address: Address of the Ray cluster, e.g. 10.0.0.1:6379. By default RAY_ADDRESS, a cluster that already runs
            on this machine, or a new one.
    """

    engine: Literal["local", "ray"] = "local"
    workers: int = min(2, os.cpu_count() or 1)
    ray_address: str | None = None

    def __post_init__(self) -> None:
        check_range("workers", self.workers, 1, 1024)

    def check(self) -> None:
        """Raise IctampError when the engine is not installed."""
        if self.engine == "ray" and find_spec("ray") is None:
            advice = 'run pip install "ictamp_drake[ray]"'
            raise IctampError(Code.NOT_INSTALLED, "ray is not installed", field="engine", value="ray", advice=advice)

    def count_local_workers(self, tasks: int) -> int:
        """Number of processes on this machine for a number of tasks."""
        return min(self.workers, tasks) if self.engine == "local" else 0

    def is_inline(self, alone: bool) -> bool:
        """Whether tasks run in this process. See `start`."""
        return alone and self.engine == "local"

    @contextmanager
    def start(self, tasks: int, start: Callable[..., None], *arguments: Any, alone: bool = False) -> Iterator[Engine]:
        """Start the engine. It stops at the end of the block.

        Args:
            tasks: Expected number of tasks, which also limits the number of workers.
            start: Function called with `arguments` in each process before its first task. It calls `end_with_parent`.
            *arguments: Arguments of `start`.
            alone: Whether local tasks run in this process, where a task that dies takes all others with it.
        """
        if self.is_inline(alone):
            with start_inline(start, *arguments) as process:
                yield process
        elif self.engine == "local":
            with start_pool(self.count_local_workers(tasks), start, *arguments) as pool:
                yield pool
        else:
            from ictamp_drake.runs.cluster import connect_cluster  # noqa: PLC0415  (an optional package)

            with connect_cluster(self.ray_address, start, *arguments) as cluster:
                yield cluster
