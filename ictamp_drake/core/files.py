"""Make writable folders, write files that appear whole or not at all, and read JSON files."""

import errno
import os
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any

from ictamp_drake.core.decoding import mapping
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.reading import in_file, parse_json, read_bytes


def make_folder(path: Path) -> None:
    """Make a folder and its parents, unless it exists.

    Raises:
        IctampError: The folder cannot be made or is not writable.
    """
    try:
        path.mkdir(parents=True, exist_ok=True)
        if not os.access(path, os.W_OK):
            raise PermissionError(errno.EACCES, os.strerror(errno.EACCES))
    except OSError as error:
        problem = f"cannot be made or written: {error.strerror}"
        raise IctampError(Code.NOT_WRITABLE, problem, file=path) from error


@contextmanager
def refuse_unwritable(path: Path | str) -> Iterator[None]:
    """Turn an error of the operating system in this block into an `IctampError` that names the file to be written."""
    try:
        yield
    except OSError as error:
        raise IctampError(Code.NOT_WRITABLE, f"cannot be written: {error.strerror}", file=path) from error


def write_whole(path: Path | str, text: str) -> None:
    """Write a text file that appears whole or not at all."""
    with whole(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


@contextmanager
def whole(path: Path | str) -> Iterator[Path]:
    """Yield a temporary file that replaces `path` when the block ends, and is removed when the block fails."""
    temporary = Path(path).with_name(f".{Path(path).name}.{os.getpid()}")
    try:
        yield temporary
        temporary.replace(path)
    finally:
        temporary.unlink(missing_ok=True)


def read_json(path: Path) -> dict[str, Any]:
    """Read the JSON object in a file.

    Raises:
        IctampError: The file cannot be read, or does not hold a JSON object.
    """
    with in_file(path):
        return dict(mapping(parse_json(read_bytes(path))))
