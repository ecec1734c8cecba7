"""Folders that cannot be written are refused with the system's reason."""

import errno
import os
from pathlib import Path

import pytest

from ictamp_drake.core import files
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.files import make_folder


@pytest.mark.parametrize("reason", [errno.EROFS, errno.ENOSPC, errno.EACCES])
def test_a_folder_that_cannot_be_written_says_why(reason: int, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    def refuse(**_: object) -> None:
        raise OSError(reason, os.strerror(reason))

    monkeypatch.setattr(files, "TemporaryFile", refuse)
    with pytest.raises(IctampError) as caught:
        make_folder(tmp_path / "out")
    assert caught.value.code == Code.NOT_WRITABLE
    assert os.strerror(reason) in str(caught.value)


def test_a_folder_that_was_made_is_empty(tmp_path: Path) -> None:
    make_folder(tmp_path / "a" / "b")
    make_folder(tmp_path / "a" / "b")
    assert not list((tmp_path / "a" / "b").iterdir())
