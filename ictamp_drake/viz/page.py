"""What is added to Meshcat's page: texts that follow the animation, and controls that are open from the start."""

import json
from collections.abc import Sequence
from importlib.resources import files
from typing import NamedTuple


class Caption(NamedTuple):
    """A text that is shown from `start` to `end` [s] of the animation."""

    start: float
    end: float
    text: str


def add_captions(page: str, captions: Sequence[Caption]) -> str:
    """Meshcat's static page with the captions in it."""
    overlay = files("ictamp_drake.viz").joinpath("overlay.html").read_text(encoding="utf-8")
    data = json.dumps([[round(c.start, 3), round(c.end, 3), c.text] for c in captions]).replace("<", "\\u003c")
    head, body, tail = page.rpartition("</body>")
    return head + overlay.replace("[/* captions */]", data) + body + tail
