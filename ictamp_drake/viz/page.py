"""Additions to Meshcat's static page: the common part of replay.html and search.html, and a replay's captions."""

import json
from collections.abc import Sequence
from importlib.resources import files
from typing import Any, NamedTuple


class Caption(NamedTuple):
    """A text to show from `start` to `end` [s] of the animation."""

    start: float
    end: float
    text: str


def add_captions(page: str, captions: Sequence[Caption]) -> str:
    """Add texts that follow the animation to Meshcat's static page, and open its controls from the start."""
    data = [[round(c.start, 3), round(c.end, 3), c.text] for c in captions]
    return add_to_body(page, resource("overlay.html").replace("[/* captions */]", to_script(data)))


def resource(name: str) -> str:
    """Read a text file of this package."""
    return files("ictamp_drake.viz").joinpath(name).read_text(encoding="utf-8")


def to_script(data: Any) -> str:
    """Return JSON data as a JavaScript expression that is safe inside a page."""
    return json.dumps(data, separators=(",", ":")).replace("<", "\\u003c")


def add_to_body(page: str, html: str) -> str:
    """Insert HTML at the end of a page's body."""
    head, body, tail = page.rpartition("</body>")
    return head + html + body + tail
