"""The folder of a run: a new one, or an unfinished one that is continued.

`config.yaml` holds what decides how problems are solved (`program`, what it works on, and `options`, or those of
several `strategies`, and the `scenes` of a user's own), and for each time that the run was started or continued one
entry of `sessions`: when, how it was carried out, commit, versions, machine.
"""

import dataclasses
import fcntl
import glob
import json
import re
from collections.abc import Iterator, Mapping
from contextlib import contextmanager
from datetime import datetime
from pathlib import Path
from typing import Any

import yaml

from ictamp_drake.core.decoding import mapping
from ictamp_drake.core.errors import Code, IctampError, show
from ictamp_drake.core.files import make_folder, not_writable, shorten_path, write_whole
from ictamp_drake.core.reading import in_file, parse, read_text
from ictamp_drake.core.spelling import TODAY, respell_options
from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.provenance import provenance
from ictamp_drake.runs.records import drop_torn_line

RUNS = Path("runs")
"""Where runs go that are not told otherwise."""

CONFIG = "config.yaml"
RESULTS = "results.jsonl"
INDEX = "index.html"

WIDENED = ("strategies", "scenes")
"""Of the configuration, what may get more entries when the run is continued."""

_LEFTOVER = re.compile(rf"\.lock|\.{re.escape(CONFIG)}\.\d+")
"""Names of files in a folder in which a run was killed before it had a configuration."""

_TIME = "-".join("[0-9]" * digits for digits in (8, 6))
"""Pattern of the time in the name of a folder."""


_START = "leave out --resume to start a run"


@contextmanager
def open_run_folder(name: str, work: Mapping[str, Any], conduct: Conduct) -> Iterator[Path]:
    """The folder of a run, made or found again, for this process alone.

    Args:
        name: Name of new folders, which the time follows.
        work: Problems of the run and how they are solved: program, level, `options`, ...; these must be the same when
            the run is continued, except that entries may be added to `strategies` and `scenes`.
        conduct: Conduct of the run, which gives the place of the folder.

    Raises:
        IctampError: The folder is not a run, is a run of different work, is in use or cannot be written.
    """
    now = datetime.now().astimezone().isoformat(timespec="seconds")
    session = {"started": now, "conduct": _to_plain(dataclasses.asdict(conduct)), **provenance()}
    fixed = _to_plain(work)
    with _usable(conduct.out or RUNS):
        path = _path(name, conduct)
        before = _read_previous_config(path)
    if before:
        check_same(path, before, fixed)
    fixed |= {key: before.get(key, {}) | fixed.get(key, {}) for key in WIDENED if key in fixed}
    make_folder(path)
    with lock_folder(path):
        with _usable(path / RESULTS):
            drop_torn_line(path / RESULTS)
            for older, today in TODAY.items():
                if (path / older).is_dir() and not (path / today).exists():
                    (path / older).rename(path / today)  # what a strategy left
        sessions = [*before.get("sessions", []), session]
        write_whole(
            path / CONFIG,
            yaml.safe_dump({**fixed, "sessions": sessions}, sort_keys=False),
        )
        yield path


@contextmanager
def _usable(path: Path) -> Iterator[None]:
    """Raise IctampError when the system refuses a path in the block, e.g. one that is too long."""
    try:
        yield
    except (OSError, ValueError) as error:
        raise not_writable(path, error, "cannot be used") from error


def _path(name: str, conduct: Conduct) -> Path:
    if conduct.out is not None:
        if conduct.resume and not (conduct.out / CONFIG).exists():
            raise IctampError(Code.NO_RUN, "no run to resume", file=shorten_path(conduct.out), advice=_START)
        return conduct.out
    if conduct.resume:
        runs = sorted(RUNS.glob(f"{glob.escape(name)}-{_TIME}/{CONFIG}"), key=lambda path: path.stat().st_mtime)
        if not runs:
            raise IctampError(Code.NO_RUN, "no run to resume", file=f"{RUNS / name}-*", advice=_START)
        return runs[-1].parent
    return RUNS / f"{name}-{datetime.now():%Y%m%d-%H%M%S}"


def _read_previous_config(path: Path) -> dict[str, Any]:
    """Configuration of the run to be continued, empty for a new folder."""
    if (path / CONFIG).exists():
        return read_config(path / CONFIG)
    if path.exists() and not (path.is_dir() and all(_LEFTOVER.fullmatch(each.name) for each in path.iterdir())):
        problem = f"not the folder of a run, since it has no {CONFIG}"
        raise IctampError(Code.NOT_A_RUN, problem, file=path, advice="choose another --out")
    return {}


def read_config(path: Path) -> dict[str, Any]:
    """The configuration of a run.

    Raises:
        IctampError: The file is not the configuration of a run.
    """
    with in_file(path):
        config = dict(respell_options(mapping(parse(read_text(path)))))
        for key in WIDENED:
            mapping(config.get(key, {}), key)
        if not isinstance(sessions := config.get("sessions", []), list):
            raise IctampError(Code.WRONG_TYPE, "expected a list, got {value}", field="sessions", value=sessions)
    return config


def check_same(path: Path, config: Mapping[str, Any], fixed: Mapping[str, Any]) -> None:
    """Refuse to continue what was made in another way.

    Args:
        path: Folder of the existing results.
        config: Configuration with which they were made.
        fixed: Configuration with which to continue.

    Raises:
        IctampError: The configurations differ; the sentence names the first such option and both of its values.
    """
    config = respell_options(config)
    before, now = (_flatten(_keep_common(one, other)) for one, other in ((config, fixed), (fixed, config)))
    for key in [*now, *before]:
        if before.get(key) != now.get(key):
            was = show(before.get(key))
            raise IctampError(
                Code.OTHER_OPTIONS,
                f"cannot be continued with {{value}}, since it was made with {was}",
                file=path,
                field=_option(key),
                value=now.get(key),
                advice="give that value or choose another --out",
            )


def _keep_common(values: Mapping[str, Any], other: Mapping[str, Any]) -> dict[str, Any]:
    """All that decides how problems are solved, of what may be added to those entries that are in both."""
    kept = {key: value for key, value in values.items() if key not in ("sessions", *WIDENED)}
    for key in WIDENED:
        both = values.get(key, {}).keys() & other.get(key, {}).keys()
        kept[key] = {name: values[key][name] for name in sorted(both)}
    return kept


@contextmanager
def lock_folder(path: Path) -> Iterator[None]:
    """This process alone works in the folder, until it ends, however it ends.

    Raises:
        IctampError: Another process works in the folder, or the folder cannot be locked.
    """
    with _usable(path / ".lock"):
        lock = (path / ".lock").open("w")
    with lock:
        try:
            fcntl.flock(lock, fcntl.LOCK_EX | fcntl.LOCK_NB)
        except BlockingIOError as error:
            problem, advice = "another process works in this folder", "wait for it or choose another --out"
            raise IctampError(Code.IN_USE, problem, file=path, advice=advice) from error
        yield


def _to_plain(values: Any) -> Any:
    """The same in the types of YAML."""
    return json.loads(json.dumps(values, default=str))


def _flatten(values: Mapping[str, Any], prefix: str = "") -> dict[str, Any]:
    flat: dict[str, Any] = {}
    for key, value in values.items():
        flat |= _flatten(value, f"{prefix}{key}.") if isinstance(value, dict) else {f"{prefix}{key}": value}
    return flat


def _option(key: str) -> str:
    """Name of a value of the configuration, of an option as on the command line."""
    return key.removeprefix("options.").replace("_", "-") if key.startswith("options.") else key
