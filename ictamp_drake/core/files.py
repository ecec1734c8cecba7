"""Make writable folders, write files that appear whole or not at all, and read JSON files."""

import os
from collections.abc import Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from tempfile import TemporaryFile
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
        with TemporaryFile(dir=path):
            pass
    except RecursionError as error:
        raise IctampError(Code.TOO_DEEP, "expected a folder nested less deeply", file=shorten_path(path)) from error
    except (OSError, ValueError) as error:
        raise not_writable(path, error, "cannot be made or written") from error


def not_writable(path: Path | str, error: OSError | ValueError, problem: str = "cannot be written") -> IctampError:
    """Return the refusal of a file or folder that the system refused with an error; ValueError is one of its path."""
    why = error.strerror if isinstance(error, OSError) and error.strerror else str(error)
    return IctampError(Code.NOT_WRITABLE, f"{problem}: {why}", file=shorten_path(path))


def shorten_path(path: Path | str) -> str:
    """Return the path as messages quote it: without NUL, and abbreviated if it is very long."""
    text = str(path).replace("\0", "\\0")
    return text if len(text) <= _LONGEST else f"{text[:_LONGEST]}..."


_LONGEST = 300
"""Maximum number of characters of a path that a message quotes."""


@contextmanager
def refuse_unwritable(path: Path | str) -> Iterator[None]:
    """Turn an error of the operating system in this block into an `IctampError` that names the file to be written."""
    try:
        yield
    except OSError as error:
        raise IctampError(Code.NOT_WRITABLE, f"cannot be written: {error.strerror}", file=path) from error


def write_whole(path: Path | str, text: str) -> None:
    """Write a text file that appears whole or not at all.

    Raises:
        IctampError: The file cannot be written.
    """
    with whole(path) as temporary:
        temporary.write_text(text, encoding="utf-8")


@contextmanager
def whole(path: Path | str) -> Iterator[Path]:
    """Yield a temporary file that replaces `path` when the block ends, and is removed when the block fails.

    Raises:
        IctampError: The file cannot be written.
    """
    temporary = Path(path).with_name(f".{Path(path).name}.{os.getpid()}")
    try:
        yield temporary
        temporary.replace(path)
    except OSError as error:
        raise not_writable(path, error) from error
    finally:
        with suppress(OSError):
            temporary.unlink(missing_ok=True)


def read_json(path: Path) -> dict[str, Any]:
    """Read the JSON object in a file.

    Raises:
        IctampError: The file cannot be read, or does not hold a JSON object.
    """
    with in_file(path):
        return dict(mapping(parse_json(read_bytes(path))))
