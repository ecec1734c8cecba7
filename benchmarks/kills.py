"""Kills of workers and of whole programs at random moments: `python -m benchmarks.kills --kills 100 --seed 0`.

Starts a program with two workers, kills a worker or the program after a random pause from the start of loading on, and
resumes until all problems are done. Then each problem must have exactly one final record, and a true one. By default
the jobs are stubs; with --real they are easy packing problems, whose records are compared with those of an undisturbed
run. Takes about five minutes on two cores. Run it in the root of a checkout.
"""

import json
import os
import random
import shlex
import signal
import subprocess
import sys
import time
from collections import Counter
from collections.abc import Callable, Iterable, Iterator, Sequence
from dataclasses import dataclass, field
from itertools import cycle, islice
from pathlib import Path
from tempfile import TemporaryDirectory

import tyro

from ictamp_drake.planning.result import StopReason
from ictamp_drake.reports import markdown
from ictamp_drake.runs.command import BAD_INPUT, COMPLETE
from ictamp_drake.runs.folder import RESULTS
from ictamp_drake.runs.jobs import CRASHED
from ictamp_drake.runs.records import read_records
from tests.runs import stubs
from tests.runs.programs import command, environment, timeless

ROOT = Path(__file__).parents[1]
WORKER, SIGKILL, SIGTERM, CTRL_C = "worker, SIGKILL", "program, SIGKILL", "program, SIGTERM", "all processes, SIGINT"
VICTIMS = (WORKER, WORKER, SIGKILL, WORKER, WORKER, SIGTERM, WORKER, WORKER, CTRL_C)
"""What is killed, in turn."""
STOPPED = StopReason.STOPPED.name
REAL = 4
"""Number of real problems."""

Process = subprocess.Popen[bytes]


@dataclass(frozen=True)
class Options:
    """Kill workers and programs.

    Attributes:
        kills: Number of kills.
        seed: Random seed of the moments and of the workers that are killed.
        pause: Longest pause between the kills of stubs [s]. With the default most programs are killed while they load
            or soon after.
        real: Whether to solve real problems.
        out: File of the table; by default none is written.
    """

    kills: int = 100
    seed: int = 0
    pause: float = 1.2
    real: bool = False
    out: Path | None = None


@dataclass
class Count:
    """Findings of all rounds.

    Attributes:
        kills: Number of kills by what was killed.
        rounds: Number of runs that were completed.
        starts: Number of times that a program was started.
        crashed: Number of records that say CRASHED; each is replaced when the run is resumed.
        faults: Descriptions of lost, doubled or false records.
    """

    kills: Counter[str] = field(default_factory=Counter)
    rounds: int = 0
    starts: int = 0
    crashed: int = 0
    faults: list[str] = field(default_factory=list)


def start(arguments: Sequence[str]) -> Process:
    """Start a program in a process group of its own, like a terminal."""
    return subprocess.Popen(
        arguments,
        cwd=ROOT,
        env=environment(),
        stdout=subprocess.DEVNULL,
        stderr=subprocess.PIPE,
        start_new_session=True,
    )


def stub_program(out: Path, count: int, loading: float, solving: float) -> list[str]:
    """Command line of the program of the stubs."""
    return [sys.executable, "-m", "tests.runs.stubs", *map(str, (out, count, loading, solving))]


def real_program(out: Path) -> list[str]:
    """Command line of a program that solves real problems."""
    options = ("--level", "easy", "--problems", f"0:{REAL}", "--workers", "2", "--artefacts", "plan")
    return command("experiments.packing", *options, "--out", out)


def workers(process: Process) -> list[int]:
    """Processes that a program has started for its jobs."""
    children = Path(f"/proc/{process.pid}/task").glob("*/children")
    found = {int(child) for thread in children for child in read(thread).split()}
    return sorted(child for child in found if b"spawn_main" in read(Path(f"/proc/{child}/cmdline")))


def read(path: Path) -> bytes:
    """Content of a file, which is empty if there is none."""
    try:
        return path.read_bytes()
    except OSError:
        return b""


def wait_for_workers(process: Process) -> list[int]:
    """Wait until a program has workers or has ended, and return the workers."""
    end = time.monotonic() + 60
    while not (found := workers(process)) and process.poll() is None and time.monotonic() < end:
        time.sleep(0.01)
    return found


def kill(victim: str, process: Process, rng: random.Random) -> bool:
    """Kill a worker or the program. Return whether it was there."""
    if process.poll() is not None:
        return False
    if victim == WORKER:
        found = workers(process)
        if not found:
            return False
        try:
            os.kill(rng.choice(found), signal.SIGKILL)
        except ProcessLookupError:
            return False
    elif victim == CTRL_C:
        os.killpg(process.pid, signal.SIGINT)
    else:
        process.send_signal(signal.SIGKILL if victim == SIGKILL else signal.SIGTERM)
    return True


def run_disturbed(arguments: Sequence[str], victims: Iterator[str], rng: random.Random, pause: float) -> Count:
    """Run a program, disturb it, and resume it until it is complete.

    Args:
        arguments: Command line of the program.
        victims: What to kill. It is not disturbed any more when there is none left.
        rng: Source of the moments and of the workers.
        pause: Longest pause before a kill [s], from the start of loading or the last kill.
    """
    count, victim = Count(rounds=1), next(victims, None)
    while True:
        process = start(arguments)
        count.starts += 1
        wait_for_workers(process)
        while victim is not None and process.poll() is None:
            time.sleep(rng.uniform(0, pause))
            if kill(victim, process, rng):
                count.kills[victim] += 1
                ended, victim = victim != WORKER, next(victims, None)
                if ended:
                    break
        error = process.communicate(timeout=600)[1].decode()
        if "Traceback" in error or process.returncode == BAD_INPUT:
            count.faults.append(error)
            return count
        if process.returncode == COMPLETE:
            return count


def compare(folder: Path, names: Sequence[str]) -> Iterator[str]:
    """Yield the problems that lack a final record, or have several. A problem that Ctrl-C stopped has none yet."""
    lines = [json.loads(line) for line in (folder / RESULTS).read_text().splitlines()]
    final = Counter(line["problem"] for line in lines if line["error"] is None and line["stop_reason"] != STOPPED)
    for name in sorted({*names, *final}):
        if final[name] != 1:
            yield f"{name} has {final[name]} final records"


def check_stubs(folder: Path, count: int) -> Iterator[str]:
    """Yield what is wrong in the folder of a run of stubs: records lost, doubled or false, and false files."""
    jobs = stubs.jobs(count)
    yield from compare(folder, [job.problem.name for job in jobs])
    records = read_records(folder / RESULTS)
    for job in jobs:
        found = stubs.expected(job)
        if job.name in records and records[job.name].low_level_steps != found["low_level_steps"]:
            yield f"{job.problem.name} has a false record"
        if read(folder / job.name / "scene.yaml") != found["scene.yaml"]:
            yield f"{job.problem.name} has a false file"


def check_real(folder: Path, undisturbed: Path) -> Iterator[str]:
    """Yield where the records and plans of a run differ from those of an undisturbed run."""
    expected, records = read_records(undisturbed / RESULTS), read_records(folder / RESULTS)
    if len(expected) != REAL:
        yield f"the undisturbed run has {len(expected)} of {REAL} records"
    yield from compare(folder, [record.problem for record in expected.values()])
    for name, record in expected.items():
        if name in records and timeless(records[name]) != timeless(record):
            yield f"{name} has another record"
        plan = read(undisturbed / name / "plan.yaml")
        if record.solved != bool(plan) or read(folder / name / "plan.yaml") != plan:
            yield f"{name} has another plan"


def disturb_stubs(kills: int, seed: int, folder: Path, *, pause: float, jobs: int = 100) -> Count:
    """Kill workers and programs of stubs, in as many runs as needed."""
    return _disturb(
        kills,
        seed,
        folder,
        program=lambda out: stub_program(out, jobs, 0.5, 0.5),
        pause=pause,
        check=lambda out: check_stubs(out, jobs),
    )


def disturb_real(kills: int, seed: int, folder: Path) -> Count:
    """Kill workers and programs that solve real problems."""
    undisturbed = folder / "undisturbed"
    run_disturbed(real_program(undisturbed), iter(()), random.Random(), 0)
    return _disturb(
        kills, seed, folder, program=real_program, pause=8.0, check=lambda out: check_real(out, undisturbed)
    )


def _disturb(
    kills: int,
    seed: int,
    folder: Path,
    *,
    program: Callable[[Path], Sequence[str]],
    pause: float,
    check: Callable[[Path], Iterable[str]],
) -> Count:
    rng, total = random.Random(seed), Count()
    while total.kills.total() < kills and not total.faults:
        out = folder / f"round-{total.rounds}"
        victims = islice(cycle(VICTIMS), total.kills.total(), kills)
        count = run_disturbed(program(out), victims, rng, pause)
        total.kills += count.kills
        total.rounds += 1
        total.starts += count.starts
        total.crashed += read(out / RESULTS).decode().count(f'"{CRASHED}"')
        total.faults += [f"{out.name}: {fault}" for fault in (*count.faults, *check(out))]
    return total


def report(count: Count, line: str) -> str:
    """Return the findings as Markdown."""
    rows = [*((f"kills: {victim}", number) for victim, number in sorted(count.kills.items()))]
    rows += [("kills in all", count.kills.total()), ("runs completed", count.rounds), ("starts", count.starts)]
    rows += [("records that say CRASHED, replaced on resumption", count.crashed)]
    rows += [("records lost, doubled or false", len(count.faults))]
    table = markdown.table(["", "number"], rows)
    return "\n".join(
        ["# Workers and programs killed at random moments", "", f"By `{line}`.", "", *table, "", *count.faults, ""]
    )


def main() -> int:
    """Kill, check, and write the table."""
    options = tyro.cli(Options, description=__doc__)
    with TemporaryDirectory() as folder:
        if options.real:
            count = disturb_real(options.kills, options.seed, Path(folder))
        else:
            count = disturb_stubs(options.kills, options.seed, Path(folder), pause=options.pause)
    text = report(count, shlex.join(["python", "-m", "benchmarks.kills", *sys.argv[1:]]))
    print(text)
    if options.out is not None:
        options.out.write_text(text)
    return 1 if count.faults else 0


if __name__ == "__main__":
    sys.exit(main())
