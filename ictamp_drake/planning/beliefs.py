"""Beliefs that a search learns about its own steps: their probability of success and their effort."""

from collections import defaultdict
from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import cache
from math import inf
from typing import Generic, NamedTuple

from ictamp_drake.core.checks import FINITE, POSITIVE, check_fields
from ictamp_drake.core.protocols import Estimator
from ictamp_drake.core.types import Action, C, Obstruction, Skeleton, State
from ictamp_drake.planning.credit import EdgeBelief, Lineage, Way
from ictamp_drake.planning.estimates import Estimates
from ictamp_drake.planning.obstructions import Obstructions, boxes_moved_by
from ictamp_drake.planning.tree import RunStep, Step, Tree


@dataclass(frozen=True)
class BeliefsConfig:
    """Constants of the Beta beliefs.

    Attributes:
        strength: Weight of the prior P, in attempts (`python benchmarks/beliefs.py`).
        floor: Lower bound of the prior, so that no step is ever given up.
        hope: P of an action before any action of the same name was estimated.
        effort: Effort of a step before any step of the same name succeeded [s].
        trying: Effort of trying one k [s]. The measured mean is 0.05 (`python benchmarks/effort.py`); another 0.03 is
            added so that instant rejections are not retried hundreds of times.
        simulating: Effort of one second of motion [s].
        patience: Expected number of failures at an unmoved box, before the action succeeds, at which the planner starts
            to ask for plans that move the box first. Infinite means that it never asks.
    """

    strength: float = 4.0
    floor: float = 0.1
    hope: float = 0.9
    effort: float = 0.5
    trying: float = 0.08
    simulating: float = 0.12
    patience: float = 1.5

    def __post_init__(self) -> None:
        share, finite = (POSITIVE, 1), (POSITIVE, FINITE)
        check_fields(self, "planners.adaptive.beliefs", floor=share, hope=share, patience=(POSITIVE, inf))
        check_fields(
            self, "planners.adaptive.beliefs", strength=finite, effort=finite, trying=finite, simulating=finite
        )


class Beliefs(Generic[C]):
    """Beta beliefs about each edge (s, a) from each node, with P as the prior and the attempts as evidence.

    Effort approximates computing time. It is counted, not measured: a search must not depend on the machine's speed.

    Once boxes are known to block a, its edges no longer differ by state, but by the set of these boxes that was moved.

    A node that is still to be reached gets its P from nearby nodes, or else the mean P of actions of the same name.
    """

    def __init__(self, config: BeliefsConfig, estimator: Estimator[C]) -> None:
        self._config = config
        self._estimates = Estimates(estimator)
        self._seen: set[tuple[int, Action]] = set()
        self._edges: defaultdict[_Edge, EdgeBelief] = defaultdict(lambda: EdgeBelief(config.strength))
        self._obstructions = Obstructions(config.patience)
        self._usual: defaultdict[str | Action, Mean] = defaultdict(Mean)
        self._efforts: defaultdict[tuple[str, bool], Mean] = defaultdict(Mean)

    def learn(self, tree: Tree[C], step: Step[C]) -> None:
        """Learn from an attempt; a failed one counts once for each k it tried.

        A success that finished a plan counts as a failure if the plan was then rejected as a whole. So does a success
        that can no longer lead to a better plan than the best one found. When physics refutes a step, its earlier
        success is withdrawn.
        """
        attempt, lineage = step.attempt, tree.lineage(step.node)
        action, obstacles = attempt.action, attempt.obstacles
        success = tree.counts_as_success(step)
        for edge in self._edges_at(tree, step.node, action):
            if step.refuted is not None:
                edge.withdraw_success(lineage)
            for _ in range(1 if success else attempt.tried):
                edge.learn(lineage, success)
            if not success:
                edge.blame({*action.args, *obstacles} if obstacles else ())
        self._obstructions.learn(tree.root.s, tree.way(step.node), attempt, success)
        effort = self._config.trying * attempt.tried + self._config.simulating * attempt.duration
        self._efforts[action.name, success].add(effort)

    def estimate_effort(self, tree: Tree[C], runs: Sequence[RunStep]) -> list[float]:
        """Expected effort of running each plan from its node until the plan is finished [s]."""
        ahead = cache(self._effort_ahead)
        efforts = []
        for run, P in zip(runs, self._see(tree, runs), strict=True):
            lineage, plan = tree.lineage(run.node), tree.plans[run.plan]
            here = tree.way(run.node)
            way = here + plan.actions
            ways = [way[:depth] for depth in range(len(here), len(way))]
            first, *later = map(self._edge, plan.states, plan.actions, ways)
            rest = (ahead(lineage, before, edge) for before, edge in zip(ways[1:], later, strict=True))
            efforts.append(sum(rest, self._effort_here(lineage, here, first, P)))
        return efforts

    def estimate_prior_effort(self, plan: Skeleton) -> float:
        """Expected effort of a plan as `estimate_effort` would give it before any attempt [s]."""
        return sum(self._effort(action, self._usual_success(action)) for action in plan.actions)

    def obstructions(self, actions: Iterable[Action]) -> frozenset[Obstruction]:
        """Boxes that should be moved before these actions."""
        return self._obstructions.list_before(actions)

    def _edge(self, state: State, action: Action, way: Way) -> "_Edge":
        """Edge of the action; once boxes are known to block it, the moved ones among them replace the state."""
        boxes = self._obstructions.boxes(action)
        return _Edge(None, action, boxes & boxes_moved_by(way)) if boxes else _Edge(state, action)

    def _edges_at(self, tree: Tree[C], node: int, action: Action) -> tuple[EdgeBelief, EdgeBelief]:
        """Both beliefs that an action from the node informs: by state, and by moved boxes in case some block it."""
        moved = self._obstructions.boxes(action) & boxes_moved_by(tree.way(node))
        return self._edges[_Edge(tree.nodes[node].s, action)], self._edges[_Edge(None, action, moved)]

    def _see(self, tree: Tree[C], runs: Sequence[RunStep]) -> list[float]:
        """P of each step. The first P of an action at a node also updates, once, the beliefs about other nodes."""
        estimates = [max(self._config.floor, P) for P in self._estimates.look_up(tree, runs)]
        for (node, plan, _), P in zip(runs, estimates, strict=True):
            action = tree.plans[plan].actions[0]
            if (node, action) not in self._seen:
                self._seen.add((node, action))
                for edge in self._edges_at(tree, node, action):
                    edge.see(tree.lineage(node), P)
                self._usual[action].add(P)
                self._usual[action.name].add(P)
        return estimates

    def _effort_here(self, lineage: Lineage, way: Way, edge: "_Edge", P: float) -> float:
        """Effort of an action from the last node of the lineage, whose P is known."""
        return self._effort(edge.action, self._edges[edge].success_at(lineage, way, P))

    def _effort_ahead(self, lineage: Lineage, way: Way, edge: "_Edge") -> float:
        """Effort of an action from the end of a way that extends the lineage."""
        usual = self._usual_success(edge.action)
        known = self._edges.get(edge)
        return self._effort(edge.action, known.success_ahead(lineage, way, usual) if known else usual)

    def _usual_success(self, action: Action) -> float:
        """Mean P of the action at other nodes, or else of actions of the same name."""
        return self._usual[action].value_or(self._usual[action.name].value_or(self._config.hope))

    def _effort(self, action: Action, belief: float) -> float:
        """Effort of repeating the action until it succeeds: 1 / belief - 1 failures on average, then one success."""
        success = self._efforts[action.name, True].value_or(self._config.effort)
        failure = self._efforts[action.name, False].value_or(success)
        return success + (1 / belief - 1) * failure


class _Edge(NamedTuple):
    """Edge (s, a) of the high-level graph; or, without a state, a where the blocking boxes `moved` have been moved."""

    state: State | None
    action: Action
    moved: frozenset[str] = frozenset()


@dataclass
class Mean:
    """Running mean of values."""

    total: float = 0.0
    count: int = 0

    def add(self, value: float) -> None:
        self.total += value
        self.count += 1

    def value_or(self, value: float) -> float:
        """The mean, or `value` when nothing was added."""
        return self.total / self.count if self.count else value
