"""index.html of a run's folder, an overview of the run's results."""

import os
import time
from collections.abc import Sequence
from pathlib import Path
from urllib.parse import quote

from ictamp_drake.runs.folder import INDEX, RESULTS
from ictamp_drake.runs.records import OWN, Record, read_records
from ictamp_drake.tamp.explanation import Explanation
from ictamp_drake.viz.index_page import Entry, index_html

EVERY = 5.0
"""Minimum time between two updates of the page during a run [s]."""

LINKS = {"replay": "replay.html", "search": "search.html", "plan": "plan.yaml", "scene": "scene.yaml"}
"""Labels of the links to a problem's files, and the names of these files."""


class Index:
    """The page and the records that it shows. A failure to write the page does not affect the run.

    Args:
        folder: Folder of the run.
        names: Names of the run's problems.

    Attributes:
        path: File of the page.
        error: Error of the last attempt to write the page; None when it succeeded.
    """

    def __init__(self, folder: Path, names: Sequence[str]) -> None:
        self.path = folder / INDEX
        self.error: Exception | None = None
        self._names = names
        self._records = read_records(folder / RESULTS)
        self._stale = False
        self._due = 0.0

    def add(self, records: Sequence[Record]) -> None:
        """Add new records, and write the page unless it was written a moment ago."""
        self._records |= {record.name: record for record in records}
        self._stale |= bool(records)
        if self._stale and time.monotonic() >= self._due:
            self.write()

    def write(self) -> None:
        """Write the page, or keep the error if that fails."""
        folder = self.path.parent
        waiting = sum(name not in self._records for name in self._names)
        try:
            entries = [_entry(record, folder) for record in self._records.values()]
            index_html(folder.resolve().name, entries, waiting, self.path)
            self.error = None
        except Exception as error:
            self.error = error
        self._stale = False
        self._due = time.monotonic() + EVERY


def _entry(record: Record, folder: Path) -> Entry:
    files = _files(folder / record.name)
    explanation = record.explanation
    return Entry(
        problem=record.problem,
        level=record.level or OWN,
        strategy=record.strategy,
        seed=record.seed,
        solved=record.solved,
        reason="" if record.solved else explanation.reason,
        details=_details(record, explanation),
        error=record.error or "",
        seconds=record.planning_time_s,
        skills=record.plan_length,
        steps=record.low_level_steps,
        picture=_address(record, "scene.png") if "scene.png" in files else "",
        links={name: _address(record, file) for name, file in LINKS.items() if file in files},
    )


def _details(record: Record, explanation: Explanation) -> tuple[str, ...]:
    if record.error is not None:
        return ()
    if record.solved:
        return () if record.torque is None else (str(record.torque),)
    return tuple(explanation.lines())


def _files(folder: Path) -> set[str]:
    try:
        return {path.name for path in folder.iterdir()}
    except OSError:
        return set()


def _address(record: Record, file: str) -> str:
    """Address of a problem's file, relative to the page; names may contain any characters of a file system."""
    return quote(os.fsencode(f"{record.name}/{file}"))
