"""The picture of a search, as the paper's Figure 1, from the record that `planning.tree.Tree.to_dict` writes.

Depth runs to the right, so a rollout is a straight line. Solid lines are steps that succeeded; a dashed stub with a
cross stands for all failures of one action at one node. The plans that the root was given stand to its left.
"""

from collections import Counter
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ictamp_drake.core.failures import Failure
from ictamp_drake.viz.layout import CAUSE_COLORS, FOUND, LABEL, LINE, REFUSED, Layout, Record, Stub

ROW, MARGIN, HEADER, SHELF = 0.3, 0.25, 0.75, 2.85  # sizes on paper [in]
LETTER = 0.062  # width of a letter of a label [in]
MAX_PLANS = 12  # plans listed beside the root


def draw_tree(tree: Record, path: Path, title: str = "") -> None:
    """Write the picture of a search as SVG or PNG, whichever the path's suffix says.

    Args:
        tree: what `Tree.to_dict` returned, or the same read from a file.
        path: where to write.
        title: put before the figures of the search.
    """
    with mpl.rc_context({"font.size": 7}):
        save_picture(_Picture(tree).draw(title), path)


def save_picture(figure: Figure, path: Path) -> None:
    """Write a figure so that the same one gives the same file."""
    with mpl.rc_context({"svg.hashsalt": "tree", "svg.fonttype": "none"}):
        metadata = {"Date": None} if path.suffix == ".svg" else {}
        figure.savefig(path, dpi=110, metadata=metadata, facecolor="white")


class _Picture:
    """Everything that is drawn, placed in inches from the root; y grows upwards."""

    def __init__(self, tree: Record) -> None:
        self.tree = tree
        self.layout = Layout(tree)
        self.column = 0.75 + LETTER * max(map(len, self.layout.labels.values()), default=0)

    def place(self, node: int) -> tuple[float, float]:
        return self.layout.nodes[node]["depth"] * self.column, -self.layout.levels[node] * ROW

    def draw(self, title: str) -> Figure:
        shelf = self._shelf()
        right = max(self.layout.depth * self.column + 2 * MARGIN, 5.0)
        bottom = max(*self.layout.levels, len(shelf), 1) * ROW + MARGIN
        width, height = SHELF + right + MARGIN, HEADER + bottom + MARGIN
        figure = Figure(figsize=(width, height))
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set(xlim=(-SHELF - MARGIN, right), ylim=(-bottom, HEADER + MARGIN))
        axes.set_axis_off()
        self._draw_header(axes, title)
        self._draw_shelf(axes, shelf)
        for number, stub in enumerate(self.layout.stubs):
            self._draw_stub(axes, stub, -self.layout.levels[len(self.layout.nodes) + number] * ROW)
        for node in self.layout.nodes:
            self._draw_node(axes, node)
        return figure

    def _draw_header(self, axes: Axes, title: str) -> None:
        summary = self.tree["summary"]
        outcome = "solved" if self.tree["solution"] is not None else "not solved"
        plans, steps = f"plans opened: {summary['high_level_plans']}", f"steps: {summary['low_level_steps']}"
        failed, nodes = f"failed: {summary['low_level_failures']}", f"nodes: {summary['nodes']}"
        text = " · ".join([*([title] if title else []), outcome, plans, steps, failed, nodes])
        top = HEADER + MARGIN - 0.2
        axes.text(-SHELF, top, text, fontsize=9, va="center", weight="bold")
        causes: Counter[Failure] = sum((stub.causes for stub in self.layout.stubs), Counter())
        entries = [(f"{cause} ({times})", CAUSE_COLORS[cause]) for cause, times in causes.most_common()]
        handles = [Line2D([], [], marker="x", ls="", ms=5, mew=1.4, color=color, label=text) for text, color in entries]
        if handles:
            axes.legend(
                handles=handles,
                loc="center left",
                bbox_to_anchor=(-SHELF - 0.08, top - 0.28),
                bbox_transform=axes.transData,
                ncols=len(handles),
                frameon=False,
                handletextpad=0.0,
                columnspacing=1.0,
            )

    def _shelf(self) -> list[tuple[str, Any]]:
        """One line and one colour for each opened plan, the tried ones first."""
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
        shown = [(text, self.layout.color(plan)) for _, text, plan in lines[:MAX_PLANS]]
        rest = len(lines) - len(shown)
        return shown + ([(f"and {rest} more plans", None)] if rest else [])

    def _draw_shelf(self, axes: Axes, shelf: list[tuple[str, Any]]) -> None:
        if not shelf:
            return
        x = -0.45
        axes.plot([x, x, 0], [-(len(shelf) - 1) * ROW, 0, 0], color=LINE, lw=0.8, ls=":", zorder=1)
        for row, (text, color) in enumerate(shelf):
            if color is not None:
                axes.plot(x, -row * ROW, marker="s", ms=7, color=color, mec=LINE, mew=0.8, zorder=3)
            axes.text(x - 0.12, -row * ROW, text, ha="right", va="center", color=LABEL, fontsize=6.5)

    def _draw_node(self, axes: Axes, node: Record) -> None:
        index, (x, y) = node["index"], self.place(node["index"])
        found = index in self.layout.solution
        if node["parent"] is not None:
            self._draw_edge(axes, node["parent"], y, x, color=FOUND if found else LINE, lw=2.2 if found else 1.0)
            color = FOUND if found else LABEL
            axes.text(x - 0.17, y + 0.03, self.layout.labels[node["action"]], ha="right", va="bottom", color=color)
        verified = {entry["node"]: entry["verified"] for entry in self.tree["candidates"]}
        edge = {True: FOUND, False: REFUSED}.get(verified.get(index), FOUND if found else LABEL)  # type: ignore[arg-type]
        width = 1.6 if found or index in verified else 0.8
        if index in verified:
            axes.plot(x, y, marker="o", ms=19, color="white", mec=edge, mew=1.2, zorder=3)
        fill = self.layout.color(self.layout.plan_of.get(index))
        axes.plot(x, y, marker="o", ms=15, color=fill, mec=edge, mew=width, zorder=4)
        axes.text(x, y - 0.005, str(index), ha="center", va="center_baseline", fontsize=6.5, zorder=5)

    def _draw_edge(self, axes: Axes, parent: int, y: float, end: float, **style: Any) -> None:
        x, above = self.place(parent)
        axes.plot([x, x + 0.2, x + 0.2, end], [above, above, y, y], solid_joinstyle="round", zorder=2, **style)

    def _draw_stub(self, axes: Axes, stub: Stub, y: float) -> None:
        end = self.place(stub.node)[0] + 0.38
        cause = stub.causes.most_common(1)[0][0]
        self._draw_edge(axes, stub.node, y, end, color=LINE, lw=0.8, ls=(0, (3, 2)))
        axes.plot(end, y, marker="x", ms=5, mew=1.4, color=CAUSE_COLORS[cause], zorder=3)
        text = f"{stub.causes.total()}× {self.layout.labels[stub.action]}"
        axes.text(end + 0.09, y, text, ha="left", va="center", color=LABEL)
