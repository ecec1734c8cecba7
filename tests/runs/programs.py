"""Programs of the package, run as users run them: in their own processes."""

import os
import subprocess
import sys
from pathlib import Path

from ictamp_drake.runs.records import Record

SCENE = """\
supports:
  table: {kind: table, position: [0.3, 0.0, 0.0]}
  rack: {kind: rack, position: [0.44, -0.33, 0.16], yaw: 90.0}
boxes:
  red_box: {size: [0.05, 0.05, 0.1], position: [0.45, 0.1, 0.05]}
  blue_box: {size: [0.05, 0.05, 0.08], position: [0.5, 0.3, 0.04]}
goal: (on red_box rack)
"""
"""A scene that takes two skills and about two seconds."""


def command(program: str, *arguments: str | Path) -> list[str]:
    """Command line that runs a program."""
    return [sys.executable, "-m", f"ictamp_drake.{program}", *map(str, arguments)]


def environment(hash_seed: int = 0) -> dict[str, str]:
    """Environment variables with which programs find this package from any folder."""
    root = Path(__file__).parents[2]
    return {**os.environ, "PYTHONPATH": str(root), "PYTHONHASHSEED": str(hash_seed)}


def run(program: str, *arguments: str | Path, folder: Path, hash_seed: int = 0) -> subprocess.CompletedProcess[str]:
    """Run a program in a folder until it ends."""
    return subprocess.run(
        command(program, *arguments),
        cwd=folder,
        env=environment(hash_seed),
        capture_output=True,
        text=True,
        check=False,
        timeout=280,
    )


def run_code(code: str, hash_seed: int) -> str:
    """Output of Python code in a separate process, with a different order of sets."""
    command = [sys.executable, "-c", code]
    return subprocess.run(command, env=environment(hash_seed), capture_output=True, text=True, check=True).stdout


def timeless(record: Record) -> dict[str, object]:
    """Content of a record without times and the machine's load."""
    times = {"planning_time_s", "cpu_time_s", "kinematic_time_s", "geometric_time_s", "replay_time_s", "load"}
    values = {name: value for name, value in vars(record).items() if name not in times}
    return values | {"seconds_by_stage": set(record.seconds_by_stage)}
