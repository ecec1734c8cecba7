"""Folders that can be written, files that appear whole or not at all, and what is read from them."""

import errno
import json
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.reading import read_text


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


def write_whole(path: Path | str, text: str) -> None:
    """Write a text file that appears whole or not at all."""
    with whole(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


@contextmanager
def whole(path: Path | str) -> Iterator[Path]:
    """Temporary file that takes the place of `path` when the block ends, and is removed when the block fails."""
    temporary = Path(path).with_name(f".{Path(path).name}.{os.getpid()}")
    try:
        yield temporary
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def read_json(path: Path) -> dict[str, Any]:
    """The object in a file.

    Raises:
        IctampError: the file cannot be read or is none of JSON.
    """
    text = read_text(path)
    try:
        values = json.loads(text)
    except ValueError as error:
        raise IctampError(f"{path}: is not JSON: {error}") from error
    if not isinstance(values, dict):
        raise IctampError(f"{path}: is a {type(values).__name__} in JSON, but must be an object")
    return values
