"""The packing program as a subprocess: resuming, kill -9, Ctrl-C, broken workers and bad input."""

import os
import signal
import subprocess
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from pathlib import Path

import pytest

from ictamp_drake.experiments.packing import Packing, work
from ictamp_drake.runs import program
from ictamp_drake.runs.command import BAD_INPUT, BROKEN, COMPLETE, INTERRUPTED
from ictamp_drake.runs.records import Record, read_records
from tests.runs.programs import command, environment, run, timeless

SHORT = ("--max-steps", "1", "--artefacts", "none", "--time-limit", "250")
"""Options with which a problem takes a second or two and is not solved."""
NO_GRASP = ("--sampler", "optimization", "--samplers.optimization.ground", "1")
LONG = ("--time-limit", "3", *NO_GRASP, "--artefacts", "none")
"""Options with which a problem is given up after three seconds, since every grasp is too high above the ground."""


def results(folder: Path) -> dict[str, Record]:
    return read_records(folder / "out" / "results.jsonl")


@contextmanager
def start_program(folder: Path, *arguments: str) -> Iterator[subprocess.Popen[str]]:
    """Start the program in folder/out, in its own process group."""
    process = subprocess.Popen(
        command("experiments.packing", "--out", "out", *arguments),
        cwd=folder,
        env=environment(),
        stdout=subprocess.PIPE,
        stderr=subprocess.PIPE,
        text=True,
        start_new_session=True,
    )
    try:
        yield process
    finally:
        process.kill()
        process.communicate()


def wait_until(condition: Callable[[], object], seconds: float = 200) -> None:
    deadline = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < deadline, "it never happened"
        time.sleep(0.05)


def workers(process: subprocess.Popen[str]) -> list[int]:
    """Process IDs of a program's workers."""
    found = []
    for path in Path("/proc").glob("[0-9]*/stat"):
        try:
            fields = path.read_text().rpartition(")")[2].split()
            arguments = (path.parent / "cmdline").read_text()
        except OSError:
            continue
        if int(fields[1]) == process.pid and "spawn_main" in arguments:
            found.append(int(path.parent.name))
    return found


def is_alive(pid: int) -> bool:
    try:
        return Path(f"/proc/{pid}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except OSError:
        return False


def test_kill_9_in_mid_run_loses_no_finished_problem(tmp_path: Path) -> None:
    options = ("--problems", "0:3", "--workers", "1", *SHORT)
    with start_program(tmp_path, *options) as process:
        wait_until(lambda: results(tmp_path))
        crew = workers(process)
        process.kill()
        process.wait()
        wait_until(lambda: not any(map(is_alive, crew)), seconds=30)
    finished = results(tmp_path)
    assert 1 <= len(finished) < 3
    with (tmp_path / "out" / "results.jsonl").open("a") as file:
        file.write('{"problem": "easy-0')  # as if the machine had died while writing

    again = run("experiments.packing", "--out", "out", *options, folder=tmp_path)
    assert again.returncode == COMPLETE, again.stderr
    assert f"{3 - len(finished)} problem" in again.stdout
    assert set(results(tmp_path)) == {"easy-000", "easy-001", "easy-002"}
    assert {name: results(tmp_path)[name] for name in finished} == finished
    assert len((tmp_path / "out" / "results.jsonl").read_text().splitlines()) == 3


def wait_for_second_problem(folder: Path) -> None:
    """Wait until the only worker is at the second problem, which follows immediately after the first."""
    wait_until(lambda: results(folder))
    time.sleep(1)


def test_ctrl_c_ends_the_run_cleanly_and_the_stopped_problem_is_tried_again(tmp_path: Path) -> None:
    with start_program(tmp_path, "--problems", "0:3", "--workers", "1", *LONG) as process:
        wait_for_second_problem(tmp_path)
        os.killpg(process.pid, signal.SIGINT)  # as a terminal does
        output, errors = process.communicate(timeout=200)
    assert process.returncode == INTERRUPTED
    assert errors == ""
    assert "Interrupted; the same command with --out out goes on." in output
    first, second = results(tmp_path).values()
    assert first.stop_reason == "OUT_OF_TIME"
    assert first.is_final
    assert second.stop_reason == "STOPPED"
    assert not second.is_final

    again = run("experiments.packing", "--out", "out", "--problems", "0:2", "--workers", "1", *LONG, folder=tmp_path)
    assert again.returncode == COMPLETE, again.stderr
    assert "1 problem to solve, 1 done before" in again.stdout
    assert " grasps refused: " in again.stdout
    assert results(tmp_path)["easy-000"] == first
    assert results(tmp_path)["easy-001"].stop_reason == "OUT_OF_TIME"


def test_a_worker_that_dies_costs_only_time(tmp_path: Path) -> None:
    with start_program(tmp_path, "--problems", "0:3", "--workers", "1", *LONG) as process:
        wait_for_second_problem(tmp_path)
        os.kill(workers(process)[0], signal.SIGKILL)
        output, errors = process.communicate(timeout=200)
    assert process.returncode == COMPLETE, errors
    assert [record.stop_reason for record in results(tmp_path).values()] == 3 * ["OUT_OF_TIME"]
    assert len((tmp_path / "out" / "results.jsonl").read_text().splitlines()) == 3
    assert "CRASHED" not in output


def test_a_problem_that_hangs_is_ended(tmp_path: Path) -> None:
    limits = ("--time-limit", "0.1", "--grace", "0")
    out = run("experiments.packing", "--out", "out", "--problems", "0", *limits, folder=tmp_path)
    assert out.returncode == BROKEN
    (record,) = results(tmp_path).values()
    assert record.stop_reason == "HUNG"
    assert record.error == "ended after 0.1 s"


def test_neither_hash_seed_nor_workers_change_a_result(tmp_path: Path) -> None:
    """The problems include failures."""
    options = ("--problems", "0:2", "--max-steps", "3", "--sampler", "uniform", "--skills.draws", "1")
    for number in (1, 2):
        folder = tmp_path / str(number)
        folder.mkdir()
        how = ("--workers", str(number), "--time-limit", "250", "--out", "out")
        done = run("experiments.packing", *options, *how, folder=folder, hash_seed=number)
        assert done.returncode == COMPLETE, done.stderr
    first, second = (results(tmp_path / str(number)) for number in (1, 2))
    assert first.keys() == second.keys() == {"easy-000", "easy-001"}
    for name in first:
        assert timeless(first[name]) == timeless(second[name])
        trees = [(tmp_path / str(number) / "out" / name / "tree.json").read_bytes() for number in (1, 2)]
        assert trees[0] == trees[1]


def refuse(capsys: pytest.CaptureFixture[str], *arguments: str | Path) -> str:
    """Sentence with which the program refuses the arguments."""
    assert program.main("ictamp_drake.experiments.packing", Packing, work, list(map(str, arguments))) == BAD_INPUT
    output = capsys.readouterr()
    assert output.out == ""
    assert output.err.count("\n") == 1
    return output.err.strip()


@pytest.mark.parametrize(
    "arguments",
    [
        ("--level", "heavy"),
        ("--problems", "a:b"),
        ("--problems", "55"),
        ("--sampler", "best"),
        ("--estimator", "q"),
        ("--generator", "x"),
        ("--time-limit", "-1"),
        ("--workers", "0"),
    ],
)
def test_bad_options_are_refused_in_one_sentence(
    arguments: tuple[str, str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    option, value = arguments
    sentence = refuse(capsys, *arguments, "--out", tmp_path / "out")
    assert sentence.startswith(f"{option.removeprefix('--')}: ")
    assert value in sentence
    assert not (tmp_path / "out").exists()


@pytest.mark.parametrize("arguments", [("--no-such-option", "1"), ("--seed", "one"), ("--artefacts", "some")])
def test_options_that_are_none_are_refused(arguments: tuple[str, ...], capsys: pytest.CaptureFixture[str]) -> None:
    with pytest.raises(SystemExit) as exit_:
        program.main("ictamp_drake.experiments.packing", Packing, work, arguments)
    assert exit_.value.code == BAD_INPUT
    assert arguments[0] in capsys.readouterr().err


def test_bad_input_gives_exit_code_2(tmp_path: Path) -> None:
    refused = run("experiments.packing", "--level", "heavy", folder=tmp_path)
    assert refused.returncode == BAD_INPUT
    assert refused.stderr.startswith("level: ")
    assert refused.stderr.count("\n") == 1
    assert refused.stdout == ""
    assert not list(tmp_path.iterdir())
