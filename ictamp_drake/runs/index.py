"""index.html of a run's folder, for people who look at what the run found."""

import os
import time
from collections.abc import Sequence
from pathlib import Path
from urllib.parse import quote

from ictamp_drake.runs.folder import RESULTS
from ictamp_drake.runs.records import OWN, Record, read_records
from ictamp_drake.viz.index_page import Entry, index_html

INDEX = "index.html"

EVERY = 5.0
"""Least time between two pages of a run that is at work [s]."""

LINKS = {"replay": "replay.html", "search": "search.html", "plan": "plan.yaml", "scene": "scene.yaml"}
"""Files of a problem that the page leads to, and what they are called there."""


class Index:
    """The page and the records that it shows. A page that cannot be written costs nothing else.

    Args:
        folder: of the run.
        names: of the problems that are to be done.

    Attributes:
        path: of the page.
        error: why it could not be written the last time, else None.
    """

    def __init__(self, folder: Path, names: Sequence[str]) -> None:
        self.path = folder / INDEX
        self.error: Exception | None = None
        self._names = names
        self._records = read_records(folder / RESULTS)
        self._stale = False
        self._due = 0.0

    def add(self, records: Sequence[Record]) -> None:
        """Take new records, and write the page unless that was done just now."""
        self._records |= {record.name: record for record in records}
        self._stale |= bool(records)
        if self._stale and time.monotonic() >= self._due:
            self.write()

    def write(self) -> None:
        """Write the page, or note why that failed."""
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
        details=() if record.solved or record.error is not None else tuple(explanation.lines()),
        error=record.error or "",
        seconds=record.planning_time_s,
        skills=record.plan_length,
        steps=record.low_level_steps,
        picture=_address(record, "scene.png") if "scene.png" in files else "",
        links={name: _address(record, file) for name, file in LINKS.items() if file in files},
    )


def _files(folder: Path) -> set[str]:
    try:
        return {path.name for path in folder.iterdir()}
    except OSError:
        return set()


def _address(record: Record, file: str) -> str:
    """Of a file of a problem, relative to the page; names may contain anything that a file system takes."""
    return quote(os.fsencode(f"{record.name}/{file}"))
