"""Commit of the package whose results are written."""

import subprocess
from pathlib import Path

PACKAGE = Path(__file__).parents[1]


def commit(package: Path) -> str | None:
    """Return the commit of the package, with "-dirty" when files differ from it, or None without git.

    A package installed inside another project's repository does not count as part of that repository.
    """
    tracked = _git(package, "ls-files", "--error-unmatch", "__init__.py")
    return None if tracked is None else _git(package, "describe", "--always", "--dirty", "--abbrev=40", "--exclude=*")


def _git(folder: Path, *arguments: str) -> str | None:
    command = ["git", "-C", str(folder), *arguments]
    try:
        return subprocess.run(command, capture_output=True, text=True, check=True).stdout.strip()
    except (OSError, subprocess.CalledProcessError):
        return None
