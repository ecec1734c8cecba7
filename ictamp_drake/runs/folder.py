"""The folder of a run: a new one, or an unfinished one that is continued.

`config.yaml` holds what decides how problems are solved (`program`, what it works on, and `options`), and for each time
that the run was started or continued one entry of `sessions`: when, how it was carried out, commit, versions, machine.
"""

import dataclasses
import fcntl
import json
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import Any

import yaml

from ictamp_drake.core.errors import IctampError
from ictamp_drake.runs.files import write_whole
from ictamp_drake.runs.options import Conduct, Method
from ictamp_drake.runs.provenance import provenance
from ictamp_drake.runs.records import drop_torn_line

RUNS = Path("runs")
"""Where runs go that are not told otherwise."""

CONFIG = "config.yaml"
RESULTS = "results.jsonl"


@contextmanager
def opened(name: str, work: Mapping[str, Any], method: Method, conduct: Conduct) -> Iterator[Path]:
    """The folder of a run, made or found again, for this process alone.

    Args:
        name: of new folders, followed by the time.
        work: what the run is about, e.g. program and level; with the method, what must agree when it is continued.
        method: how problems are solved.
        conduct: says where the folder is.

    Raises:
        IctampError: when the folder is not a run, is a run of something else, or is in use.
    """
    fixed = _plain({**work, "options": dataclasses.asdict(method)})
    path = _path(name, conduct)
    sessions = _sessions(path, fixed)
    path.mkdir(parents=True, exist_ok=True)
    with locked(path):
        drop_torn_line(path / RESULTS)
        now = datetime.now().astimezone().isoformat(timespec="seconds")
        session = {"started": now, "conduct": _plain(dataclasses.asdict(conduct)), **provenance()}
        write_whole(path / CONFIG, yaml.safe_dump({**fixed, "sessions": [*sessions, session]}, sort_keys=False))
        yield path


def _path(name: str, conduct: Conduct) -> Path:
    if conduct.out is not None:
        if conduct.resume and not (conduct.out / CONFIG).exists():
            raise IctampError(f"{conduct.out}: there is no run to resume; leave --resume out to start one there")
        return conduct.out
    if conduct.resume:
        runs = sorted(RUNS.glob(f"{name}-*/{CONFIG}"), key=lambda path: path.stat().st_mtime)
        if not runs:
            raise IctampError(f"{RUNS / name}-*: there is no run to resume; leave --resume out to start one")
        return runs[-1].parent
    return RUNS / f"{name}-{datetime.now():%Y%m%d-%H%M%S}"


def _sessions(path: Path, fixed: Mapping[str, Any]) -> list[Any]:
    """The sessions of the run to be continued, none for a new folder."""
    if not (path / CONFIG).exists():
        if path.exists() and (not path.is_dir() or any(path.iterdir())):
            raise IctampError(
                f"{path}: exists and is not the folder of a run (it has no {CONFIG}); choose another --out"
            )
        return []
    config = yaml.safe_load((path / CONFIG).read_text(encoding="utf-8"))
    before, now = _flat({key: config.get(key) for key in fixed}), _flat(fixed)
    for key in [*now, *before]:
        if before.get(key) != now.get(key):
            was, new = (json.dumps(values.get(key)) for values in (before, now))
            raise IctampError(
                f"{path}: cannot be continued with {_option(key)} {new}, since it was made with {was}; "
                f"take that value or another --out"
            )
    return list(config["sessions"])


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """This process alone works in the folder, until it ends, however it ends.

    Raises:
        IctampError: another process does.
    """
    with (path / ".lock").open("w") as lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            raise IctampError(
                f"{path}: another process is at work in this folder; wait for it or choose another --out"
            ) from error
        yield


def _plain(values: Any) -> Any:
    """The same in the types of YAML."""
    return json.loads(json.dumps(values, default=str))


def _flat(values: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, value in values.items():
        flat |= _flat(value, f"{prefix}{key}.") if isinstance(value, dict) else {prefix + key: value}
    return flat


def _option(key: str) -> str:
    """How a value of the configuration is written on the command line."""
    return "--" + key.removeprefix("options.").replace("_", "-") if key.startswith("options.") else key
