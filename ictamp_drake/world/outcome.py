"""Results of a simulation: the final configuration, the executed motion, and the states on the way."""

from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from ictamp_drake.core.types import Configuration, FloatArray, Motion, Recording


@dataclass(frozen=True)
class Outcome:
    """Result of a simulation.

    Attributes:
        c: Final configuration.
        settled: Whether everything came to rest in time.
        stopped_after: Label of the segment after which the watcher ended the simulation. None when it ran to the end.
        motion: Executed motion. Unless the watcher ended it, the arm stands still at the end until the hand has obeyed,
            all boxes are at rest, and a whole number of time steps is over.
        recording: States on the way; only the first one without recording. None when nothing was simulated.
    """

    c: Configuration
    settled: bool
    stopped_after: str | None
    motion: Motion
    recording: Recording | None


class Frame(NamedTuple):
    """Moment of a recorded simulation: time since its start [s] and configuration."""

    time: float
    c: Configuration


class Tape:
    """Recorder of the states during an execution."""

    def __init__(self, time_step: float, record: bool) -> None:
        self._time_step = time_step
        self._record = record
        self._times: list[float] = []
        self._states: list[FloatArray] = []

    def add(self, step: int, x: FloatArray) -> None:
        """Keep the state at a step if recording is on. The first state is always kept."""
        if self._record or not self._states:
            self._times.append(step * self._time_step)
            self._states.append(x)

    @property
    def recording(self) -> Recording:
        """Recorded times and states."""
        return Recording(np.array(self._times), np.array(self._states))
