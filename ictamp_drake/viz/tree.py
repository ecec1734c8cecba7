"""Picture of a search like the paper's Figure 1, from the record that `planning.tree.Tree.to_dict` writes.

Depth runs to the right, so a rollout is a straight line. Solid lines are steps that succeeded; a dashed stub with a
cross stands for all failures of one action at one node. The opened plans are listed to the left of the root.
"""

from collections import Counter
from pathlib import Path

from ictamp_drake.core.failures import Cause
from ictamp_drake.viz.drawing import Color, Drawing, Point, to_hex
from ictamp_drake.viz.layout import FOUND, LABEL, LINE, REFUSED, Layout, Record, Stub, cause_color

ROW, MARGIN, HEADER, SHELF = 0.3, 0.25, 0.75, 2.85  # sizes on paper [in]
LETTER = 0.062  # width of a letter in labels [in]
MAX_PLANS = 12  # plans listed beside the root


def draw_tree(tree: Record, path: Path, title: str = "") -> None:
    """Write the picture of a search as SVG or PNG, depending on the path's suffix.

    Args:
        tree: Record from `Tree.to_dict`, also when read from a file.
        path: File to write.
        title: Title in front of the search's numbers.
    """
    _Picture(tree).draw(title).save(path)


class _Picture:
    """The whole picture, with places in inches from the root; y grows upwards."""

    def __init__(self, tree: Record) -> None:
        self.tree = tree
        self.layout = Layout(tree)
        self.column = 0.75 + LETTER * max(map(len, self.layout.labels.values()), default=0)

    def place(self, node: int) -> Point:
        return self.layout.nodes[node]["depth"] * self.column, -self.layout.levels[node] * ROW

    def draw(self, title: str) -> Drawing:
        shelf = self._shelf()
        right = max(self.layout.depth * self.column + 2 * MARGIN, 5.0)
        bottom = max(*self.layout.levels, len(shelf), 1) * ROW + MARGIN
        left, top = -SHELF - MARGIN, HEADER + MARGIN
        paper = Drawing(right - left, top + bottom, left, top)
        self._draw_header(paper, title)
        self._draw_shelf(paper, shelf)
        for number, stub in enumerate(self.layout.stubs):
            self._draw_stub(paper, stub, -self.layout.levels[len(self.layout.nodes) + number] * ROW)
        for node in self.layout.nodes:
            self._draw_node(paper, node)
        return paper

    def _draw_header(self, paper: Drawing, title: str) -> None:
        summary = self.tree["summary"]
        outcome = "solved" if self.tree["solution"] is not None else "not solved"
        plans, steps = f"plans opened: {summary['high_level_plans']}", f"steps: {summary['low_level_steps']}"
        failed, nodes = f"failed: {summary['low_level_failures']}", f"nodes: {summary['nodes']}"
        text = " · ".join([*([title] if title else []), outcome, plans, steps, failed, nodes])
        x, y = -SHELF, HEADER + MARGIN - 0.2
        paper.text((x, y), text, "black", size=9, bold=True)
        causes: Counter[Cause] = sum((stub.causes for stub in self.layout.stubs), Counter())
        for cause, times in causes.most_common():
            text = f"{cause} ({times})"
            paper.dot((x + 0.05, y - 0.28), 5, shape="cross", edge=to_hex(cause_color(cause)), width=1.4)
            paper.text((x + 0.14, y - 0.28), text, "black")
            x += 0.3 + LETTER * len(text)

    def _shelf(self) -> list[tuple[str, Color | None]]:
        """Return a line of text and a color for each opened plan, the tried ones first."""
        tries = Counter(step["plan"] for step in self.layout.steps if step["node"] == 0)
        lines: list[tuple[bool, str, int]] = []
        steps = 0
        for number, entry in enumerate(self.tree["log"]):
            if entry["event"] == "step":
                steps += 1
            elif number in self.layout.expanded:
                plan, expanded = entry["plan"], self.layout.expanded[number]
                tried = f"tried {tries[plan]}×" if plan in tries else "never tried"
                text = f"plan {plan}, after step {steps}: {expanded} expanded, {tried}"
                lines.append((plan not in tries, text, plan))
        lines.sort(key=lambda line: line[0])
        shown: list[tuple[str, Color | None]] = [(text, self.layout.color(plan)) for _, text, plan in lines[:MAX_PLANS]]
        rest = len(lines) - len(shown)
        return shown + ([(f"and {rest} more plans", None)] if rest else [])

    def _draw_shelf(self, paper: Drawing, shelf: list[tuple[str, Color | None]]) -> None:
        if not shelf:
            return
        x = -0.45
        paper.line([(x, -(len(shelf) - 1) * ROW), (x, 0), (0, 0)], LINE, 0.8, dashes=(0.8, 1.3))
        for row, (text, color) in enumerate(shelf):
            if color is not None:
                paper.dot((x, -row * ROW), 7, shape="square", fill=color, edge=LINE, width=0.8)
            paper.text((x - 0.12, -row * ROW), text, LABEL, anchor="end", size=6.5)

    def _draw_node(self, paper: Drawing, node: Record) -> None:
        index, (x, y) = node["index"], self.place(node["index"])
        found = index in self.layout.solution
        if node["parent"] is not None:
            paper.line(self._edge(node["parent"], x, y), FOUND if found else LINE, 2.2 if found else 1.0)
            label = self.layout.labels[node["action"]]
            paper.text((x - 0.17, y + 0.09), label, FOUND if found else LABEL, anchor="end")
        verified = {entry["node"]: entry["verified"] for entry in self.tree["candidates"]}
        edge = {True: FOUND, False: REFUSED}.get(verified.get(index), FOUND if found else LABEL)  # type: ignore[arg-type]
        width = 1.6 if found or index in verified else 0.8
        if index in verified:
            paper.dot((x, y), 19, edge=edge, width=1.2)
        fill = self.layout.color(self.layout.plan_of.get(index))
        paper.dot((x, y), 15, fill=fill, edge=edge, width=width, level=2)
        paper.text((x, y), str(index), "black", anchor="middle", size=6.5)

    def _edge(self, parent: int, x: float, y: float) -> list[Point]:
        start, above = self.place(parent)
        return [(start, above), (start + 0.2, above), (start + 0.2, y), (x, y)]

    def _draw_stub(self, paper: Drawing, stub: Stub, y: float) -> None:
        end = self.place(stub.node)[0] + 0.38
        cause = stub.causes.most_common(1)[0][0]
        paper.line(self._edge(stub.node, end, y), LINE, 0.8, dashes=(2.4, 1.6))
        paper.dot((end, y), 5, shape="cross", edge=to_hex(cause_color(cause)), width=1.4)
        text = f"{stub.causes.total()}× {self.layout.labels[stub.action]}"
        paper.text((end + 0.09, y), text, LABEL)
