"""Provenance of results: commit, package versions and machine."""

import os
import platform
import re
import subprocess
from importlib import metadata
from pathlib import Path
from typing import Any

import ictamp_drake


def provenance() -> dict[str, Any]:
    """Return commit, package versions and machine in types that YAML supports."""
    return {
        "commit": commit(Path(ictamp_drake.__file__).parent),
        "versions": versions(),
        "host": {"cores": os.cpu_count(), "python": platform.python_version(), "platform": platform.platform()},
    }


def commit(package: Path) -> str | None:
    """Return the commit of the package, with "-dirty" when files differ from it, or None without git.

    A package installed inside another project's repository does not count as part of that repository.
    """
    tracked = _git(package, "ls-files", "--error-unmatch", "__init__.py")
    return None if tracked is None else _git(package, "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*")


def versions() -> dict[str, str]:
    """Return the versions of this package and its dependencies."""
    try:
        needed = metadata.requires("ictamp_drake") or []
    except metadata.PackageNotFoundError:
        return {"ictamp_drake": "not installed"}
    names = [re.split(r"[^\w.-]", each)[0] for each in needed if "extra ==" not in each]
    return {name: metadata.version(name) for name in ["ictamp_drake", *names]}


def _git(folder: Path, *arguments: str) -> str | None:
    command = ["git", "-C", str(folder), *arguments]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return None
