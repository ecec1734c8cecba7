"""Where results come from: commit, versions of packages, machine."""

import os
import platform
import re
import subprocess
from importlib import metadata
from pathlib import Path
from typing import Any

import ictamp_drake


def provenance() -> dict[str, Any]:
    """Commit, package versions and machine, in the types of YAML."""
    return {
        "commit": commit(Path(ictamp_drake.__file__).parent),
        "versions": versions(),
        "host": {"cores": os.cpu_count(), "python": platform.python_version(), "platform": platform.platform()},
    }


def commit(package: Path) -> str | None:
    """The commit that the package was checked out from, with "-dirty" when files differ from it; None without git.

    A package that was installed below a repository of something else is not that repository's.
    """
    tracked = _git(package, "ls-files", "--error-unmatch", "__init__.py")
    return None if tracked is None else _git(package, "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*")


def versions() -> dict[str, str]:
    """Versions of this package and of those that it needs."""
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
