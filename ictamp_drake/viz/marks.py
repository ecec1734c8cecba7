"""Outlines, names and a caption on the picture of a scene in which no plan was found."""

from collections.abc import Iterable, Iterator, Mapping
from textwrap import wrap

import numpy as np
from numpy.typing import NDArray
from PIL import Image, ImageDraw, ImageFilter, ImageFont

from ictamp_drake.viz.reasons import MOVED, OBSTACLE, SHOWN, WHERE, Reasons

_LINE, _HALO = 7, 11
"""Widths of the filters that make an outline and the white around it [pixels]."""

_NAME, _TITLE, _TEXT = 15, 18, 14
"""Sizes of texts [pixels]."""

_COLUMNS = 118
"""Letters in a line of the caption."""

_MARGIN = 14
_INK, _PALE, _PAPER = "#26303c", "#5b6570", "#ffffff"

_LEGEND = ((MOVED, "could not be moved"), (OBSTACLE, "was in the way"), (WHERE, "where it stands or was to go"))

Rectangle = tuple[float, float, float, float]
"""Left, top, right, bottom [pixels]."""


def mark(image: Image.Image, silhouettes: Mapping[str, NDArray[np.bool_]], colors: Mapping[str, str]) -> Image.Image:
    """The picture with outlines and names of things.

    Args:
        image: the picture.
        silhouettes: where each thing is in it, shape (height, width).
        colors: of each thing.
    """
    marked = image.copy()
    masks = {name: Image.fromarray(silhouette).convert("L") for name, silhouette in silhouettes.items()}
    for width, white in ((_HALO, True), (_LINE, False)):
        for name, mask in masks.items():
            outline = np.asarray(mask.filter(ImageFilter.MaxFilter(width))) > np.asarray(mask)
            marked.paste(_PAPER if white else colors[name], mask=Image.fromarray(outline))
    draw = ImageDraw.Draw(marked)
    taken: list[Rectangle] = []
    for name, mask in sorted(masks.items(), key=lambda item: colors[item[0]] != MOVED):
        if (inside := mask.getbbox()) is not None:
            taken.append(_write_name(draw, name, colors[name], inside, taken))
    return marked


def _write_name(
    draw: ImageDraw.ImageDraw, name: str, color: str, thing: Rectangle, taken: Iterable[Rectangle]
) -> Rectangle:
    """Write a name above a thing, or higher where other names are; returns its place."""
    font = ImageFont.load_default(_NAME)
    width, height = draw.textlength(name, font) + 12, _NAME + 7
    left = min(max((thing[0] + thing[2] - width) / 2, 0), draw.im.size[0] - width)
    top = max(thing[1] - height - 8, 0)
    while any(_overlap((left, top, left + width, top + height), other) for other in taken) and top > 0:
        top = max(top - 4, 0)
    place = (left, top, left + width, top + height)
    draw.rounded_rectangle(place, 5, fill=color, outline=_PAPER)
    draw.text((left + width / 2, top + height / 2), name, fill=_PAPER, font=font, anchor="mm")
    return place


def _overlap(one: Rectangle, other: Rectangle) -> bool:
    return one[0] < other[2] and other[0] < one[2] and one[1] < other[3] and other[1] < one[3]


def add_caption(image: Image.Image, reasons: Reasons) -> Image.Image:
    """The picture with what there is to say below it, so that nothing of it is hidden."""
    lines = list(_lines(reasons))
    height = 2 * _MARGIN + sum(round(1.45 * size) for _, size, _ in lines) + (22 if reasons.refusals else 0)
    captioned = Image.new("RGB", (image.width, image.height + height), _PAPER)
    captioned.paste(image)
    draw = ImageDraw.Draw(captioned)
    y = image.height + _MARGIN
    for text, size, color in lines:
        draw.text((_MARGIN, y), text, fill=color, font=ImageFont.load_default(size))
        y += round(1.45 * size)
    if reasons.refusals:
        _draw_legend(draw, y + 6, set(reasons.colors.values()))
    return captioned


def _lines(reasons: Reasons) -> Iterator[tuple[str, int, str]]:
    """Text, size and color of each line."""
    yield f"No plan: {reasons.ended}", _TITLE, _INK
    for refusal in reasons.refusals[:SHOWN]:
        obstacles = ", ".join(f"{name} ({count})" for name, count in list(refusal.obstacles.items())[:SHOWN])
        said = f"{refusal.action}: {refusal.refused}" + (f"; in the way: {obstacles}" if obstacles else "")
        for text in wrap(said, _COLUMNS):
            yield text, _TEXT, _INK
        for text in wrap(refusal.advice, _COLUMNS - 4):
            yield f"    {text}", _TEXT, _PALE
    if len(reasons.refusals) > SHOWN:
        yield f"and {len(reasons.refusals) - SHOWN} more actions that never succeeded", _TEXT, _PALE
    for remark in reasons.remarks:
        for text in wrap(remark, _COLUMNS):
            yield text, _TEXT, _INK


def _draw_legend(draw: ImageDraw.ImageDraw, y: float, colors: set[str]) -> None:
    font, x = ImageFont.load_default(_TEXT), float(_MARGIN)
    for color, text in _LEGEND:
        if color in colors:
            draw.rectangle((x, y + 3, x + 11, y + 14), outline=color, width=3)
            draw.text((x + 17, y), text, fill=_PALE, font=font)
            x += 17 + draw.textlength(text, font) + 24
