"""Provenance of results."""

import subprocess
from pathlib import Path

from ictamp_drake.core.provenance import commit
from ictamp_drake.runs.provenance import provenance, versions


def git(folder: Path, *arguments: str) -> str:
    identity = ("-c", "user.name=Test", "-c", "user.email=test@example.org")
    command = ["git", "-C", str(folder), *identity, *arguments]
    return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()


def test_the_commit_is_that_of_the_package(tmp_path: Path) -> None:
    package = tmp_path / "package"
    package.mkdir()
    (package / "__init__.py").touch()
    git(tmp_path, "init", "--quiet")
    assert commit(package) is None  # inside a repository that does not track it
    git(tmp_path, "add", ".")
    git(tmp_path, "commit", "--quiet", "-m", "First")
    assert commit(package) == git(tmp_path, "rev-parse", "HEAD")
    (package / "__init__.py").write_text("changed = True\n")
    assert commit(package) == git(tmp_path, "rev-parse", "HEAD") + "-dirty"


def test_versions_are_those_of_what_the_package_needs() -> None:
    assert {"ictamp_drake", "drake", "numpy", "tyro"} <= versions().keys()
    assert "pytest" not in versions()


def test_the_machine_is_described() -> None:
    assert provenance()["host"].keys() == {"cores", "python", "platform"}
