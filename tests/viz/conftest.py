"""What the tests of pictures share."""

import json
from pathlib import Path
from typing import Any

import pytest

GOLDEN = Path(__file__).parents[1] / "golden"


@pytest.fixture
def door() -> dict[str, Any]:
    """The record of a search in which nothing but a narrow door makes steps fail, read from its file."""
    record: dict[str, Any] = json.loads((GOLDEN / "door.json").read_text())["tree"]
    return record
