"""Common fixtures of the tests of pictures."""

import json
from pathlib import Path
from typing import Any

import pytest

GOLDEN = Path(__file__).parents[1] / "golden"


@pytest.fixture
def door() -> dict[str, Any]:
    """Record of a search in which only a narrow door makes steps fail, read from its file."""
    record: dict[str, Any] = json.loads((GOLDEN / "door.json").read_text())["tree"]
    return record
