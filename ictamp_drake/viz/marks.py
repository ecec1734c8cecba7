"""Outlines, names and a caption on the picture of a scene in which no plan was found."""

from collections.abc import Iterator, Mapping
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

_MARGIN, _GAP = 14, 8
"""Around the caption, and between a thing and its name [pixels]."""

_INK, _PALE, _PAPER = "#26303c", "#5b6570", "#ffffff"

_LEGEND = ((MOVED, "could not be moved"), (OBSTACLE, "was in the way"), (WHERE, "where it stands or was to go"))


def mark(image: Image.Image, silhouettes: Mapping[str, NDArray[np.bool_]], colors: Mapping[str, str]) -> Image.Image:
    """The picture with outlines and names of things.

    Args:
        image: Picture to mark.
        silhouettes: Mask of each object in the picture by name, shape (height, width).
        colors: Color of each object by name.
    """
    marked = image.copy()
    masks = {name: Image.fromarray(silhouette).convert("L") for name, silhouette in silhouettes.items()}
    for width, white in ((_HALO, True), (_LINE, False)):
        for name, mask in masks.items():
            outline = np.asarray(mask.filter(ImageFilter.MaxFilter(width))) > np.asarray(mask)
            marked.paste(_PAPER if white else colors[name], mask=Image.fromarray(outline))
    crowd = np.zeros((image.height, image.width))  # small things are the easiest to hide
    for silhouette in silhouettes.values():
        crowd += silhouette / max(silhouette.sum(), 1)
    for name, mask in sorted(masks.items(), key=lambda item: colors[item[0]] != MOVED):
        if (inside := mask.getbbox()) is not None:
            _write_name(ImageDraw.Draw(marked), name, colors[name], inside, crowd)
    return marked


def _write_name(
    draw: ImageDraw.ImageDraw, name: str, color: str, thing: tuple[int, int, int, int], crowd: NDArray[np.float64]
) -> None:
    """Write a name beside a thing where it hides the least, and note that its place is taken."""
    font = ImageFont.load_default(_NAME)
    width, height = round(draw.textlength(name, font)) + 12, _NAME + 7
    rows, columns = crowd.shape
    left, top, right, bottom = thing
    middle = ((left + right - width) // 2, (top + bottom - height) // 2)
    above = [(middle[0], top - _GAP - (rise + 1) * height) for rise in range(4)]
    beside = [(right + _GAP, middle[1]), (left - _GAP - width, middle[1]), (middle[0], bottom + _GAP)]
    places = [
        (min(max(x, 0), columns - width), min(max(y, 0), rows - height)) for x, y in (above[0], *beside, *above[1:])
    ]
    x, y = min(places, key=lambda place: float(crowd[place[1] :, place[0] :][:height, :width].sum()))
    crowd[y : y + height, x : x + width] += 1
    draw.rounded_rectangle((x, y, x + width, y + height), 5, fill=color, outline=_PAPER)
    draw.text((x + width / 2, y + height / 2), name, fill=_PAPER, font=font, anchor="mm")


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
        yield f"and {len(reasons.refusals) - SHOWN} more that never succeeded", _TEXT, _PALE
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
