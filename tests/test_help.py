"""The help of a program appears at once: it loads neither Drake nor torch."""

import subprocess
import sys

import pytest

from tests.runs.programs import environment

SLOW = {"pydrake", "torch", "scipy", "ompl", "pandas"}


@pytest.mark.parametrize("program", ["plan", "experiments.packing", "experiments.runner"])
def test_options_are_described_without_drake_and_torch(program: str) -> None:
    code = f"import sys, ictamp_drake.{program}; print({SLOW} & set(sys.modules))"
    found = subprocess.check_output([sys.executable, "-c", code], env=environment(), text=True)
    assert found.strip() == "set()"


def test_a_reader_who_leaves_sees_no_traceback() -> None:
    command = f"{sys.executable} -m ictamp_drake.plan --help | head -1"
    done = subprocess.run(command, shell=True, env=environment(), capture_output=True, text=True, check=True)
    assert done.stdout.startswith("usage:")
    assert done.stderr == ""
