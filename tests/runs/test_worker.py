"""Memory of a worker."""

from pathlib import Path
from statistics import median

import pytest

from ictamp_drake.runs.jobs import Job, Problem
from ictamp_drake.runs.pool import start_pool
from ictamp_drake.runs.worker import run_job, start_worker
from ictamp_drake.scenes.levels import problem_files
from ictamp_drake.scenes.spec import load_scene
from ictamp_drake.tamp.method import Method

PAGE = 4096


def solve_and_weigh(job: Job) -> float:
    """Solve a problem, and return the memory of the process [MB]."""
    finished = run_job(0, job, "plan")
    assert finished is not None
    assert finished.record.error is None
    return int(Path("/proc/self/statm").read_text().split()[1]) * PAGE / 1e6


@pytest.mark.slow
def test_a_worker_gives_back_the_memory_of_each_problem() -> None:
    """Each takes 7 MB; over 50 problems with all artefacts, a worker was measured to grow by 13 MB in total."""
    method = Method(max_steps=2, time_limit=200.0)
    with start_pool(1, start_worker, None, True, False) as pool:
        jobs = [Job(Problem(path.stem, load_scene(path), "easy"), method) for path in problem_files("easy", "0:25")]
        weights = [pool.submit(solve_and_weigh, job, timeout=200.0).result() for job in jobs]
    assert median(weights[-5:]) - median(weights[:5]) < 50.0
