"""The completion tree as plain data: everything found and everything tried, in order.

Paper, Search Tree Formulation: a node is n_i = (c_i, s_i, P_i, cnt_i). Plans are numbered in order of appearance and
stored once, so one dictionary from plan number to count represents P_i and cnt_i. The tree decides nothing: selection
rules read it, the planner writes it.
"""

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from typing import Any, Generic, NamedTuple

from ictamp_drake.core.types import Action, Attempt, C, Parameter, Skeleton, State

ROOT = 0
"""Number of the root node n_0."""


@dataclass
class Node(Generic[C]):
    """n_i = (c_i, s_i, P_i, cnt_i).

    Attributes:
        index: Number of the node in order of creation; 0 is the root.
        c: Configuration.
        s: Symbolic state H(c).
        parent: Number of the node from which c was reached; None at the root.
        attempt: Run of the skill that led here; None at the root.
        depth: Number of skills run since the root.
        cnt: Number of attempts that this node made at each plan it holds, by plan number. The keys are P_i; a node at
            the goal holds the empty plan.
    """

    index: int
    c: C
    s: State
    parent: int | None = None
    attempt: Attempt[C] | None = None
    depth: int = 0
    cnt: dict[int, int] = field(default_factory=dict)


@dataclass(frozen=True)
class Opening:
    """One call of the plan generator (Algorithm 3).

    Attributes:
        plan: Number of the new plan, or None when the call ended without one.
        expanded: Number of nodes that the generator expanded in this call.
        seconds: Computing time of the call [s].
    """

    plan: int | None
    expanded: int
    seconds: float = 0.0


@dataclass(frozen=True)
class Step(Generic[C]):
    """One low-level step: a node attempted the first action of a plan.

    Attributes:
        node: Number of the node.
        plan: Number of the plan.
        attempt: Run of the skill.
        child: Number of the node that the attempt reached, or None when it failed.
        refuted: Number of the node that an earlier attempt had promised, when this one is its failure in physics.
    """

    node: int
    plan: int
    attempt: Attempt[C]
    child: int | None
    refuted: int | None = None


class RunStep(NamedTuple):
    """Attempt the first action of a plan from a node that holds it.

    Attributes:
        node: Number of the node in the tree.
        plan: Number of the plan in the tree.
        k: Parameter of the attempt, or None to draw one.
    """

    node: int
    plan: int
    k: Parameter | None = None


class Tree(Generic[C]):
    """The tree of one search.

    Attributes:
        nodes: Nodes in order of creation.
        plans: Every known plan, opened ones and suffixes, in order of appearance.
        holders: Numbers of the nodes that hold each plan.
        log: Openings and steps in chronological order.
        candidates: Nodes at which a plan was finished, each with whether the whole plan was verified; None for a plan
            that is no better than one before.
        refuted: Nodes that physics did not reach, and all nodes below them; `holders` no longer lists them.
        exhausted: True when there are no further plans.
    """

    def __init__(self, c: C, s: State) -> None:
        self.nodes: list[Node[C]] = [Node(ROOT, c, s)]
        self.plans: list[Skeleton] = []
        self.holders: list[list[int]] = []
        self.log: list[Opening | Step[C]] = []
        self.candidates: dict[int, bool | None] = {}
        self.refuted: set[int] = set()
        self.exhausted = False
        self._best: tuple[int, float] | None = None
        self._numbers: dict[Skeleton, int] = {}
        self._lineages: list[tuple[int, ...]] = [(ROOT,)]
        self._ways: list[tuple[Action, ...]] = [()]

    @property
    def root(self) -> Node[C]:
        return self.nodes[ROOT]

    @property
    def openings(self) -> list[Opening]:
        return [entry for entry in self.log if isinstance(entry, Opening)]

    @property
    def steps(self) -> list[Step[C]]:
        return [entry for entry in self.log if isinstance(entry, Step)]

    @property
    def opened(self) -> list[int]:
        """Numbers of the plans given to the root, in order."""
        return [opening.plan for opening in self.openings if opening.plan is not None]

    @property
    def open_plans(self) -> list[int]:
        """Numbers of the plans that have a first action to attempt and a node to attempt it from."""
        return [number for number, plan in enumerate(self.plans) if plan.actions and self.holders[number]]

    @property
    def runs(self) -> list[RunStep]:
        """Every node with every plan that it could attempt, in order of plans."""
        return [RunStep(node, plan) for plan in self.open_plans for node in self.holders[plan]]

    @property
    def reached(self) -> RunStep | None:
        """Rest of a plan from the node that the last log entry reached, or None when nothing is left to run."""
        last = self.log[-1] if self.log else None
        if not isinstance(last, Step) or last.child is None or self.is_finished(self.nodes[last.child]):
            return None
        (rest,) = self.nodes[last.child].cnt
        return RunStep(last.child, rest) if last.child in self.holders[rest] else None

    @property
    def solution(self) -> int | None:
        """Number of the latest node whose plan was verified, which is the best one."""
        return next((node for node, verified in reversed(self.candidates.items()) if verified), None)

    def is_finished(self, node: Node[C]) -> bool:
        """Whether the node holds an empty plan, that is, whether a plan was carried out up to this node."""
        return any(not self.plans[plan].actions for plan in node.cnt)

    def record_opening(
        self, plan: Skeleton | None, expanded: int, seconds: float = 0.0, *, graft: bool = False
    ) -> Opening:
        """Give the root a new plan, or record that a call of the generator brought none.

        Args:
            plan: New plan, or None.
            expanded: Number of nodes that the generator expanded in the call.
            seconds: Computing time of the call [s].
            graft: Give every node that the plan's first actions have already reached the rest of the plan.

        Raises:
            ValueError: The plan does not start in the root's state.
        """
        if plan is not None and plan.states[0] != self.root.s:
            raise ValueError("a high-level plan must start in the symbolic state of the root")
        opening = Opening(None if plan is None else self._hold(self.root, plan), expanded, seconds)
        if plan is not None and graft:
            self._graft(plan)
        self.log.append(opening)
        return opening

    def record_step(self, node: int, plan: int, attempt: Attempt[C]) -> Step[C]:
        """Count an attempt of `node` at `plan`; a success adds a node that holds the rest of the plan with count 0.

        Raises:
            ValueError: The attempt succeeded but has no successor.
        """
        child = self._add_child(self.nodes[node], plan, attempt) if attempt.succeeded else None
        step = Step(node, plan, attempt, child)
        self._count(step)
        return step

    def confirm(self, node: int, attempt: Attempt[C]) -> None:
        """Replace the promised attempt that led to a node by the attempt executed in physics.

        Raises:
            ValueError: The attempt did not succeed.
        """
        if attempt.successor is None or not attempt.succeeded:
            raise ValueError(f"{attempt.action} was not confirmed by physics")
        self.nodes[node].c, self.nodes[node].attempt = attempt.successor, attempt
        place, step = self._step_to(node)
        self.log[place] = replace(step, attempt=attempt)

    def refute(self, node: int, attempt: Attempt[C]) -> Step[C]:
        """Count a failure in physics of the attempt that led to a node; drop the node and all nodes below it."""
        for each in self.nodes:
            if node in self.lineage(each.index) and each.index not in self.refuted:
                self.refuted.add(each.index)
                for plan in each.cnt:
                    if each.index in self.holders[plan]:
                        self.holders[plan].remove(each.index)
        _, led = self._step_to(node)
        step = Step(led.node, led.plan, attempt, None, node)
        self._count(step)
        return step

    def keep_better(self, node: int) -> None:
        """Drop the plans that can no longer be better than the one that ends in this node.

        A better plan has fewer skills or, with as many, a shorter execution.
        """
        self._best = self._measure(self.nodes[node])
        for plan, holders in zip(self.plans, self.holders, strict=True):
            holders[:] = [holder for holder in holders if self.can_be_best(self.nodes[holder], plan)]

    def can_be_best(self, node: Node[C], plan: Skeleton | None = None) -> bool:
        """Whether the way to the node, continued by `plan`, can be better than the best plan so far."""
        if self._best is None:
            return True
        skills, duration = self._measure(node)
        return (skills + len(plan.actions if plan else ()), duration) < self._best

    def counts_as_success(self, step: Step[C]) -> bool:
        """Whether a step succeeded and its child can still lead to a plan that is neither rejected nor too long."""
        if step.child is None:
            return False
        child = self.nodes[step.child]
        if self.is_finished(child):
            return bool(self.candidates.get(child.index, True))
        return any(self.can_be_best(child, self.plans[plan]) for plan in child.cnt)

    def _measure(self, node: Node[C]) -> tuple[int, float]:
        """Number of skills that lead to the node, and the duration of their motions [s]."""
        return node.depth, sum(attempt.duration for attempt in self.path(node.index))

    def _step_to(self, node: int) -> tuple[int, Step[C]]:
        """Index in the log of the step that led to the node, and the step."""
        return next(
            (place, entry) for place, entry in enumerate(self.log) if isinstance(entry, Step) and entry.child == node
        )

    def lineage(self, node: int) -> tuple[int, ...]:
        """Numbers of the nodes from the root to this one, both included."""
        return self._lineages[node]

    def path(self, node: int) -> tuple[Attempt[C], ...]:
        """Attempts that lead from the root to the node; empty for the root."""
        attempts = [self.nodes[number].attempt for number in self.lineage(node)]
        return tuple(attempt for attempt in attempts if attempt is not None)

    def way(self, node: int) -> tuple[Action, ...]:
        """Actions that lead from the root to the node; empty for the root."""
        return self._ways[node]

    def summary(self) -> dict[str, int]:
        """Summarize the search in the figures that every comparison needs."""
        steps = self.steps
        return {
            "nodes": len(self.nodes),
            "depth": max(node.depth for node in self.nodes),
            "high_level_plans": sum(opening.plan is not None for opening in self.openings),
            "high_level_calls": len(self.log) - len(steps),
            "high_level_expansions": sum(opening.expanded for opening in self.openings),
            "low_level_steps": len(steps),
            "low_level_failures": sum(step.child is None for step in steps),
            "candidates": len(self.candidates),
        }

    def to_dict(self, encode: Callable[[C], Any] | None = None) -> dict[str, Any]:
        """Convert the tree to JSON types. It contains no times, so the same search gives the same text.

        Args:
            encode: Function that converts a configuration to JSON types; without it, configurations are left out.
        """
        return {
            "summary": self.summary(),
            "exhausted": self.exhausted,
            "solution": self.solution,
            "candidates": [{"node": node, "verified": verified} for node, verified in self.candidates.items()],
            "plans": [[str(action) for action in plan.actions] for plan in self.plans],
            "nodes": [_node_to_dict(node, encode) for node in self.nodes],
            "log": [_entry_to_dict(entry) for entry in self.log],
        }

    def _count(self, step: Step[C]) -> None:
        self.nodes[step.node].cnt[step.plan] += 1
        self.log.append(step)

    def _hold(self, node: Node[C], plan: Skeleton) -> int:
        number = self._numbers.setdefault(plan, len(self.plans))
        if number == len(self.plans):
            self.plans.append(plan)
            self.holders.append([])
        if number not in node.cnt:
            node.cnt[number] = 0
            if self.can_be_best(node, plan):
                self.holders[number].append(node.index)
        return number

    def _graft(self, plan: Skeleton) -> None:
        rests: dict[int | None, Skeleton] = {ROOT: plan}
        for node in self.nodes:
            if node.index in self.refuted:
                continue
            before = rests.get(node.parent)
            if before and node.attempt and (node.attempt.action, node.s) == (before.actions[0], before.states[1]):
                rests[node.index] = before.suffix(1)
                self._hold(node, rests[node.index])

    def _add_child(self, parent: Node[C], plan: int, attempt: Attempt[C]) -> int:
        if attempt.successor is None:
            raise ValueError(f"{attempt.action} succeeded without a successor")
        rest = self.plans[plan].suffix(1)
        child = Node(len(self.nodes), attempt.successor, rest.states[0], parent.index, attempt, parent.depth + 1)
        self.nodes.append(child)
        self._lineages.append((*self._lineages[parent.index], child.index))
        self._ways.append((*self._ways[parent.index], attempt.action))
        self._hold(child, rest)
        return child.index


def _node_to_dict(node: Node[C], encode: Callable[[C], Any] | None) -> dict[str, Any]:
    return {
        "index": node.index,
        "parent": node.parent,
        "depth": node.depth,
        "action": None if node.attempt is None else str(node.attempt.action),
        "state": sorted(str(atom) for atom in node.s),
        "plans": list(node.cnt),
        "cnt": list(node.cnt.values()),
    } | ({} if encode is None else {"c": encode(node.c)})


def _entry_to_dict(entry: Opening | Step[C]) -> dict[str, Any]:
    if isinstance(entry, Opening):
        return {"event": "opening", "plan": entry.plan, "expanded": entry.expanded}
    attempt = entry.attempt
    return {
        "event": "step",
        "node": entry.node,
        "plan": entry.plan,
        "action": str(attempt.action),
        "k": None if attempt.k is None else attempt.k.tolist(),
        "failure": None if attempt.failure is None else attempt.failure.name,
        "rejections": [failure.name for failure in attempt.rejections],
        "child": entry.child,
    }
