"""Invented records of runs, for tests of their evaluation."""

from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import Any

import pandas as pd
import yaml

from ictamp_drake.reports.regime import tabulate_runs
from ictamp_drake.runs.folder import CONFIG, RESULTS
from ictamp_drake.runs.records import Record, append

LIMIT = 60.0
CONDITIONS = {
    "program": "runner",
    "options": {"time_limit": LIMIT, "max_steps": None},
    "sessions": [
        {
            "started": "2026-11-24T13:30:59+00:00",
            "conduct": {"out": "/somewhere/else", "workers": 2},
            "commit": f"9760efb315{30 * '0'}-dirty",
            "versions": {"drake": "1.51.1"},
            "host": {"cores": 2, "platform": "Linux"},
        }
    ],
}


def run(strategy: str, number: int = 0, seconds: float = 4.0, **values: Any) -> Record:
    """A solved run of an easy problem; with `solved=False`, a run that reached the time limit."""
    solved = values.pop("solved", True)
    steps = values.pop("low_level_steps", 6)
    level = values.pop("level", "easy")
    return Record(
        problem=f"{level}-{number:03d}",
        strategy=strategy,
        level=level,
        seed=values.pop("seed", 0),
        solved=solved,
        stop_reason=values.pop("stop_reason", "SOLVED" if solved else "OUT_OF_TIME"),
        planning_time_s=seconds,
        low_level_steps=steps,
        plan_length=6 if solved else None,
        **{
            "high_level_plans": 1,
            "seconds_by_stage": {"setup": 0.5, "motion": 1.5, "physics": seconds - 2},
            "steps_by_depth": (steps - 1, 1),
            "load": (2.0, 1.5, 1.0),
            **values,
        },
    )


def table(*records: Record, time_limit: float | None = LIMIT) -> pd.DataFrame:
    """Records as the table that reports use."""
    return tabulate_runs(records, time_limit)


def folder_of(folder: Path, records: Iterable[Record], config: Mapping[str, Any] | None = CONDITIONS) -> Path:
    """Folder of a run with the records, and with its configuration if given."""
    folder.mkdir(parents=True)
    (folder / RESULTS).touch()
    for record in records:
        append(record, folder / RESULTS)
    if config is not None:
        (folder / CONFIG).write_text(yaml.safe_dump(config))
    return folder
