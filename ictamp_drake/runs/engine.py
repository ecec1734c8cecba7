"""Where tasks run: in processes of this machine or of a Ray cluster, each of which can die alone, or in this one."""

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
    """Runs tasks."""

    def submit(self, function: Callable[..., T], *arguments: Any, timeout: float) -> Future[T]:
        """What the function will return; TimeoutError after so many seconds, another exception if it dies."""


@dataclass(frozen=True)
class EngineConfig:
    """Where tasks run.

    Attributes:
        engine: local, processes of this machine; ray, those of a Ray cluster, one a core (`pip install
            "ictamp_drake[ray]"`).
        workers: processes of this machine.
        ray_address: of the cluster, e.g. 10.0.0.1:6379; by default RAY_ADDRESS, a cluster that runs on this machine,
            or a new one on it.
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
        """Number of processes of this machine that so many tasks are given to."""
        return min(self.workers, tasks) if self.engine == "local" else 0

    def is_inline(self, alone: bool) -> bool:
        """Whether tasks run in this process, see `start`."""
        return alone and self.engine == "local"

    @contextmanager
    def start(self, tasks: int, start: Callable[..., None], *arguments: Any, alone: bool = False) -> Iterator[Engine]:
        """The engine at work, which ends with the block.

        Args:
            tasks: so many are expected; no more workers are started.
            start: called in each process with the arguments before its first task; calls `end_with_parent`.
            alone: whether tasks of this machine run in this process, where one that dies takes all others with it.
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
