"""The picture of a search, as the paper's Figure 1, from the record that `planning.tree.Tree.to_dict` writes.

Depth runs to the right, so a rollout is a straight line. Solid lines are steps that succeeded; a dashed stub with a
cross stands for all failures of one action at one node. The plans that the root was given stand to its left.
"""

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import matplotlib as mpl
from matplotlib.axes import Axes
from matplotlib.figure import Figure
from matplotlib.lines import Line2D

from ictamp_drake.core.failures import Failure

Record = Mapping[str, Any]

ROW, MARGIN, HEADER, SHELF = 0.3, 0.25, 0.75, 2.85  # sizes on paper [in]
LETTER = 0.062  # width of a letter of a label [in]
LABEL, LINE, FOUND, REFUSED = "#333333", "#8a8a8a", "#1a8f3c", "#c62828"
MAX_PLANS = 12  # plans listed beside the root
CAUSE_COLORS = dict(zip(Failure, mpl.colormaps["tab20"].colors[::2] + mpl.colormaps["Dark2"].colors, strict=False))  # type: ignore[attr-defined]
PLAN_COLORS = mpl.colormaps["Pastel1"].colors[:8] + mpl.colormaps["Set3"].colors  # type: ignore[attr-defined]


@dataclass(frozen=True)
class Stub:
    """All failures of one action at one node."""

    node: int
    action: str
    causes: Counter[Failure]


def draw_tree(tree: Record, path: Path, title: str = "") -> None:
    """Write the picture of a search as SVG or PNG, whichever the path's suffix says.

    Args:
        tree: what `Tree.to_dict` returned, or the same read from a file.
        path: where to write.
        title: put before the figures of the search.
    """
    with mpl.rc_context({"svg.hashsalt": "tree", "svg.fonttype": "none", "font.size": 7}):
        figure = _Picture(tree).draw(title)
        metadata = {"Date": None} if path.suffix == ".svg" else {}
        figure.savefig(path, dpi=110, metadata=metadata, facecolor="white")


def rows(parents: list[int | None], nodes: int, preferred: frozenset[int] = frozenset()) -> list[int]:
    """The row of each item of a tree: a parent is level with its first child, and no two branches cross.

    Args:
        parents: for each item its parent, which comes before it; None for the root alone. Nodes come first, then stubs.
        nodes: how many of the items are nodes.
        preferred: nodes that become the first among their siblings; otherwise the order is that of the list.
    """
    children: defaultdict[int, list[int]] = defaultdict(list)
    depths: list[int] = []
    for item, parent in enumerate(parents):
        depths.append(0 if parent is None else depths[parent] + 1)
        if parent is not None:
            children[parent].append(item)
    offsets = [0] * len(parents)
    # Lowest row of each branch in each zone: items of depth d are in zone 2 d, the lines that leave them in 2 d + 1.
    bottoms: list[dict[int, int]] = [{} for _ in parents]
    for item in reversed(range(len(parents))):
        bottom = bottoms[item]
        for child in _siblings(children[item], nodes, preferred):
            offsets[child] = max((bottom[zone] + 1 for zone in bottoms[child] if zone in bottom), default=0)
            bottom.update({zone: low + offsets[child] for zone, low in bottoms[child].items()})
        zone = 2 * depths[item]
        bottom[zone] = 0
        if item < nodes:
            bottom[zone + 1] = max((offsets[child] for child in children[item]), default=0)
    levels = [0] * len(parents)
    for item, parent in enumerate(parents):
        levels[item] = offsets[item] + (0 if parent is None else levels[parent])
    return levels


def _siblings(items: list[int], nodes: int, preferred: frozenset[int]) -> list[int]:
    """The first node level with its parent, then the stubs, so that they are near, then the other nodes."""
    ordered = sorted(items, key=lambda item: (item not in preferred, item))
    return ordered[:1] + sorted(ordered[1:], key=lambda item: (item < nodes, item))


def abbreviations(actions: Iterable[str]) -> dict[str, str]:
    """A short label for each action: objects lose what follows their first underscore where they stay distinct."""
    parts = {action: action.rstrip(")").replace("(", ", ").split(", ") for action in actions}
    objects = {name for _, *names in parts.values() for name in names}
    heads = Counter(name.split("_")[0] for name in objects)
    short = {name: head if heads[head := name.split("_")[0]] == 1 else name for name in objects}
    return {
        action: " ".join([name, *(short[o] for o in names if o)]).strip() for action, (name, *names) in parts.items()
    }


class _Picture:
    """Everything that is drawn, placed in inches from the root; y grows upwards."""

    def __init__(self, tree: Record) -> None:
        self.tree = tree
        self.nodes: list[Record] = tree["nodes"]
        self.steps: list[Record] = [entry for entry in tree["log"] if entry["event"] == "step"]
        self.stubs = _stubs(self.steps)
        self.solution = _ancestors(self.nodes, tree["solution"])
        self.labels = abbreviations({step["action"] for step in self.steps})
        self.plan_of = _opened_plans(self.steps)
        self.plans = list(dict.fromkeys(entry["plan"] for entry in tree["log"] if entry["event"] == "opening"))
        parents = [node["parent"] for node in self.nodes] + [stub.node for stub in self.stubs]
        self.levels = rows(parents, len(self.nodes), self.solution)
        self.column = 0.75 + LETTER * max(map(len, self.labels.values()), default=0)

    def place(self, node: int) -> tuple[float, float]:
        return self.nodes[node]["depth"] * self.column, -self.levels[node] * ROW

    def draw(self, title: str) -> Figure:
        shelf = self._shelf()
        depth = max(
            [node["depth"] for node in self.nodes] + [self.nodes[stub.node]["depth"] + 1 for stub in self.stubs]
        )
        right = max(depth * self.column + 2 * MARGIN, 5.0)
        bottom = max(*self.levels, len(shelf), 1) * ROW + MARGIN
        width, height = SHELF + right + MARGIN, HEADER + bottom + MARGIN
        figure = Figure(figsize=(width, height))
        axes = figure.add_axes((0, 0, 1, 1))
        axes.set(xlim=(-SHELF - MARGIN, right), ylim=(-bottom, HEADER + MARGIN))
        axes.set_axis_off()
        self._draw_header(axes, title)
        self._draw_shelf(axes, shelf)
        for number, stub in enumerate(self.stubs):
            self._draw_stub(axes, stub, -self.levels[len(self.nodes) + number] * ROW)
        for node in self.nodes:
            self._draw_node(axes, node)
        return figure

    def _draw_header(self, axes: Axes, title: str) -> None:
        summary = self.tree["summary"]
        outcome = "solved" if self.tree["solution"] is not None else "not solved"
        text = (
            f"{outcome}   plans opened: {summary['high_level_plans']}   steps: {summary['low_level_steps']}   "
            f"failed: {summary['low_level_failures']}   nodes: {summary['nodes']}"
        )
        top = HEADER + MARGIN - 0.2
        axes.text(-SHELF, top, f"{title}   {text}".strip(), fontsize=9, va="center", weight="bold")
        causes: Counter[Failure] = sum((stub.causes for stub in self.stubs), Counter())
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
        tries = Counter(step["plan"] for step in self.steps if step["node"] == 0)
        lines: list[tuple[bool, str, int]] = []
        steps = 0
        for entry in self.tree["log"]:
            if entry["event"] == "step":
                steps += 1
            elif (plan := entry["plan"]) is not None:
                tried = f"tried {tries[plan]}×" if plan in tries else "never tried"
                text = f"plan {plan}, after step {steps}: {entry['expanded']} expanded, {tried}"
                lines.append((plan not in tries, text, plan))
        lines.sort(key=lambda line: line[0])
        shown = [(text, self._color(plan)) for _, text, plan in lines[:MAX_PLANS]]
        rest = len(lines) - len(shown)
        return shown + ([(f"and {rest} more plans", None)] if rest else [])

    def _color(self, plan: int | None) -> Any:
        return "white" if plan is None else PLAN_COLORS[self.plans.index(plan) % len(PLAN_COLORS)]

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
        found = index in self.solution
        if node["parent"] is not None:
            self._draw_edge(axes, node["parent"], y, x, color=FOUND if found else LINE, lw=2.2 if found else 1.0)
            color = FOUND if found else LABEL
            axes.text(x - 0.17, y + 0.03, self.labels[node["action"]], ha="right", va="bottom", color=color)
        verified = {entry["node"]: entry["verified"] for entry in self.tree["candidates"]}
        edge = {True: FOUND, False: REFUSED}.get(verified.get(index), FOUND if found else LABEL)  # type: ignore[arg-type]
        width = 1.6 if found or index in verified else 0.8
        if index in verified:
            axes.plot(x, y, marker="o", ms=19, color="white", mec=edge, mew=1.2, zorder=3)
        fill = self._color(self.plan_of.get(index))
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
        text = f"{stub.causes.total()}× {self.labels[stub.action]}"
        axes.text(end + 0.09, y, text, ha="left", va="center", color=LABEL)


def _stubs(steps: list[Record]) -> list[Stub]:
    causes: defaultdict[tuple[int, str], Counter[Failure]] = defaultdict(Counter)
    for step in steps:
        if step["failure"] is not None:
            causes[step["node"], step["action"]][Failure[step["failure"]]] += 1
    return [Stub(node, action, counter) for (node, action), counter in causes.items()]


def _ancestors(nodes: list[Record], node: int | None) -> frozenset[int]:
    found: set[int] = set()
    while node is not None:
        found.add(node)
        node = nodes[node]["parent"]
    return frozenset(found)


def _opened_plans(steps: list[Record]) -> dict[int, int]:
    """For each node the opened plan that its branch began with."""
    plans: dict[int, int] = {}
    for step in steps:
        if step["child"] is not None:
            plans[step["child"]] = step["plan"] if step["node"] == 0 else plans[step["node"]]
    return plans
