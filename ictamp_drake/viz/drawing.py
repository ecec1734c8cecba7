"""Drawings of lines, dots and texts. SVG is written directly, other formats by matplotlib, which takes long to load."""

from collections.abc import Sequence
from dataclasses import dataclass, field
from html import escape
from pathlib import Path
from typing import Literal, NamedTuple

Color = tuple[float, float, float]
"""Red, green, blue in [0, 1]."""

Point = tuple[float, float]

FONT_SIZE = 7.0
"""Default size of texts [pt]."""

_INCH = 72.0
"""Points per inch: sizes of texts, lines and dots are in points, places in inches."""


def to_hex(color: Color | str) -> str:
    """Return a color as text, e.g. #1a8f3c; a text is returned unchanged."""
    if isinstance(color, str):
        return color
    return "#" + "".join(f"{round(255 * channel):02x}" for channel in color)


def to_rgb(text: str) -> Color:
    """Return the color of a text such as 1a8f3c or #1a8f3c."""
    red, green, blue = bytes.fromhex(text.removeprefix("#"))
    return red / 255, green / 255, blue / 255


class _Line(NamedTuple):
    points: Sequence[Point]
    color: str
    width: float
    dashes: tuple[float, float] | None
    opacity: float


class _Dot(NamedTuple):
    at: Point
    shape: Literal["circle", "square", "cross"]
    size: float
    fill: str
    edge: str
    width: float
    opacity: float


class _Text(NamedTuple):
    at: Point
    text: str
    anchor: Literal["start", "middle", "end"]
    color: str
    size: float
    bold: bool
    opacity: float


@dataclass
class Drawing:
    """A sheet of paper; y grows upwards.

    Attributes:
        width, height: Size of the sheet [in].
        left, top: Place of the sheet's upper left corner [in].
    """

    width: float
    height: float
    left: float = 0.0
    top: float = 0.0
    _items: list[tuple[int, _Line | _Dot | _Text]] = field(default_factory=list, init=False)

    def line(
        self,
        points: Sequence[Point],
        color: str,
        width: float,
        *,
        dashes: tuple[float, float] | None = None,
        opacity: float = 1.0,
    ) -> None:
        """Draw straight lines from point to point [in]; `dashes` are the lengths of strokes and gaps [pt]."""
        self._items.append((0, _Line(points, color, width, dashes, opacity)))

    def dot(
        self,
        at: Point,
        size: float,
        *,
        shape: Literal["circle", "square", "cross"] = "circle",
        fill: Color | str = "white",
        edge: str = "none",
        width: float = 0.0,
        opacity: float = 1.0,
        level: int = 1,
    ) -> None:
        """Draw a dot of diameter `size` [pt] above all lines and all dots of lower levels; a cross has only an edge."""
        self._items.append((level, _Dot(at, shape, size, to_hex(fill), edge, width, opacity)))

    def text(
        self,
        at: Point,
        text: str,
        color: str,
        *,
        anchor: Literal["start", "middle", "end"] = "start",
        size: float = FONT_SIZE,
        bold: bool = False,
        opacity: float = 1.0,
    ) -> None:
        """Write a text above all dots; `at` is the middle of its height."""
        self._items.append((9, _Text(at, text, anchor, color, size, bold, opacity)))

    def save(self, path: Path) -> None:
        """Write the drawing in the format of the path's suffix. Equal drawings give identical files."""
        if path.suffix == ".svg":
            path.write_text(self._svg(), encoding="utf-8")
        else:
            self._rasterize(path)

    def _sort_items(self) -> list[_Line | _Dot | _Text]:
        return [item for _, item in sorted(self._items, key=lambda item: item[0])]

    def _svg(self) -> str:
        width, height = (_number(_INCH * side) for side in (self.width, self.height))
        head = (
            f'<svg xmlns="http://www.w3.org/2000/svg" width="{width}pt" height="{height}pt" '
            f'viewBox="0 0 {width} {height}" font-family="DejaVu Sans, Verdana, sans-serif">'
        )
        paper = '<rect width="100%" height="100%" fill="white"/>'
        return "\n".join(
            ['<?xml version="1.0" encoding="utf-8"?>', head, paper, *map(self._tag, self._sort_items()), "</svg>\n"]
        )

    def _tag(self, item: _Line | _Dot | _Text) -> str:
        match item:
            case _Line():
                path = " ".join(",".join(self._place(point)) for point in item.points)
                dashes = "" if item.dashes is None else f' stroke-dasharray="{" ".join(map(_number, item.dashes))}"'
                return (
                    f'<polyline points="{path}" fill="none" stroke="{item.color}" stroke-width="{_number(item.width)}" '
                    f'stroke-linejoin="round"{dashes}{_opacity(item.opacity)}/>'
                )
            case _Dot():
                return self._dot_tag(item)
            case _Text():
                x, y = self._place(item.at, down=0.35 * item.size)
                bold = ' font-weight="bold"' if item.bold else ""
                return (
                    f'<text x="{x}" y="{y}" font-size="{_number(item.size)}" text-anchor="{item.anchor}" '
                    f'fill="{item.color}"{bold}{_opacity(item.opacity)}>{escape(item.text, quote=False)}</text>'
                )

    def _dot_tag(self, dot: _Dot) -> str:
        stroke = f'stroke="{dot.edge}" stroke-width="{_number(dot.width)}"{_opacity(dot.opacity)}'
        half = dot.size / 2
        x, y = self._place(dot.at)
        if dot.shape == "circle":
            return f'<circle cx="{x}" cy="{y}" r="{_number(half)}" fill="{dot.fill}" {stroke}/>'
        left, top = self._place(dot.at, right=-half, down=-half)
        size = _number(dot.size)
        if dot.shape == "square":
            return f'<rect x="{left}" y="{top}" width="{size}" height="{size}" fill="{dot.fill}" {stroke}/>'
        return f'<path d="M{left} {top}l{size} {size}m0 -{size}l-{size} {size}" fill="none" {stroke}/>'

    def _place(self, point: Point, right: float = 0.0, down: float = 0.0) -> tuple[str, str]:
        """Coordinates in the file, shifted `right` and `down` [pt] from a point."""
        return _number(_INCH * (point[0] - self.left) + right), _number(_INCH * (self.top - point[1]) + down)

    def _rasterize(self, path: Path) -> None:
        from matplotlib.figure import Figure  # noqa: PLC0415  (takes long to load, and is rarely needed)

        figure = Figure(figsize=(self.width, self.height))
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set(xlim=(self.left, self.left + self.width), ylim=(self.top - self.height, self.top))
        axes.set_axis_off()
        for order, item in enumerate(self._sort_items(), start=3):
            match item:
                case _Line(points, color, width, dashes, opacity):
                    style = "-" if dashes is None else (0.0, dashes)
                    axes.plot(*zip(*points, strict=True), c=color, lw=width, ls=style, alpha=opacity, zorder=order)
                case _Dot(at, shape, size, fill, edge, width, opacity):
                    marker = {"circle": "o", "square": "s", "cross": "x"}[shape]
                    look = {"ms": size, "mfc": fill, "mec": edge, "mew": width, "alpha": opacity}
                    axes.plot(*at, marker=marker, zorder=order, **look)  # type: ignore[arg-type]
                case _Text(at, text, anchor, color, size, bold, opacity):
                    look = {"c": color, "fontsize": size, "weight": "bold" if bold else "normal", "alpha": opacity}
                    side = {"start": "left", "middle": "center", "end": "right"}[anchor]
                    axes.text(*at, text, ha=side, va="center", zorder=order, **look)  # type: ignore[arg-type]
        figure.savefig(path, dpi=110, facecolor="white")


def _number(value: float) -> str:
    return f"{round(value, 2) + 0.0:.2f}".rstrip("0").rstrip(".")  # + 0.0 makes 0 of -0


def _opacity(opacity: float) -> str:
    return "" if opacity == 1.0 else f' opacity="{_number(opacity)}"'
