"""A single job in this process leaves the same files as in a worker, and reports its result before its pages."""

import errno
import os
import signal
import tempfile
import threading
import time
from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any
from xml.etree import ElementTree

import pytest

from ictamp_drake.core.decoding import decode
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.reading import parse
from ictamp_drake.runs import sweep as sweep_module
from ictamp_drake.runs import worker
from ictamp_drake.runs.board import Board
from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.engine import EngineConfig
from ictamp_drake.runs.jobs import Job, Problem
from ictamp_drake.runs.records import Record, append, read_records
from ictamp_drake.runs.sweep import sweep
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.skills.config import OptimizationConfig
from ictamp_drake.tamp import pages
from ictamp_drake.tamp.method import Method, Samplers
from ictamp_drake.tamp.task import load
from tests.runs.programs import SCENE, timeless

METHOD = Method(time_limit=250.0)
SHORT = replace(METHOD, max_steps=1)
NO_GRASP = OptimizationConfig(ground=1.0)
ENDLESS = replace(METHOD, sampler="optimization", samplers=Samplers(optimization=NO_GRASP))
"""Finds no grasp, since all are too high above the ground, and does not give up."""
PAGES = {"tree.json", "tree.svg", "growth.svg", "scene.png", "search.html", "replay.html"}


@pytest.fixture
def job() -> Job:
    return Job(Problem("scene", decode(SceneSpec, parse(SCENE))), METHOD)


def impossible(job: Job) -> Job:
    """Job in a scene in which a box hangs in the air."""
    spec = job.problem.spec
    name, box = next(iter(spec.boxes.items()))
    hanging = replace(spec, boxes={**spec.boxes, name: replace(box, position=(0.5, 0.0, 0.9))})
    return replace(job, problem=replace(job.problem, spec=hanging))


class Told:
    """Events of a sweep, each with the files that exist at that moment."""

    def __init__(self, folder: Path) -> None:
        self.folder = folder
        self.records: list[Record] = []
        self.files: list[set[str]] = []

    def __call__(self, _: Board, records: Sequence[Record]) -> None:
        for record in records:
            self.records.append(record)
            self.files.append({path.name for path in (self.folder / record.name).glob("*")})


def done(job: Job, folder: Path, *, alone: bool = True, **conduct: object) -> Told:
    folder.mkdir()
    told = Told(folder)
    assert sweep([job], folder, Conduct(**conduct), told, alone=alone)  # type: ignore[arg-type]
    return told


def test_the_result_is_told_before_its_pages_are_made(job: Job, tmp_path: Path) -> None:
    told = done(job, tmp_path / "out")
    (record,) = told.records
    assert record.solved
    assert told.files == [{"scene.yaml", "plan.yaml"}]
    assert read_records(tmp_path / "out" / "results.jsonl") == {"scene": record}
    assert {path.name for path in (tmp_path / "out" / "scene").iterdir()} == {"scene.yaml", "plan.yaml", *PAGES}


def test_a_job_in_this_process_leaves_what_it_leaves_in_a_worker(job: Job, tmp_path: Path) -> None:
    here, there = done(job, tmp_path / "here"), done(job, tmp_path / "there", alone=False)
    assert timeless(here.records[0]) == timeless(there.records[0])
    for name in ("scene.yaml", "plan.yaml", *(PAGES - {"search.html"})):  # which has the times of the steps
        assert (tmp_path / "here" / "scene" / name).read_bytes() == (tmp_path / "there" / "scene" / name).read_bytes()


def test_a_task_that_was_loaded_is_used_and_does_not_travel(job: Job, tmp_path: Path) -> None:
    task = load(job.problem.spec, SHORT)
    loaded = replace(impossible(job), method=SHORT, task=task)
    (record,) = done(loaded, tmp_path / "out", artefacts="none").records
    assert record.error is None
    assert record.low_level_steps == 1
    assert record.planning_time_s >= round(task.setup_time_s, 4)
    elsewhere = done(loaded, tmp_path / "there", alone=False, artefacts="none")
    assert elsewhere.records[0].stop_reason == "CRASHED"


@pytest.mark.parametrize("alone", [True, False])
def test_a_job_that_fails_is_a_record(job: Job, tmp_path: Path, alone: bool) -> None:
    (record,) = done(impossible(job), tmp_path / "out", alone=alone).records
    assert record.stop_reason == "CRASHED"
    assert "scene: boxes." in (record.error or "")
    assert not record.is_final
    assert not (tmp_path / "out" / "scene").exists()


def test_a_job_that_hangs_is_a_record(job: Job, tmp_path: Path) -> None:
    hasty = replace(job, method=replace(METHOD, time_limit=0.05))
    (record,) = done(hasty, tmp_path / "out", grace=0.0).records
    assert (record.stop_reason, record.error) == ("HUNG", "ended after 0.05 s")


def wait(*_: object) -> None:
    """Never end."""
    while True:
        time.sleep(0.01)


def break_writer(write: Callable[..., object]) -> Callable[..., None]:
    def fail(*_: object, **__: object) -> None:
        raise OSError(f"{write.__name__} is out of ink")

    return fail


def test_a_page_that_fails_costs_only_itself(job: Job, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(pages, "search_html", break_writer(pages.search_html))
    told = done(job, tmp_path / "out")
    first, second = told.records
    assert first.error is None
    assert second == replace(first, error=second.error)
    assert second.error is not None
    assert second.error.endswith("search.html could not be made: OSError('search_html is out of ink')\n")
    assert {path.name for path in (tmp_path / "out" / "scene").iterdir()} == {"scene.yaml", "plan.yaml", *PAGES} - {
        "search.html"
    }
    assert read_records(tmp_path / "out" / "results.jsonl")["scene"] == second


@pytest.mark.parametrize("alone", [True, False])
@pytest.mark.parametrize("kept", [{"scene.yaml", "plan.yaml", "scene.png"}, {"scene.yaml"}, set()])
def test_a_full_disk_costs_only_the_files_that_it_has_no_room_for(
    job: Job, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, alone: bool, kept: set[str]
) -> None:
    def write(path: Path, content: bytes) -> None:
        path.write_bytes(content if path.name in kept else content[:100])
        if path.name not in kept:
            raise OSError(errno.ENOSPC, os.strerror(errno.ENOSPC))

    monkeypatch.setattr(sweep_module, "_write_file", write)
    told = done(job, tmp_path / "out", alone=alone)
    record = told.records[-1]
    assert record.solved
    assert record.error is not None
    assert "search.html" in record.error
    assert read_records(tmp_path / "out" / "results.jsonl") == {"scene": record}
    assert {path.name for path in (tmp_path / "out" / "scene").iterdir()} == kept


def test_files_make_room_for_their_record(job: Job, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    refused = iter([True])

    def append_later(record: Record, path: Path) -> None:
        if next(refused, False):
            raise IctampError(Code.NOT_WRITABLE, "no room", file=path)
        append(record, path)

    monkeypatch.setattr(sweep_module, "append", append_later)
    (record,) = done(replace(job, method=SHORT), tmp_path / "out", artefacts="plan").records
    assert record.low_level_steps == 1
    assert not record.is_final
    assert read_records(tmp_path / "out" / "results.jsonl") == {"scene": record}
    assert not (tmp_path / "out" / "scene").exists()


@pytest.mark.parametrize("alone", [True, False])
def test_a_full_folder_for_temporary_files_costs_no_record(
    job: Job, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, alone: bool
) -> None:
    monkeypatch.setattr(sweep_module, "start_worker", start_without_room)
    monkeypatch.setattr(tempfile, "tempdir", None)
    told = done(replace(job, method=SHORT), tmp_path / "out", alone=alone)
    assert all(record.low_level_steps == 1 and record.error is not None for record in told.records)


def start_without_room(*arguments: Any) -> None:
    """Start a worker whose temporary files have no place."""
    worker.start_worker(*arguments)
    tempfile.tempdir = "/proc"


@pytest.mark.parametrize("name", ["cost_$5_to_$10", "\\frac{_^", "<b>&amp;", "äö 🙂", "a" * 200])
def test_a_name_is_text_in_pictures_and_pages(job: Job, tmp_path: Path, name: str) -> None:
    strange = replace(job, problem=replace(job.problem, name=name), method=SHORT)
    assert done(strange, tmp_path / "out").records[-1].error is None
    assert {path.name for path in (tmp_path / "out" / name).iterdir()} >= {"scene.yaml", *PAGES} - {"replay.html"}
    ElementTree.parse(tmp_path / "out" / name / "tree.svg")


def test_pages_that_never_end_are_given_up(job: Job, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(worker, "write_pages", wait)
    told = done(replace(job, method=SHORT), tmp_path / "out", grace=0.5)
    assert told.records[-1].error == "the pages were given up after 0.5 s"
    assert (tmp_path / "out" / "scene" / "scene.yaml").exists()


def interrupt_sweep(job: Job, folder: Path, *, steps: int = 0, times: int = 1) -> bool:
    """Sweep the job until Ctrl-C is pressed the given number of times after some of its steps."""
    folder.mkdir()
    boards: list[Board] = []

    def press() -> None:
        while not (boards and any(running.steps >= steps for running in boards[0].list_running())):
            time.sleep(0.01)
        for _ in range(times):
            os.kill(os.getpid(), signal.SIGINT)
            while not boards[0].stopping:
                time.sleep(0.01)

    threading.Thread(target=press, daemon=True).start()
    watch = lambda board, _: boards.append(board)  # noqa: E731
    return sweep([replace(job, method=ENDLESS)], folder, Conduct(artefacts="none"), watch, alone=True)


def test_ctrl_c_lets_a_job_in_this_process_finish_its_step(job: Job, tmp_path: Path) -> None:
    assert not interrupt_sweep(job, tmp_path / "out", steps=1)
    (record,) = read_records(tmp_path / "out" / "results.jsonl").values()
    assert record.stop_reason == "STOPPED"
    assert record.low_level_steps > 0
    assert not record.is_final


def test_a_second_ctrl_c_ends_a_job_in_this_process_at_once(
    job: Job, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(worker, "solve", wait)
    before = signal.getsignal(signal.SIGINT)  # ignored where the tests run in the background
    with pytest.raises(KeyboardInterrupt):
        interrupt_sweep(job, tmp_path / "out", times=2)
    assert not (tmp_path / "out" / "results.jsonl").exists()
    assert signal.getsignal(signal.SIGINT) is before


def test_a_record_without_any_room_ends_the_run_with_one_refusal_and_keeps_the_others(
    job: Job, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    def append_one(record: Record, path: Path) -> None:
        if path.exists() and read_records(path):
            raise IctampError(Code.NOT_WRITABLE, "no room", file=path)
        append(record, path)

    monkeypatch.setattr(sweep_module, "append", append_one)
    short = replace(job, method=SHORT)
    jobs = [short, replace(short, problem=replace(short.problem, name="second"))]
    with pytest.raises(IctampError) as refused:
        sweep_module.sweep(jobs, tmp_path, Conduct(artefacts="none", engine=EngineConfig(workers=1)), lambda *_: None)
    assert refused.value.code is Code.NOT_WRITABLE
    assert list(read_records(tmp_path / "results.jsonl")) == ["scene"]
