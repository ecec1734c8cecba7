"""Solve one problem after the other in one tree and report the costs: the child processes of `against.py`.

Imports only the package on PYTHONPATH, which may be older or newer than this file. All seconds of the package, time
limits included, are processor time here. Each process first solves a problem that does not count, so that imports,
networks and other things that load once are in place. Then it reads one problem per line.
"""

import gc
import importlib
import json
import os
import shlex
import sys
import time
import traceback
from pathlib import Path
from typing import Any

time.perf_counter = time.process_time

PLACES: dict[str, tuple[str, ...]] = {
    "Method": ("tamp.method:Method", "runs.options:Method"),
    "load": ("tamp.task:load", "runs.solve:prepare"),
    "solve": ("tamp.solve:solve", "runs.solve:solve"),
    "record_of": ("runs.records:record_of",),
    "problem_files": ("scenes.levels:problem_files",),
}
"""Current and former places of the measured functions in the package. A function that moves gets one more place."""

FIGURES = (
    "solved",
    "stop_reason",
    "high_level_plans",
    "low_level_steps",
    "plan_length",
    "plan_duration_s",
    "seconds_by_stage",
    "replay_time_s",
    "kinematic_time_s",
    "geometric_time_s",
)
"""Fields of a record to keep, if the tree has them."""


def find(name: str) -> Any:
    """Import the function or class with that name from this tree."""
    for place in PLACES[name]:
        module, _, attribute = place.partition(":")
        try:
            return getattr(importlib.import_module(f"ictamp_drake.{module}"), attribute)
        except (ImportError, AttributeError):
            continue
    raise ImportError(f"cannot find {name} in {', '.join(PLACES[name])}")


def solve_and_time(problem: dict[str, Any], method: Any) -> dict[str, Any]:
    """Solve a problem and measure the processor time from before its file is read until the search ends [s].

    Args:
        problem: File as `scene`, or `level` and `number`, for which each tree uses its own file.
        method: Method that solves the problem.
    """
    path = find("problem_files")(problem["level"], str(problem["number"]))[0] if "number" in problem else None
    load, solve = find("load"), find("solve")
    gc.collect()  # garbage of the previous problem
    start = time.process_time()
    try:
        solution = solve(load(path or Path(problem["scene"]), method), method)
        seconds = time.process_time() - start
        record = vars(find("record_of")("", "", None, method.seed, solution))
    except Exception:
        return {"cpu_s": time.process_time() - start, "solved": False, "error": traceback.format_exc()}
    return {"cpu_s": seconds, **{name: record[name] for name in FIGURES if name in record}}


def main(options: str, warm_up: str) -> None:
    """Warm up, report the package's location, then answer each line."""
    import tyro  # noqa: PLC0415  (imported by this tree's own process, like the package)

    answers = os.fdopen(os.dup(sys.stdout.fileno()), "w")
    os.dup2(sys.stderr.fileno(), sys.stdout.fileno())  # what libraries print is not an answer
    method = tyro.cli(find("Method"), args=shlex.split(options))
    first = solve_and_time({"scene": warm_up}, method)
    package = importlib.import_module("ictamp_drake").__file__
    print(json.dumps({"package": package, **first}), file=answers, flush=True)
    for line in sys.stdin:
        print(json.dumps(solve_and_time(json.loads(line), method)), file=answers, flush=True)


if __name__ == "__main__":
    main(*sys.argv[1:])
