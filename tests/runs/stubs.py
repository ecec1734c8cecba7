"""Workers that load and solve nothing, so that they can be killed often.

`python -m tests.runs.stubs OUT COUNT LOADING SOLVING` is a program with such workers.
"""

import os
import random
import signal
import sys
import time
from collections.abc import Sequence
from pathlib import Path
from unittest.mock import patch

from ictamp_drake.core.decoding import decode
from ictamp_drake.core.reading import parse
from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.engine import EngineConfig
from ictamp_drake.runs.jobs import Finished, Job, Problem
from ictamp_drake.runs.pool import end_with_parent
from ictamp_drake.runs.records import Record
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.tamp.method import Method

SCENE = """\
supports:
  table: {kind: table, position: [0.3, 0.0, 0.0]}
boxes:
  red_box: {size: [0.05, 0.05, 0.1], position: [0.45, 0.1, 0.05]}
  blue_box: {size: [0.05, 0.05, 0.08], position: [0.5, 0.3, 0.04]}
goal: (on red_box blue_box)
"""
DEADLY = "deadly"
"""Strategy whose jobs kill their workers."""


def jobs(count: int, strategy: str = "stub") -> list[Job]:
    """Jobs for the stubs."""
    spec = decode(SceneSpec, parse(SCENE))
    method = Method(estimator="constant", sampler="uniform")
    return [Job(Problem(f"p{number:03d}", spec), method, strategy) for number in range(count)]


def expected(job: Job) -> dict[str, object]:
    """What the record and the files of a job must say."""
    number = int(job.problem.name[1:])
    return {"low_level_steps": number, "stop_reason": "SOLVED", "scene.yaml": f"{job.name}\n".encode() * 5000}


def start(*_: object) -> None:
    """Load for a random time."""
    time.sleep(random.uniform(0.2, 1) * float(os.environ.get("STUB_LOADING", "0.1")))
    end_with_parent()


def run_job(_: int, job: Job, __: object) -> Finished:
    """Solve for a random time."""
    if job.strategy == DEADLY:
        os.kill(os.getpid(), signal.SIGKILL)
    time.sleep(random.uniform(0, 1) * float(os.environ.get("STUB_SOLVING", "0.1")))
    found = expected(job)
    record = Record(
        problem=job.problem.name,
        strategy=job.strategy,
        level=None,
        seed=job.method.seed,
        solved=True,
        stop_reason=str(found["stop_reason"]),
        planning_time_s=0.0,
        low_level_steps=int(str(found["low_level_steps"])),
        plan_length=2,
    )
    return Finished(record, {"scene.yaml": found["scene.yaml"]})  # type: ignore[dict-item]


def main(arguments: Sequence[str]) -> int:
    """Run the stubs as a program with two workers."""
    from rich.console import Console  # noqa: PLC0415

    from ictamp_drake.runs import sweep  # noqa: PLC0415  (workers need not load it)
    from ictamp_drake.runs.program import Work, run  # noqa: PLC0415

    out, count, os.environ["STUB_LOADING"], os.environ["STUB_SOLVING"] = arguments
    conduct = Conduct(out=Path(out), artefacts="plan", engine=EngineConfig(workers=2))
    with patch.object(sweep, "run_job", run_job), patch.object(sweep, "start_worker", start):
        return run(Work("stub", {"program": "stub"}, jobs(int(count)), conduct), Console())


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
