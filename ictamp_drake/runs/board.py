"""Live progress of the workers in shared memory without locks.

A worker can be ended at any moment, and a lock or queue that it held would then stop all others. Without locks, the
worst case is a number on the screen that is wrong for a moment.
"""

import ctypes
import time
from collections.abc import Callable, Iterator
from multiprocessing.context import SpawnContext
from typing import NamedTuple

from ictamp_drake.planning.events import Event, PlanFound, PlanOpened, StepDone, StepStarted, Verified

_TEXT = 80


def _ignore() -> None:
    """Do nothing, since the process that shows the board polls it."""


class _Slot(ctypes.Structure):
    _fields_ = (
        ("running", ctypes.c_bool),
        ("started", ctypes.c_double),
        ("plans", ctypes.c_int),
        ("steps", ctypes.c_int),
        ("doing", ctypes.c_char * _TEXT),
        ("found", ctypes.c_int),
        ("best", ctypes.c_char * _TEXT),
    )


class Running(NamedTuple):
    """Problem that is being solved.

    Attributes:
        slot: Number of the problem.
        seconds: Time since its start [s].
        plans: Number of high-level plans opened.
        steps: Number of low-level steps done.
        doing: Text about the current activity.
        found: Number of plans found, while the search goes on for a better one.
        best: Text about the best plan.
    """

    slot: int
    seconds: float
    plans: int
    steps: int
    doing: str
    found: int
    best: str


class Board:
    """One slot for each problem, and a stop flag.

    Attributes:
        watch: Function that is called each time that a search in this process finds a plan and goes on.
    """

    def __init__(self, context: SpawnContext, count: int) -> None:
        self.watch: Callable[[], None] = _ignore
        self._slots = context.RawArray(_Slot, count)
        self._stopping = context.RawValue(ctypes.c_bool, False)
        self._url = context.RawArray(ctypes.c_char, _TEXT)

    @property
    def stopping(self) -> bool:
        """Whether all workers should stop."""
        return bool(self._stopping.value)

    def stop(self) -> None:
        """Ask all workers to stop."""
        self._stopping.value = True

    @property
    def url(self) -> str:
        """Address of the live view, or an empty string without one."""
        return bytes(self._url.value).decode()

    @url.setter
    def url(self, address: str) -> None:
        self._url.value = address.encode()

    def start(self, slot: int) -> None:
        """Mark the start of the work on a problem."""
        here = self._slots[slot]
        here.started, here.plans, here.steps, here.found = time.monotonic(), 0, 0, 0
        self._say(slot, "loading the scene")
        here.running = True

    def finish(self, slot: int) -> None:
        """Mark the end of the work on a problem."""
        self._slots[slot].running = False

    def seconds(self, slot: int) -> float:
        """Time since the work on a problem began [s], or 0 if it never did."""
        started = self._slots[slot].started
        return time.monotonic() - started if started else 0.0

    def tell(self, slot: int, event: Event) -> None:
        """Show an event."""
        here = self._slots[slot]
        match event:
            case PlanOpened():
                here.plans += event.plan is not None
            case StepStarted():
                self._say(slot, str(event.action))
            case StepDone():  # the next step begins at once, so these texts remain only if there is none
                here.steps += 1
                self._say(slot, "looking for a plan" if event.child is None else "verifying the plan")
            case Verified():
                self._say(slot, "writing" if event.verified else "looking for a plan")
            case PlanFound():
                skills, duration = len(event.path), sum(attempt.duration for attempt in event.path)
                text = f"{skills} skills, {duration:.1f} s long, found after {event.seconds:.1f} s of search"
                here.best = text.encode()[: _TEXT - 1]
                here.found += 1
                self.watch()

    def _say(self, slot: int, text: str) -> None:
        self._slots[slot].doing = text.encode()[: _TEXT - 1]

    def list_running(self) -> Iterator[Running]:
        """Yield the problems that are being solved now."""
        for number, slot in enumerate(self._slots):
            if slot.running:
                doing, best = slot.doing.decode(errors="replace"), slot.best.decode(errors="replace")
                yield Running(number, self.seconds(number), slot.plans, slot.steps, doing, slot.found, best)
