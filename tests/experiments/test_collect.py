"""The collection as users run it: killed, resumed, broken and misused."""

import json
import os
import signal
import subprocess
import time
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import pytest
from rich.console import Console

from ictamp_drake.collection.shards import Shards
from ictamp_drake.experiments import collect as program
from ictamp_drake.learning.dataset import fingerprint, open_table
from ictamp_drake.runs.engine import EngineConfig
from tests.runs.clusters import two_nodes
from tests.runs.programs import command, environment, run

SHORT = ("--walk.states", "2", "--walk.draws", "2")


def timeless(folder: Path) -> list[dict[str, Any]]:
    """All rows without the columns that differ from run to run."""
    rows = open_table(folder).to_table().to_pylist()
    return [{name: value for name, value in row.items() if not name.endswith("_ms")} for row in rows]


@pytest.fixture(scope="module")
def collected(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Attempts in scenes 0 to 3 from one worker without interruption."""
    folder = tmp_path_factory.mktemp("collected")
    done = run("experiments.collect", "--scenes", "0:4", "--out", "data", "--workers", "1", *SHORT, folder=folder)
    assert done.returncode == 0, done.stderr
    assert "4 of 4 scenes, 16 attempts" in done.stdout
    return folder / "data"


def processes_in(folder: Path) -> list[int]:
    """Processes with the folder as their working directory."""
    found = []
    for entry in Path("/proc").iterdir():
        try:
            if entry.name.isdigit() and (entry / "cwd").resolve() == folder.resolve():
                found.append(int(entry.name))
        except OSError:
            continue
    return found


def test_a_summary_lies_beside_the_data(collected: Path) -> None:
    about = json.loads((collected / "collection.json").read_text())
    rows = timeless(collected)
    assert about["seed"] == 0
    assert about["walk"]["states"] == 2
    assert about["summary"]["attempts"] == len(rows) == 16
    assert about["summary"]["executed"] == sum(row["executed"] for row in rows)
    assert about["summary"]["succeeded"] == sum(row["failure"] is None for row in rows)
    assert sum(counts["attempts"] for counts in about["summary"]["by_skill_and_sampler"].values()) == 16
    assert not list((collected / "parts").iterdir())


def test_killed_and_resumed_by_two_workers_it_is_the_same_data(collected: Path, tmp_path: Path) -> None:
    arguments = ("--scenes", "0:4", "--out", "data", "--workers", "2", *SHORT)
    first = subprocess.Popen(
        command("experiments.collect", *arguments), cwd=tmp_path, env=environment(), stdout=subprocess.DEVNULL
    )
    parts = tmp_path / "data" / "parts"
    while not list(parts.glob("[0-9]*.parquet")):
        assert first.poll() is None
        time.sleep(0.02)
    first.send_signal(signal.SIGKILL)
    first.wait()
    deadline = time.monotonic() + 60
    while processes_in(tmp_path) and time.monotonic() < deadline:
        time.sleep(0.05)
    assert not processes_in(tmp_path)  # workers do not outlive it
    done = len(list(parts.glob("[0-9]*.parquet")))
    assert 0 < done < 4
    second = run("experiments.collect", *arguments, folder=tmp_path)
    assert second.returncode == 0, second.stderr
    assert f"{4 - done} scenes to walk through, {done} done before" in second.stdout
    assert timeless(tmp_path / "data") == timeless(collected)
    assert fingerprint(tmp_path / "data") == fingerprint(collected)


def test_what_is_done_is_not_done_again(collected: Path) -> None:
    before = {path: path.stat().st_mtime_ns for path in collected.glob("*.parquet")}
    again = run("experiments.collect", "--scenes", "0:4", "--out", collected, *SHORT, folder=collected.parent)
    assert "0 scenes to walk through, 4 done before" in again.stdout
    assert {path: path.stat().st_mtime_ns for path in collected.glob("*.parquet")} == before


def test_other_options_are_refused(collected: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert program.main(["--scenes", "0:4", "--out", str(collected), *SHORT, "--seed", "1"]) == 2
    assert capsys.readouterr().err.startswith(f"{collected}: seed: ")
    assert program.main(["--scenes", "six", "--out", str(collected), *SHORT]) == 2
    assert capsys.readouterr().err.startswith("scenes: ")
    assert program.main(["--scenes", "0:4", "--out", str(collected), *SHORT, "--walk.draws", "7"]) == 2
    assert capsys.readouterr().err.startswith(f"{collected}: walk.draws: ")


def test_a_broken_note_of_how_attempts_were_made_is_named(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    (tmp_path / "collection.json").write_text('{"seed": ')
    assert program.main(["--scenes", "0", "--out", str(tmp_path)]) == 2
    assert capsys.readouterr().err.startswith(f"{tmp_path}/collection.json: ")


def _die_here_and_there(out: Path, scene: int, _seed: int, _walk: object, spared: Sequence[int]) -> tuple[int, int]:
    """Make ten attempts. Die in the third of scene 4 and in all of scene 6, and hang in the first of scene 5."""
    shards = Shards(out)
    made = [attempt for attempt in range(10) if attempt not in spared]
    for attempt in made:
        shards.begin(scene, attempt)
        if (scene, attempt) == (4, 2) or scene == 6:
            os.kill(os.getpid(), signal.SIGKILL)
        if (scene, attempt) == (5, 0):
            time.sleep(600)
    shards.add(scene, [])
    return len(made), 0


def test_an_attempt_in_which_the_process_dies_or_hangs_costs_only_itself(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setattr(program, "write_walk", _die_here_and_there)
    options = program.Collect(out=tmp_path, scenes="3:7", limit=6.0, engine=EngineConfig(workers=1))
    assert program.collect(options, Console(width=120)) == 1
    printed = capsys.readouterr().out
    assert "scene 4 is walked through again without attempt 2" in printed
    assert "scene 5 is walked through again without attempt 0" in printed
    assert "scene 6 is given up" in printed
    assert "4 of 4 scenes, 28 attempts" in printed
    assert Shards(tmp_path).list_done() == {3, 4, 5, 6}
    assert not list((tmp_path / "parts").glob("*.attempt"))


@pytest.mark.slow
def test_on_a_cluster_it_is_the_same_data(collected: Path, tmp_path: Path) -> None:
    with two_nodes() as cluster:
        where = ("--engine", "ray", "--ray-address", cluster.address)
        done = run("experiments.collect", "--scenes", "0:4", "--out", "data", *where, *SHORT, folder=tmp_path)
    assert done.returncode == 0, done.stderr
    assert timeless(tmp_path / "data") == timeless(collected)
