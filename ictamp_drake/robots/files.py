"""Text of files, which is read again only when a file has changed: opening one takes longer than all else."""

from contextlib import suppress
from functools import lru_cache
from pathlib import Path

from ictamp_drake.core.reading import read_text

Stamp = tuple[int, int]
"""Time of the latest change of a file [ns], and its size [bytes]."""


def stamp_of(path: Path) -> Stamp | None:
    """Return what changes when a file does; None if it cannot be read, of which reading it tells."""
    with suppress(OSError, ValueError):
        status = path.stat()
        return status.st_mtime_ns, status.st_size
    return None


def read_once(path: Path, limit: int | None = None) -> str:
    """Return the text of a file, see `core.reading.read_text`.

    Raises:
        IctampError: The file cannot be read, is not UTF-8, or is larger than `limit` bytes.
    """
    return _read(path.absolute(), stamp_of(path), limit)


@lru_cache(maxsize=64)
def _read(path: Path, _stamp: Stamp | None, limit: int | None) -> str:
    return read_text(path, limit)
