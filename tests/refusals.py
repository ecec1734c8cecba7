"""Checks of an error's code, place and value, but not of its sentence, which is in `core/test_wording.py`."""

from collections.abc import Iterator
from contextlib import contextmanager
from math import isnan
from pathlib import Path
from typing import Any

import pytest

from ictamp_drake.core.errors import Code, IctampError


@contextmanager
def refusal(code: Code, field: str | None = None, *, file: Path | str | None = None, **values: Any) -> Iterator[None]:
    """Expect an error with a code and, if given, a field, a file, a line, a value or choices."""
    with pytest.raises(IctampError) as caught:
        yield
    error = caught.value
    assert error.code == code, error
    assert "\n" not in str(error)
    if field is not None:
        assert error.where.field == field, error
    if file is not None:
        assert error.where.file == str(file), error
    if "line" in values:
        assert error.where.line == values.pop("line"), error
    for name, value in values.items():
        found = getattr(error, name)
        assert found == value or (isinstance(value, float) and isnan(value) and isnan(found)), error
