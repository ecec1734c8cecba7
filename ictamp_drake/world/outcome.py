"""What a simulation leaves: where it ended, what was executed, and the states on the way."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ictamp_drake.core.types import Configuration, FloatArray, Motion, Recording


@dataclass(frozen=True)
class Outcome:
    """Where a simulation ended.

    Attributes:
        c: the last configuration.
        settled: whether everything came to rest in time.
        stopped_after: label of the segment after which the watcher ended it, None when it ran to the end.
        motion: what was executed. Unless the watcher ended it, the arm stands still at its end until the hand has
            obeyed, all is at rest and a whole number of time steps is over.
        recording: states on the way, none but the first when they were not to be kept; None when nothing was simulated.
    """

    c: Configuration
    settled: bool
    stopped_after: str | None
    motion: Motion
    recording: Recording | None


class Frame(NamedTuple):
    """A moment of a recorded simulation: time from its start [s] and what is there."""

    time: float
    c: Configuration


class Tape:
    """States on the way of an execution."""

    def __init__(self, time_step: float, record: bool) -> None:
        self._time_step = time_step
        self._record = record
        self._times: list[float] = []
        self._states: list[FloatArray] = []

    def add(self, step: int, x: FloatArray) -> None:
        """Keep the state at a step if states are to be kept; the first always is."""
        if self._record or not self._states:
            self._times.append(step * self._time_step)
            self._states.append(x)

    @property
    def recording(self) -> Recording:
        """What was kept."""
        return Recording(np.array(self._times), np.array(self._states))
