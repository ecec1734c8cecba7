"""Model files as text, with some of their shapes left out."""

import re
from collections.abc import Mapping
from typing import Literal

Shapes = Literal["contact", "solid", "visible"]
"""Shapes that bodies get: all that collide (contact), those without the small contact spheres (solid), which serve
physics and not kinematics, or those that are drawn (visible)."""
_OTHERS: Mapping[Shapes, re.Pattern[str]] = {
    "contact": re.compile(r"<visual\b.*?</visual>", re.DOTALL),
    "solid": re.compile(r'<visual\b.*?</visual>|<collision name="\w*contact\w*".*?</collision>', re.DOTALL),
    "visible": re.compile(r"<collision\b.*?</collision>", re.DOTALL),
}


def keep_shapes(text: str, shapes: Shapes) -> str:
    """Return an SDF or URDF model without the other shapes, which take most of the parsing time."""
    return _OTHERS[shapes].sub("", text)
