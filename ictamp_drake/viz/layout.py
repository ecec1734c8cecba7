"""Layout of the tree of a search for all its pictures, computed from the record that `Tree.to_dict` writes.

Depth runs to the right, so a rollout is a straight line. A stub stands for all failures of one action at one node.
"""

from collections import Counter, defaultdict
from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any

from ictamp_drake.core.failures import Cause, Failure
from ictamp_drake.viz.drawing import Color, to_rgb

Record = Mapping[str, Any]

LABEL, LINE, FOUND, REFUSED = "#333333", "#8a8a8a", "#1a8f3c", "#c62828"
_TAB = "1f77b4 ff7f0e 2ca02c d62728 9467bd 8c564b e377c2 7f7f7f bcbd22 17becf"
_DARK = "1b9e77 d95f02 7570b3 e7298a 66a61e e6ab02 a6761d 666666"
_PALE = "8dd3c7 ffffb3 bebada fb8072 80b1d3 fdb462 b3de69 fccde5 d9d9d9 bc80bd ccebc5 ffed6f"
CAUSE_COLORS: dict[Failure, Color] = dict(zip(Failure, map(to_rgb, f"{_TAB} {_DARK}".split()), strict=False))
"""Color of each cause of failure: the dark colors of Matplotlib's tab20, then Dark2."""
PLAN_COLORS: tuple[Color, ...] = tuple(map(to_rgb, _PALE.split()))
"""Colors of opened plans: Matplotlib's Set3."""


def cause_color(cause: Cause) -> Color:
    """Color of a cause of failure: gray for one that another version recorded."""
    return CAUSE_COLORS[cause] if isinstance(cause, Failure) else to_rgb(LINE)


@dataclass(frozen=True)
class Stub:
    """All failures of one action at one node.

    Attributes:
        node: Number of the node.
        action: Action that was tried.
        causes: Number of failures by cause.
        born: Number of log entries up to and including the first failure.
    """

    node: int
    action: str
    causes: Counter[Cause]
    born: int


class Layout:
    """The items of a search and their places.

    Attributes:
        nodes: Nodes of the record.
        steps: Log entries that are low-level steps.
        stubs: Stubs in the order of their first failures.
        solution: Numbers of the nodes on the path to the verified plan's end.
        labels: Short label of each action.
        plan_of: Opened plan with which the branch of each node began; the root has none.
        plans: Numbers of the opened plans.
        expanded: Number of nodes expanded for each opened plan since the previous one, by the plan's place in the log.
        levels: Row of each node, then of each stub; an item's column is its depth.
        born: Number of log entries after which each node exists.
        depth: Depth of the deepest item.
    """

    def __init__(self, tree: Record) -> None:
        self.nodes: list[Record] = tree["nodes"]
        self.steps: list[Record] = [entry for entry in tree["log"] if entry["event"] == "step"]
        self.stubs = _stubs(tree["log"])
        self.solution = _ancestors(self.nodes, tree["solution"])
        self.labels = abbreviations({step["action"] for step in self.steps})
        self.plan_of = _opened_plans(self.steps)
        self.expanded = _expansions(tree["log"])
        self.plans: list[int] = list(dict.fromkeys(tree["log"][number]["plan"] for number in self.expanded))
        parents = [node["parent"] for node in self.nodes] + [stub.node for stub in self.stubs]
        self.levels = rows(parents, len(self.nodes), self.solution)
        self.born = [0] + [number for number, entry in enumerate(tree["log"], 1) if entry.get("child") is not None]
        depths = [node["depth"] for node in self.nodes]
        self.depth = max(depths + [depths[stub.node] + 1 for stub in self.stubs])

    def color(self, plan: int | None) -> Color:
        """Color of an opened plan and of the nodes whose branch began with it; the root is white."""
        return (1.0, 1.0, 1.0) if plan is None else PLAN_COLORS[self.plans.index(plan) % len(PLAN_COLORS)]


def rows(parents: list[int | None], nodes: int, preferred: frozenset[int] = frozenset()) -> list[int]:
    """Return the row of each item of a tree. A parent is level with its first child, and no two branches cross.

    Args:
        parents: Parent of each item, which precedes the item; None for the root only. Nodes come first, then stubs.
        nodes: Number of items that are nodes.
        preferred: Nodes that come first among their siblings; the other siblings keep the order of the list.
    """
    children: defaultdict[int, list[int]] = defaultdict(list)
    depths: list[int] = []
    for item, parent in enumerate(parents):
        depths.append(0 if parent is None else depths[parent] + 1)
        if parent is not None:
            children[parent].append(item)
    offsets = [0] * len(parents)
    # Lowest row of each branch in each zone: items of depth d are in zone 2 d, their outgoing lines in zone 2 d + 1.
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
    """Sort siblings: first the item level with its parent, then the stubs, to keep them near, then the other nodes."""
    ordered = sorted(items, key=lambda item: (item not in preferred, item))
    return ordered[:1] + sorted(ordered[1:], key=lambda item: (item < nodes, item))


def abbreviations(actions: Iterable[str]) -> dict[str, str]:
    """Return a short label of each action. Names of objects end at their first underscore if they stay distinct."""
    parts = {action: action.rstrip(")").replace("(", ", ").split(", ") for action in actions}
    objects = {name for _, *names in parts.values() for name in names}
    heads = Counter(name.split("_")[0] for name in objects)
    short = {name: head if heads[head := name.split("_")[0]] == 1 else name for name in objects}
    return {
        action: " ".join([name, *(short[o] for o in names if o)]).strip() for action, (name, *names) in parts.items()
    }


def _stubs(log: list[Record]) -> list[Stub]:
    stubs: dict[tuple[int, str], Stub] = {}
    for number, entry in enumerate(log, 1):
        if (failure := entry.get("failure")) is not None:
            node, action = entry["node"], entry["action"]
            stub = stubs.setdefault((node, action), Stub(node, action, Counter(), number))
            stub.causes[Failure.__members__.get(failure, failure)] += 1
    return list(stubs.values())


def _expansions(log: list[Record]) -> dict[int, int]:
    """Add up the expansions of each plan, which may take several calls of the generator; only the last returns it."""
    found: dict[int, int] = {}
    total = 0
    for number, entry in enumerate(log):
        if entry["event"] == "opening":
            total += entry["expanded"]
            if entry["plan"] is not None:
                found[number], total = total, 0
    return found


def _ancestors(nodes: list[Record], node: int | None) -> frozenset[int]:
    found: set[int] = set()
    while node is not None:
        found.add(node)
        node = nodes[node]["parent"]
    return frozenset(found)


def _opened_plans(steps: list[Record]) -> dict[int, int]:
    """Return the opened plan with which the branch of each node began."""
    plans: dict[int, int] = {}
    for step in steps:
        if step["child"] is not None:
            plans[step["child"]] = step["plan"] if step["node"] == 0 else plans[step["node"]]
    return plans
