"""Meshcat's static page with something added: what replay.html and search.html share, and the texts of a replay."""

import json
from collections.abc import Sequence
from importlib.resources import files
from typing import Any, NamedTuple


class Caption(NamedTuple):
    """A text that is shown from `start` to `end` [s] of the animation."""

    start: float
    end: float
    text: str


def add_captions(page: str, captions: Sequence[Caption]) -> str:
    """Meshcat's static page with texts that follow the animation, and controls that are open from the start."""
    data = [[round(c.start, 3), round(c.end, 3), c.text] for c in captions]
    return add_to_body(page, resource("overlay.html").replace("[/* captions */]", to_script(data)))


def resource(name: str) -> str:
    """Text of a file of this package."""
    return files("ictamp_drake.viz").joinpath(name).read_text(encoding="utf-8")


def to_script(data: Any) -> str:
    """Data in the types of JSON as a JavaScript expression that may stand in a page."""
    return json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")


def add_to_body(page: str, html: str) -> str:
    """The page with something at the end of its body."""
    head, body, tail = page.rpartition("</body>")
    return head + html + body + tail
