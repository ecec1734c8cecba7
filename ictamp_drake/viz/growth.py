"""Figure 1 over time: the tree of a search at several moments, side by side, from the record of `Tree.to_dict`.

Every item keeps its place from picture to picture. Items that are new since the previous picture are dark, the others
pale.
"""

from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

from ictamp_drake.viz.drawing import Drawing, Point
from ictamp_drake.viz.layout import FOUND, LABEL, LINE, REFUSED, Layout, Record

COLUMN, ROW, MARGIN, HEADER = 0.42, 0.22, 0.2, 0.3  # sizes on paper [in]
WIDTH = 13.0  # maximum width of a line of pictures [in]


def draw_growth(tree: Record, path: Path, moments: int = 4) -> None:
    """Write pictures of the tree after equal shares of its plans and steps, the last one at the end, as SVG or PNG.

    Args:
        tree: Record from `Tree.to_dict`, also when read from a file.
        path: File to write.
        moments: Number of pictures; fewer if there are fewer plans and steps.
    """
    layout, log = Layout(tree), tree["log"]
    grown = [now for now, entry in enumerate(log, 1) if entry["event"] == "step" or entry["plan"] is not None]
    parts = {round(len(grown) * share / moments) for share in range(1, moments)} - {0, len(grown)}
    ends = [-1, *(grown[part - 1] for part in sorted(parts)), len(log)]
    width = max(layout.depth, 3) * COLUMN + 2 * MARGIN
    height = max(layout.levels) * ROW + 2 * MARGIN + HEADER
    columns = max(1, min(len(ends) - 1, int(WIDTH / width)))
    lines = -(-(len(ends) - 1) // columns)
    paper = Drawing(columns * width, lines * height)
    for number, (before, now) in enumerate(pairwise(ends)):
        line, column = divmod(number, columns)
        x, y = column * width + MARGIN, -line * height - MARGIN - HEADER
        paper.text((x - MARGIN / 2, y + HEADER), _heading(log[:now]), LABEL)
        _Moment(layout, paper, x, y, before, now, now == len(log)).draw()
    paper.save(path)


def _heading(log: list[Record]) -> str:
    plans = sum(entry["event"] == "opening" and entry["plan"] is not None for entry in log)
    steps = sum(entry["event"] == "step" for entry in log)
    return f"{steps} step{'s' * (steps != 1)}, {plans} plan{'s' * (plans != 1)}"


@dataclass(frozen=True)
class _Moment:
    """One picture.

    Attributes:
        layout: Layout of the whole search.
        paper: Drawing to draw on.
        x, y: Place of the root [in].
        before: Number of log entries at the previous picture.
        now: Number of log entries at this picture.
        last: Whether the search has ended, so that the path to the goal is known.
    """

    layout: Layout
    paper: Drawing
    x: float
    y: float
    before: int
    now: int
    last: bool

    def draw(self) -> None:
        """Draw everything that exists by now."""
        for number, stub in enumerate(self.layout.stubs, len(self.layout.nodes)):
            if stub.born <= self.now:
                self._draw_stub(stub.node, number, self._shade(stub.born))
        for node in self.layout.nodes:
            if self.layout.born[node["index"]] <= self.now:
                self._draw_node(node)

    def _shade(self, born: int) -> float:
        """Opacity of an item that appeared with log entry `born`."""
        return 1.0 if born > self.before or self.last else 0.35

    def _place(self, node: int) -> Point:
        return self.x + self.layout.nodes[node]["depth"] * COLUMN, self.y - self.layout.levels[node] * ROW

    def _edge(self, parent: int, x: float, y: float) -> list[Point]:
        start, above = self._place(parent)
        bend = start + 0.3 * COLUMN
        return [(start, above), (bend, above), (bend, y), (x, y)]

    def _draw_stub(self, node: int, item: int, shade: float) -> None:
        x, y = self._place(node)[0] + 0.6 * COLUMN, self.y - self.layout.levels[item] * ROW
        self.paper.line(self._edge(node, x, y), LINE, 0.7, dashes=(2.1, 1.4), opacity=shade)
        self.paper.dot((x, y), 4, shape="cross", edge=REFUSED, width=1.1, opacity=shade)

    def _draw_node(self, node: Record) -> None:
        index = node["index"]
        shade, found = self._shade(self.layout.born[index]), self.last and index in self.layout.solution
        color = FOUND if found else LABEL
        x, y = self._place(index)
        if node["parent"] is not None:
            self.paper.line(self._edge(node["parent"], x, y), color, 1.8 if found else 0.9, opacity=shade)
        self.paper.dot((x, y), 9.5)
        fill = self.layout.color(self.layout.plan_of.get(index))
        self.paper.dot((x, y), 9.5, fill=fill, edge=color, width=1.4 if found else 0.7, opacity=shade, level=2)
        self.paper.text((x, y), str(index), "black", anchor="middle", size=5.2, opacity=max(shade, 0.5))
