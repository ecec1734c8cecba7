"""Input of a report, read from a folder of runs: a table with one row per run, and the conditions of the runs."""

import re
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import pandas as pd

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.planning.result import StopReason
from ictamp_drake.robots.spec import DEFAULT
from ictamp_drake.runs.folder import CONFIG, RESULTS, read_config
from ictamp_drake.runs.records import OWN, Record, read_records
from ictamp_drake.scenes.levels import LEVELS

UNNAMED = "unnamed"
"""Name of the strategy of records without one."""


@dataclass(frozen=True, eq=False)
class Regime:
    """Runs under equal conditions.

    Attributes:
        name: Name of the folder.
        runs: Table with one row per run, see `tabulate_runs`.
        about: Conditions of the runs, as names and values.
        time_limit: Time limit of every run [s]; None when it is not known or not the same for all.
    """

    name: str
    runs: pd.DataFrame
    about: dict[str, str]
    time_limit: float | None

    @property
    def strategies(self) -> list[str]:
        """Names of the strategies, in the order in which their first records were written."""
        return list(self.runs["strategy"].cat.categories)


def read_regime(folder: Path) -> Regime:
    """Read the finished runs of a folder.

    Raises:
        IctampError: The folder holds no records or no finished run, or a file in it is invalid.
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
    """Tabulate the records with one row per run, sorted by level, strategy, problem and seed.

    Columns:
    `strategy`, `level`, `problem`, `seed`, `solved`.
    `seconds` until the run ended, in processor time where the record has it: other processes do not lengthen it.
    `counted`, equal to `seconds`, but to the time limit for an unsolved run.
    `plans` and `steps`; `failed`, the number of failed steps.
    `executions`, minimum number of times that the plan was executed.
    `length` of the plan; `duration` on the arm [s]; `replay`, computing time of executing the plan alone [s]; `pace`,
    computing time for a second of the plan; `paced`, `seconds` divided by `pace`. These are nan when unsolved or not
    known, `pace` and `paced` also for an empty plan.
    `interference`; and, as in the record, `failures`, `stages` and `depths`.
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
    """Rank of a level: easy to hard, then all others by name."""
    return ([*LEVELS, level].index(level), level)


def _values(config: Any, key: str) -> Iterator[Any]:
    """All values of a key, at any depth."""
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
    """Describe program, commit, machine, load and limits, but no paths, which differ between machines."""
    load = [record.load[0] for record in records if record.load]
    named = {
        "program": _list_values(config, "program"),
        **_describe_robots(records),
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


def _describe_robots(records: Sequence[Record]) -> dict[str, str]:
    """Name the robots, and the parts that served in place of those chosen, unless all is as by default."""
    robots = sorted({record.robot for record in records})
    served = sorted({f"{option} {name}" for record in records for option, name in record.stand_ins.items()})
    names = ", ".join(Path(name).name for name in robots)
    return {} if robots == [DEFAULT] else {"robot": f"{names} ({', '.join(served)})" if served else names}


def _list_values(config: dict[str, Any], key: str) -> str:
    """List the different values of a key, in order of appearance; empty when there are none."""
    shown = (
        "none" if value is None else f"{value:g}" if isinstance(value, float) else str(value)
        for value in _values(config, key)
    )
    return ", ".join(dict.fromkeys(shown))
