"""Workers and programs that are killed at random moments from the start of loading on: no record is lost or false."""

import json
import os
import random
import signal
import threading
import time
from collections.abc import Iterator
from contextlib import contextmanager
from multiprocessing import active_children
from pathlib import Path

import pytest

from benchmarks.kills import check_stubs, disturb_stubs, read, start, stub_program, wait_for_workers
from ictamp_drake.runs import sweep as sweep_module
from ictamp_drake.runs.command import INTERRUPTED
from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.engine import EngineConfig
from ictamp_drake.runs.records import read_records
from ictamp_drake.runs.sweep import sweep
from tests.runs import stubs

CONDUCT = Conduct(artefacts="plan", engine=EngineConfig(workers=2))


@pytest.fixture(autouse=True)
def _stubs(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(sweep_module, "run_job", stubs.run_job)
    monkeypatch.setattr(sweep_module, "start_worker", stubs.start)


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
    assert list(check_stubs(tmp_path, count)) == []


def test_a_problem_that_kills_its_workers_is_tried_twice_and_costs_no_other(tmp_path: Path) -> None:
    jobs = [*stubs.jobs(1, stubs.DEADLY), *stubs.jobs(4)]
    assert sweep(jobs, tmp_path, CONDUCT, lambda *_: None)
    deadly, *others = (read_records(tmp_path / "results.jsonl")[job.name] for job in jobs)
    assert deadly.stop_reason == "CRASHED"
    assert "second time" in (deadly.error or "")
    assert all(record.error is None for record in others)


def test_ctrl_c_while_the_workers_load_ends_the_program_without_a_record(tmp_path: Path) -> None:
    process = start(stub_program(tmp_path / "out", 6, loading=60.0, solving=0.0))
    assert wait_for_workers(process)
    time.sleep(0.3)
    os.killpg(process.pid, signal.SIGINT)
    output = process.communicate(timeout=20)[1].decode()
    assert process.returncode == INTERRUPTED, output
    assert "Traceback" not in output
    assert not read(tmp_path / "out" / "results.jsonl")


@pytest.mark.slow
def test_workers_and_programs_killed_at_random_moments_are_resumed_without_loss(tmp_path: Path) -> None:
    count = disturb_stubs(kills=12, seed=2, folder=tmp_path, pause=4.0, jobs=30)
    assert count.faults == []
    assert count.kills.total() == 12


def test_the_check_finds_lost_doubled_and_false_records(tmp_path: Path) -> None:
    lost, doubled, false, *_ = jobs = stubs.jobs(4)
    assert sweep(jobs, tmp_path, CONDUCT, lambda *_: None)
    assert list(check_stubs(tmp_path, 4)) == []
    lines = (tmp_path / "results.jsonl").read_text().splitlines()
    by_name = {json.loads(line)["problem"]: line for line in lines}
    wrong = json.loads(by_name[false.problem.name]) | {"low_level_steps": 7}
    others = [by_name[job.problem.name] for job in jobs if job not in (lost, false)]
    kept = [*others, by_name[doubled.problem.name], json.dumps(wrong)]
    (tmp_path / "results.jsonl").write_text("\n".join(kept) + "\n")
    faults = list(check_stubs(tmp_path, 4))
    assert [fault.split()[0] for fault in faults] == ["p000", "p001", "p002"]
