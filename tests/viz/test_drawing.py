"""Drawings are written completely, in any format, and the same every time."""

import re
from pathlib import Path
from xml.etree import ElementTree

import matplotlib.image
import numpy as np
import pytest

from ictamp_drake.viz.drawing import Drawing, to_hex, to_rgb

RED = (1.0, 0.0, 0.0)


def drawing() -> Drawing:
    """A red square over a green line, on paper of 2 by 1 inches with center (0, 0)."""
    paper = Drawing(2.0, 1.0, -1.0, 0.5)
    paper.dot((0.5, 0.25), 20, shape="square", fill=RED)
    paper.line([(-0.9, 0.25), (0.9, 0.25)], "#00ff00", 4)
    paper.dot((-0.5, -0.25), 10, shape="cross", edge="#000000", width=2)
    paper.text((0.0, -0.25), "a < b & c", "#333333", anchor="middle", opacity=0.5)
    return paper


def test_places_count_from_the_upper_left_corner(tmp_path: Path) -> None:
    drawing().save(tmp_path / "a.svg")
    svg = ElementTree.parse(tmp_path / "a.svg").getroot()
    assert svg.get("viewBox") == "0 0 144 72"
    tags = [(element.tag.rpartition("}")[2], element) for element in svg]
    assert [tag for tag, _ in tags] == ["rect", "polyline", "rect", "path", "text"], "paper, lines, dots, texts"
    assert tags[1][1].get("points") == "7.2,18 136.8,18"
    assert (tags[2][1].get("x"), tags[2][1].get("y"), tags[2][1].get("fill")) == ("98", "8", "#ff0000")
    assert (tags[4][1].text, tags[4][1].get("opacity")) == ("a < b & c", "0.5")
    assert tags[4][1].get("text-anchor") == "middle"


def test_other_formats_show_the_same(tmp_path: Path) -> None:
    drawing().save(tmp_path / "a.png")
    image = matplotlib.image.imread(tmp_path / "a.png")[..., :3]
    height, width, _ = image.shape
    np.testing.assert_allclose(image[height // 4, width * 3 // 4], RED, atol=0.02)
    np.testing.assert_allclose(image[height // 4, width // 2], (0, 1, 0), atol=0.02)
    np.testing.assert_allclose(image[height * 3 // 4, width // 4], (0, 0, 0), atol=0.3)


def test_the_same_drawing_gives_the_same_file(tmp_path: Path) -> None:
    for name in ("a.svg", "b.svg"):
        drawing().save(tmp_path / name)
    assert (tmp_path / "a.svg").read_bytes() == (tmp_path / "b.svg").read_bytes()


def test_numbers_are_short(tmp_path: Path) -> None:
    paper = Drawing(1.0, 1.0, top=1.0)
    paper.line([(1 / 3, 1.0 + 1e-9), (0.0, 0.0)], "#000000", 1)
    paper.save(tmp_path / "a.svg")
    assert re.findall(r'points="(.*?)"', (tmp_path / "a.svg").read_text()) == ["24,0 0,72"]


@pytest.mark.parametrize("text", ["#1a8f3c", "#ffffff", "#000000"])
def test_colors_are_written_as_they_are_read(text: str) -> None:
    assert to_hex(to_rgb(text)) == text
    assert to_hex(text) == text
