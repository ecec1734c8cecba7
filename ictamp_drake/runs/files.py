"""Folders that can be written, and files that appear whole or not at all."""

import errno
import os
from pathlib import Path

from ictamp_drake.core.errors import IctampError


def make_folder(path: Path) -> None:
    """Make a folder with all above it, unless it is there.

    Raises:
        IctampError: that cannot be done, or nothing can be written to it.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
        if not os.access(path, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    except OSError as error:
        raise IctampError(f"{path}: is no folder that can be written: {error.strerror}") from error


def write_whole(path: Path, text: str) -> None:
    """Write a file under a temporary name and rename it."""
    temporary = path.with_name(f".{path.name}.{os.getpid()}")
    temporary.write_text(text, encoding="utf-8")
    temporary.replace(path)
