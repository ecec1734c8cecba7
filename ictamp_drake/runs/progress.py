"""Progress display of a run: a line for each finished problem and, in a terminal, the current activity."""

import time
from collections.abc import Sequence
from types import TracebackType

from rich.console import Console, Group
from rich.live import Live
from rich.table import Table
from rich.text import Text

from ictamp_drake.planning.result import StopReason
from ictamp_drake.runs.board import Board, Running
from ictamp_drake.runs.records import Record

REFRESH = 5.0
"""Refresh rate of the current activity [1/s]."""


class Progress:
    """Shows the progress of a sweep on a console. Without a terminal it only prints a line for each finished problem.

    Args:
        console: Console to print on.
        names: Names of the problems, by slot.
        total: Number of problems in the run, including those finished in earlier sessions.
        solved: Number of problems solved in earlier sessions.
    """

    def __init__(self, console: Console, names: Sequence[str], total: int, solved: int) -> None:
        self._console = console
        self._names = names
        self._total = total
        self._earlier = total - len(names)
        self._solved_earlier = solved
        self._records: dict[str, Record] = {}
        self._told: dict[int, int] = {}
        self._board: Board | None = None
        self._start = time.monotonic()
        self._live = (
            Live(console=console, get_renderable=self._now, refresh_per_second=REFRESH, transient=True)
            if console.is_terminal
            else None
        )

    def __enter__(self) -> "Progress":
        if self._live is not None:
            self._live.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        if self._live is not None:
            self._live.stop()

    def __call__(self, board: Board, records: Sequence[Record]) -> None:
        """Show new records, and new plans of searches that go on, and refresh the display. See `sweep.Watch`."""
        self._board = board
        for running in board.list_running():
            if running.found > self._told.get(running.slot, 0):
                self._told[running.slot] = running.found
                self._console.print(f"{self._names[running.slot]}  {running.best}", soft_wrap=True)
        for record in records:
            self._records[record.name] = record
            self._console.print(outcome(record), soft_wrap=True)
        if self._live is not None:
            self._live.refresh()

    @property
    def _done(self) -> int:
        return self._earlier + sum(record.is_final for record in self._records.values())

    @property
    def _solved(self) -> int:
        return self._solved_earlier + sum(record.solved for record in self._records.values())

    def _now(self) -> Group:
        """Render the current activity. Another thread calls this, since this one may be busy with a problem."""
        board = self._board
        if board is None:
            return Group()
        running = list(board.list_running())
        table = Table.grid(padding=(0, 2))
        for row in running:
            table.add_row(*self._row(row))
        address = [Text(f"live view at {board.url}")] if board.url else []
        return Group(Text(), self._heading(board), *address, table)

    def _heading(self, board: Board) -> Text:
        left = self._total - self._done
        text = f"{self._done} of {self._total} done, {self._solved} solved, {left} left, {format_clock(self._elapsed)}"
        if left and self._done > self._earlier:
            text += f", about {format_clock(self._elapsed / (self._done - self._earlier) * left)} to go"
        return Text(text + (", stopping after the steps under way" if board.stopping else ""), style="bold")

    @property
    def _elapsed(self) -> float:
        return time.monotonic() - self._start

    def _row(self, running: Running) -> tuple[str, str, str, str, str]:
        plans, steps = format_count(running.plans, "plan"), format_count(running.steps, "step")
        return f"  {self._names[running.slot]}", plans, steps, format_clock(running.seconds), running.doing


def outcome(record: Record) -> Text:
    """Format one line about a finished problem."""
    effort = f"{format_count(record.high_level_plans, 'plan')}, {format_count(record.low_level_steps, 'step')}"
    after = f"after {record.planning_time_s:.1f} s ({effort})"
    if record.solved and not record.plan_length:
        line = Text(f"{record.name}  nothing to do: the goal holds at the start", "green")
    elif record.solved:
        first = int(record.found[0][0]) if record.found else record.plan_length or 0
        line = Text(f"{record.name}  solved with {format_count(first, 'skill')} {after}", "green")
        if record.found[1:]:
            skills, duration, seconds = record.found[-1]
            best = f"{format_count(int(skills), 'skill')} that take {duration:.1f} s"
            line.append(f", improved from {record.found[0][1]:.1f} s to {best} after {seconds:.1f} s")
    elif record.error is None:
        line = Text(f"{record.name}  not solved {after}: {StopReason[record.stop_reason]}", "yellow")
    else:
        line = Text(f"{record.name}  {record.stop_reason.lower()} {after}", "bold red")
    if record.error is not None:
        line.append(f": {record.error.strip().splitlines()[-1]}")
    return line


def format_count(number: int, noun: str) -> str:
    """Format a number with its noun, e.g. 1 plan, 2 plans."""
    return f"{number} {noun}{'' if number == 1 else 's'}"


def format_clock(seconds: float) -> str:
    """Format a duration [s], e.g. 0:07, 12:30, 1:02:03."""
    minutes, rest = divmod(int(seconds), 60)
    hours, minutes = divmod(minutes, 60)
    return f"{hours}:{minutes:02}:{rest:02}" if hours else f"{minutes}:{rest:02}"
