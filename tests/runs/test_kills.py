"""Workers and programs that are killed at random moments from the start of loading on: no record is lost or false."""

import json
import os
import random
import signal
import subprocess
import sys
import threading
import time
from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import active_children
from pathlib import Path

import pytest

from ictamp_drake.runs import sweep as sweep_module
from ictamp_drake.runs.command import COMPLETE, INTERRUPTED
from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.engine import EngineConfig
from ictamp_drake.runs.jobs import Job
from ictamp_drake.runs.records import read_records
from ictamp_drake.runs.sweep import sweep
from tests.runs import stubs
from tests.runs.programs import environment

CONDUCT = Conduct(artefacts="plan", engine=EngineConfig(workers=2))


@pytest.fixture(autouse=True)
def _stubs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweep_module, "run_job", stubs.run_job)
    monkeypatch.setattr(sweep_module, "start_worker", stubs.start)


def check(folder: Path, jobs: list[Job]) -> None:
    """Every job has exactly one final record, which is true, and its files."""
    lines = [json.loads(line) for line in (folder / "results.jsonl").read_text().splitlines()]
    final = Counter(line["problem"] for line in lines if line["error"] is None)
    assert final == {job.problem.name: 1 for job in jobs}
    records = read_records(folder / "results.jsonl")
    for job in jobs:
        found = stubs.expected(job)
        assert records[job.name].low_level_steps == found["low_level_steps"]
        assert (folder / job.name / "scene.yaml").read_bytes() == found["scene.yaml"]


@contextmanager
def killing(seed: int, kills: int, pause: float) -> Iterator[list[int]]:
    """Kill a random worker of this process after random pauses, from the first one on."""
    rng, done, over = random.Random(seed), list[int](), threading.Event()

    def kill() -> None:
        while len(done) < kills and not over.wait(rng.uniform(0, 2 * pause)):
            if workers := sorted(active_children(), key=lambda process: process.pid or 0):
                victim = rng.choice(workers)
                victim.kill()
                done.append(victim.pid or 0)

    thread = threading.Thread(target=kill)
    thread.start()
    try:
        yield done
    finally:
        over.set()
        thread.join()


@pytest.mark.parametrize(("seed", "count", "kills"), [(0, 30, 5), pytest.param(11, 400, 200, marks=pytest.mark.slow)])
def test_killed_workers_cost_no_record(
    seed: int, count: int, kills: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setenv("STUB_SOLVING", "0.4")
    jobs = stubs.jobs(count)
    with killing(seed, kills, pause=0.5) as killed:
        assert sweep(jobs, tmp_path, CONDUCT, lambda *_: None)
    assert len(killed) >= kills / 2
    records = read_records(tmp_path / "results.jsonl")
    assert len((tmp_path / "results.jsonl").read_text().splitlines()) == len(records) == count
    crashed = [job for job in jobs if not records[job.name].is_final]
    assert len(crashed) <= len(killed) / 2  # each takes two
    if crashed:
        assert sweep(crashed, tmp_path, CONDUCT, lambda *_: None)
    check(tmp_path, jobs)


def test_a_problem_that_kills_its_workers_is_tried_twice_and_costs_no_other(tmp_path: Path) -> None:
    jobs = [*stubs.jobs(1, stubs.DEADLY), *stubs.jobs(4)]
    assert sweep(jobs, tmp_path, CONDUCT, lambda *_: None)
    deadly, *others = (read_records(tmp_path / "results.jsonl")[job.name] for job in jobs)
    assert deadly.stop_reason == "CRASHED"
    assert "second time" in (deadly.error or "")
    assert all(record.error is None for record in others)


def program(out: Path, count: int, loading: float, solving: float) -> "subprocess.Popen[bytes]":
    """Start the program of the stubs in a process group of its own, like a terminal."""
    command = [sys.executable, "-m", "tests.runs.stubs", *map(str, (out, count, loading, solving))]
    root = Path(__file__).parents[2]
    return subprocess.Popen(
        command, cwd=root, env=environment(), stdout=subprocess.PIPE, stderr=subprocess.STDOUT, start_new_session=True
    )


def workers(process: "subprocess.Popen[bytes]") -> list[int]:
    """Processes that a program has started for its jobs."""
    children = Path(f"/proc/{process.pid}/task/{process.pid}/children")
    found = [*map(int, children.read_text().split())] if children.exists() else []
    for thread in Path(f"/proc/{process.pid}/task").glob("*/children"):
        found += [int(child) for child in thread.read_text().split() if int(child) not in found]
    return [child for child in found if b"spawn_main" in read(Path(f"/proc/{child}/cmdline"))]


def read(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except OSError:
        return b""


def wait_for_workers(process: "subprocess.Popen[bytes]") -> list[int]:
    end = time.monotonic() + 60
    while not (found := workers(process)) and process.poll() is None and time.monotonic() < end:
        time.sleep(0.01)
    return found


def test_ctrl_c_while_the_workers_load_ends_the_program_without_a_record(tmp_path: Path) -> None:
    process = program(tmp_path / "out", 6, loading=60.0, solving=0.0)
    assert wait_for_workers(process)
    time.sleep(0.3)
    os.killpg(process.pid, signal.SIGINT)
    output = process.communicate(timeout=20)[0].decode()
    assert process.returncode == INTERRUPTED, output
    assert "Traceback" not in output
    assert not read(tmp_path / "out" / "results.jsonl")


@pytest.mark.slow
def test_a_program_killed_at_random_moments_is_resumed_without_loss(tmp_path: Path) -> None:
    rng, out, jobs = random.Random(2), tmp_path / "out", stubs.jobs(60)
    for how in [*(rng.choice(("program", "worker", "ctrl-c")) for _ in range(8)), "nothing"]:
        process = program(out, len(jobs), loading=0.5, solving=0.5)
        found = wait_for_workers(process)
        if how != "nothing" and found:
            time.sleep(rng.uniform(0, 4))
            if how == "worker":
                os.kill(rng.choice(workers(process) or [process.pid]), signal.SIGKILL)
                time.sleep(1)
            if how == "ctrl-c":
                os.killpg(process.pid, signal.SIGINT)
            else:
                process.kill()
        output = process.communicate(timeout=120)[0].decode()
    assert process.returncode == COMPLETE, output
    check(out, jobs)
