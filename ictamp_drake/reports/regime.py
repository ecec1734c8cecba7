"""The folder of a run as what a report is made of: a table with a row a run, and how the runs were made."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.planning.result import StopReason
from ictamp_drake.runs.folder import CONFIG, RESULTS, read_config
from ictamp_drake.runs.records import OWN, Record, read_records
from ictamp_drake.scenes.levels import LEVELS

UNNAMED = "unnamed"
"""Strategy of records without one."""


@dataclass(frozen=True, eq=False)
class Regime:
    """Runs under equal conditions.

    Attributes:
        name: of the folder.
        runs: a row a run, see `tabulate_runs`.
        about: how they were made: what it is, and its value.
        time_limit: of every run [s]; None when it is not known or not the same for all.
    """

    name: str
    runs: pd.DataFrame
    about: dict[str, str]
    time_limit: float | None

    @property
    def strategies(self) -> list[str]:
        """In the order in which their first records were written."""
        return list(self.runs["strategy"].cat.categories)


def read_regime(folder: Path) -> Regime:
    """The finished runs of a folder.

    Raises:
        IctampError: the folder holds no records or no finished one, or a file in it is not what it should be.
    """
    if not (folder / RESULTS).is_file():
        runs = sorted(path.parent.name for path in folder.parent.glob(f"*/{RESULTS}"))
        problem = f"expected a folder that holds {RESULTS}, got {{value}}"
        raise IctampError(Code.NOT_A_RUN, problem, field="runs", value=str(folder), choices=runs)
    records = list(read_records(folder / RESULTS).values())
    finished = [record for record in records if record.stop_reason != StopReason.STOPPED.name]
    if not finished:
        problem = f"expected at least one finished problem, got {len(records)} interrupted ones"
        raise IctampError(Code.TOO_FEW_DATA, problem, file=folder / RESULTS)
    config = read_config(folder / CONFIG) if (folder / CONFIG).exists() else {}
    limits = {float(value) for value in _values(config, "time_limit") if isinstance(value, int | float)}
    limit = limits.pop() if len(limits) == 1 else None
    about = {"runs": _count_runs(records, finished), **_describe_runs(config, finished)}
    return Regime(folder.resolve().name, tabulate_runs(finished, limit), about, limit)


def tabulate_runs(records: Sequence[Record], time_limit: float | None = None) -> pd.DataFrame:
    """A row a run, sorted by level, strategy, problem and seed.

    Columns: `strategy`, `level`, `problem`, `seed`, `solved`; `seconds` until it ended, of processor time where the
    record has it, which neighbours on the machine do not lengthen; `counted`, the same, but the
    time limit for one that was not solved; `plans`, `steps`, `failed` of the steps; `length` of the plan, `duration`
    on the arm [s], `replay`, the computing time of executing it alone, `executions`, how often that was done at least,
    `pace`, the computing time of a second of it, and `paced`, the time divided by that, nan when unsolved, not known or
    of an empty plan; `interference`; and as in the record `failures`, `stages` and `depths`.
    """
    strategies = [record.strategy or UNNAMED for record in records]
    levels = [record.level or OWN for record in records]
    runs = pd.DataFrame(
        {
            "strategy": pd.Categorical(strategies, list(dict.fromkeys(strategies))),
            "level": pd.Categorical(levels, sorted(set(levels), key=_rank)),
            "problem": [record.problem for record in records],
            "seed": [record.seed for record in records],
            "solved": [record.solved for record in records],
            "seconds": [
                record.planning_time_s if record.cpu_time_s is None else record.cpu_time_s for record in records
            ],
            "plans": [record.high_level_plans for record in records],
            "steps": [record.low_level_steps for record in records],
            "failed": [sum(record.failures.values()) for record in records],
            "length": [_number(record.plan_length) for record in records],
            "duration": [_number(record.plan_duration_s) for record in records],
            "replay": [_number(record.replay_time_s) for record in records],
            "executions": [2 if record.cpu_time_s is None else 1 for record in records],
            "interference": [record.interference for record in records],
            "failures": [record.failures for record in records],
            "stages": [record.seconds_by_stage for record in records],
            "depths": [record.steps_by_depth for record in records],
        }
    )
    runs["pace"] = runs["replay"] / runs["duration"].where(runs["duration"] > 0)
    runs["paced"] = runs["seconds"] / runs["pace"]
    runs["counted"] = runs["seconds"] if time_limit is None else runs["seconds"].where(runs["solved"], time_limit)
    return runs.sort_values(["level", "strategy", "problem", "seed"], ignore_index=True)


def _number(value: float | None) -> float:
    return np.nan if value is None else value


def _rank(level: str) -> tuple[int, str]:
    """Easy to hard, and then all others."""
    return ([*LEVELS, level].index(level), level)


def _values(config: Any, key: str) -> Iterator[Any]:
    """All values of a key, however deep it is."""
    if isinstance(config, dict):
        yield from [config[key]] if key in config else []
        for value in config.values():
            yield from _values(value, key)
    elif isinstance(config, list):
        for value in config:
            yield from _values(value, key)


def _count_runs(records: Sequence[Record], finished: Sequence[Record]) -> str:
    broken = sum(record.error is not None and not record.solved for record in finished)
    stopped = len(records) - len(finished)
    parts = [str(len(finished))]
    parts += [f"{broken} of them broke down and count as unsolved"] if broken else []
    parts += [f"{stopped} more were interrupted and are left out"] if stopped else []
    return "; ".join(parts)


def _describe_runs(config: dict[str, Any], records: Sequence[Record]) -> dict[str, str]:
    """Program, commit, machine, load and limits; no paths, which differ between machines."""
    load = [record.load[0] for record in records if record.load]
    named = {
        "program": _list_values(config, "program"),
        "commit": re.sub(r"\b([0-9a-f]{10})[0-9a-f]{30}\b", r"\1", _list_values(config, "commit")),
        "drake": _list_values(config, "drake"),
        "cores": _list_values(config, "cores"),
        "workers": _list_values(config, "workers"),
        "load": f"{np.median(load):.1f} ({min(load):.1f} to {max(load):.1f})" if load else "",
        "time limit of a run [s]": _list_values(config, "time_limit"),
        "limit of low-level steps": _list_values(config, "max_steps"),
        "seeds": ", ".join(str(seed) for seed in sorted({record.seed for record in records})),
    }
    return {name: value or "not known" for name, value in named.items()}


def _list_values(config: dict[str, Any], key: str) -> str:
    """Its different values, in order of appearance; empty when there is none."""
    shown = (
        "none" if value is None else f"{value:g}" if isinstance(value, float) else str(value)
        for value in _values(config, key)
    )
    return ", ".join(dict.fromkeys(shown))
