"""Common style of all figures, and how to write them."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.figure import Figure

LABEL, GRID = "#333333", "#dddddd"
STYLE: dict[Any, Any] = {"font.size": 9, "axes.edgecolor": LABEL, "axes.spines.top": False, "axes.spines.right": False}


def write_figures(figures: Mapping[str, Callable[[], Figure]], folder: Path) -> list[str]:
    """Draw all figures, write them to a folder by name, and return the names. The bytes are the same every time."""
    with mpl.rc_context(STYLE):
        for name, draw in figures.items():
            draw().savefig(folder / name, dpi=120, facecolor="white")
    return list(figures)
