"""Draw the imports between rooms, as found in the code: `python scripts/draw_rooms.py`.

The drawing is `docs/images/rooms.svg`, which docs/architecture.md shows. A room stands one floor above the highest
room that it imports. Arrows that follow from other arrows are left out.
"""

from collections import defaultdict
from collections.abc import Mapping, Sequence
from functools import cache
from html import escape
from itertools import pairwise
from math import inf
from pathlib import Path
from statistics import mean

import grimp

ROOT = Path(__file__).parents[1]
DRAWING = ROOT / "docs" / "images" / "rooms.svg"
PACKAGE = "ictamp_drake"

Imports = Mapping[str, frozenset[str]]
Point = tuple[float, float]

WIDTH, HEIGHT, GAP, FLOOR, MARGIN = 130, 36, 26, 74, 14
"""Width and height of a box, gap between boxes, height of a floor, and margin [px]."""

LANE = 8
"""Width of a passing arrow in a row [px]."""

SWEEPS = 100
"""Passes over the rows; the first half also orders them."""

PULL = 0.8
"""Keeps rows near the middle: a node is drawn this far towards its neighbours, and the rest towards the middle."""


def read_imports() -> Imports:
    """Return the imports of each room. Rooms that neither import nor are imported are left out."""
    graph = grimp.build_graph(PACKAGE, cache_dir=None)
    rooms = sorted(graph.find_children(PACKAGE))

    def imports(one: str, other: str) -> bool:
        return one != other and graph.direct_import_exists(importer=one, imported=other, as_packages=True)

    found = {_name(one): frozenset(_name(other) for other in rooms if imports(one, other)) for one in rooms}
    return {room: below for room, below in found.items() if below or any(room in each for each in found.values())}


def find_floors(imports: Imports) -> dict[str, int]:
    """Return the floor of each room, counted from 0 at the bottom."""

    @cache
    def floor(room: str) -> int:
        return max((floor(below) + 1 for below in imports[room]), default=0)

    return {room: floor(room) for room in imports}


def find_arrows(imports: Imports) -> list[tuple[str, str]]:
    """Return the imports that do not follow from others."""

    @cache
    def reached(room: str) -> frozenset[str]:
        return imports[room].union(*map(reached, imports[room]))

    return [
        (room, below)
        for room in sorted(imports)
        for below in sorted(imports[room])
        if not any(below in reached(between) for between in imports[room])
    ]


def draw(imports: Imports) -> str:
    """Return the drawing as SVG text."""
    floors, arrows = find_floors(imports), find_arrows(imports)
    chains = [_chain(arrow, floors) for arrow in arrows]
    rows = _make_rows(floors, chains)
    x = _place(rows, chains)
    height = len(rows) * FLOOR - (FLOOR - HEIGHT) + 2 * MARGIN
    y = {node: height - MARGIN - HEIGHT / 2 - floor * FLOOR for floor, row in enumerate(rows) for node in row}
    points = {node: (x[node], y[node]) for node in x}
    width = max(x[node] + _width(node) / 2 for node in x) + MARGIN
    lines = [_arrow([points[node] for node in chain]) for chain in chains]
    boxes = [_box(room, points[room]) for room in imports]
    return _HEAD.format(width=width, height=height) + "\n".join([*lines, *boxes, "</svg>"]) + "\n"


_HEAD = """\
<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width:g} {height:g}" width="{width:g}" height="{height:g}">
<title>Rooms of ictamp_drake, each above what it imports</title>
<defs><marker id="tip" viewBox="0 0 8 8" refX="7" refY="4" markerWidth="7" markerHeight="7" orient="auto">\
<path d="M0 0 8 4 0 8z" fill="#64748b"/></marker></defs>
<rect width="100%" height="100%" fill="#ffffff"/>
"""


def _name(module: str) -> str:
    return module.removeprefix(f"{PACKAGE}.")


def _chain(arrow: tuple[str, str], floors: Mapping[str, int]) -> list[str]:
    """Return the rooms of an arrow, with a lane on each floor that it passes."""
    above, below = arrow
    lanes = [f"{above}>{below}>{floor}" for floor in range(floors[above] - 1, floors[below], -1)]
    return [above, *lanes, below]


def _make_rows(floors: Mapping[str, int], chains: Sequence[Sequence[str]]) -> list[list[str]]:
    """Return the rooms and lanes on each floor."""
    rows: list[list[str]] = [[] for _ in range(max(floors.values()) + 1)]
    for room in sorted(floors):
        rows[floors[room]].append(room)
    for chain in chains:
        for lane in chain[1:-1]:
            rows[int(lane.rpartition(">")[2])].append(lane)
    return rows


def _place(rows: Sequence[list[str]], chains: Sequence[Sequence[str]]) -> dict[str, float]:
    """Middle of each node, so that few arrows cross and bend; orders the rows."""
    above: defaultdict[str, list[str]] = defaultdict(list)
    below: defaultdict[str, list[str]] = defaultdict(list)
    for chain in chains:
        for upper, lower in pairwise(chain):
            below[upper].append(lower)
            above[lower].append(upper)
    x = {node: middle for row in rows for node, middle in _spread(row, dict.fromkeys(row, 0.0)).items()}
    for sweep in range(SWEEPS):
        upwards = sweep % 2 == 1
        for row in rows if upwards else rows[::-1]:
            if sweep < SWEEPS // 2:
                placed = below if upwards else above
                row.sort(key=lambda node: mean([x[near] for near in placed[node]] or [x[node]]))
            x |= _spread(row, {node: PULL * mean(x[near] for near in above[node] + below[node]) for node in row})
    left = min(x[node] - _width(node) / 2 for node in x)
    return {node: round(middle - left + MARGIN, 1) for node, middle in x.items()}


def _spread(row: Sequence[str], wanted: Mapping[str, float]) -> dict[str, float]:
    """Return places near the wanted ones, in the order of the row, with gaps."""
    rightwards = _push(row, wanted)
    leftwards = _push(row[::-1], {node: -place for node, place in wanted.items()})
    return {node: (rightwards[node] - leftwards[node]) / 2 for node in row}


def _push(row: Sequence[str], wanted: Mapping[str, float]) -> dict[str, float]:
    """Return places at or beyond the wanted ones, each clear of the previous one."""
    places: dict[str, float] = {}
    edge = -inf
    for node in row:
        places[node] = max(wanted[node], edge + _width(node) / 2)
        edge = places[node] + _width(node) / 2 + GAP
    return places


def _width(node: str) -> float:
    return LANE if ">" in node else WIDTH


def _arrow(points: Sequence[Point]) -> str:
    """Return a smooth line from below the first point to above the last one."""
    (x, y), *_, (x_end, y_end) = points
    corners = [(x, y + HEIGHT / 2), *points[1:-1], (x_end, y_end - HEIGHT / 2)]
    path = f"M{corners[0][0]:g} {corners[0][1]:g}"
    for (x, y), (x_next, y_next) in pairwise(corners):
        middle = (y + y_next) / 2
        path += f"C{x:g} {middle:g} {x_next:g} {middle:g} {x_next:g} {y_next:g}"
    return f'<path d="{path}" fill="none" stroke="#64748b" stroke-width="1.3" marker-end="url(#tip)"/>'


def _box(room: str, at: Point) -> str:
    x, y = at
    return (
        f'<rect x="{x - WIDTH / 2:g}" y="{y - HEIGHT / 2:g}" width="{WIDTH}" height="{HEIGHT}" rx="6" fill="#e8f0fb" '
        f'stroke="#3b6fb5"/>\n<text x="{x:g}" y="{y + 5:g}" text-anchor="middle" font-family="sans-serif" '
        f'font-size="15" fill="#12263f">{escape(room)}</text>'
    )


if __name__ == "__main__":
    DRAWING.write_text(draw(read_imports()), encoding="utf-8")
