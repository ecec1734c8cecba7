"""Computing time by stage."""

import time
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from types import MappingProxyType


class Stopwatch:
    """Add up the computing time of named stages, by default the processor time of this process.

    Args:
        clock: Function that returns the time from any origin [s].
        seconds: Initial times of the stages [s].
    """

    def __init__(
        self, clock: Callable[[], float] = time.process_time, seconds: Mapping[str, float] = MappingProxyType({})
    ) -> None:
        self._clock = clock
        self._seconds = dict(seconds)

    @property
    def seconds(self) -> dict[str, float]:
        """Copy of the times by stage [s]."""
        return self._seconds.copy()

    @contextmanager
    def stage(self, name: str) -> Iterator[None]:
        """Add the block's time to the stage."""
        start = self._clock()
        try:
            yield
        finally:
            self._seconds[name] = self._seconds.get(name, 0.0) + self._clock() - start
