"""The equations of docs/adaptive.md, implemented a second time, hold in whole searches.

The expected values do not use the implementation: `Equations` keeps every attempt and sums up anew for each belief.
Names are those of the page.
"""

import json
from collections import Counter, defaultdict
from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.protocols import Estimator, RuleContext
from ictamp_drake.core.types import Action, Attempt, Obstruction, Skeleton
from ictamp_drake.planning.adaptive import Adaptive, AdaptiveConfig
from ictamp_drake.planning.beliefs import Beliefs
from ictamp_drake.planning.rule import OpenPlan, Option
from ictamp_drake.planning.tree import Opening, RunStep, Step, Tree
from tests.planning.test_adaptive import LOT, TINY, ParkingLot, search_parking_lot
from tests.planning.test_golden_trees import CASES, GOLDEN
from tests.toy_world import ADAPTIVE, RIGHT, UP, TableEstimator, ToyConfiguration, ToyWorld, toy_planner

Lineage = tuple[int, ...]
Way = tuple[Action, ...]
Key = tuple[object, Action]

CLOSE = 1e-9


@dataclass
class Edge:
    """Observations at an edge, attempt by attempt and node by node."""

    attempts: list[tuple[Lineage, int, int]] = field(default_factory=list)
    estimates: list[tuple[Lineage, float]] = field(default_factory=list)
    votes: Counter[frozenset[str]] = field(default_factory=Counter)
    R: int = 0


@dataclass
class Calls:
    """Calls of the generator that asked for the same boxes to move."""

    expanded: list[int] = field(default_factory=list)
    in_vain: int = 0
    brought: bool = True


class Equations:
    """Sections 1 to 6 of the page."""

    def __init__(self, config: AdaptiveConfig, estimator: Estimator[Any]) -> None:
        self.config, self.constants, self.estimator = config, config.beliefs, estimator
        self.edges: dict[Key, Edge] = {}
        self.P: dict[RunStep, float] = {}
        self.first_P: dict[tuple[int, Action], float] = {}
        self.efforts: defaultdict[tuple[str, bool], list[float]] = defaultdict(list)
        self.F: defaultdict[Action, Counter[str]] = defaultdict(Counter)
        self.successes: defaultdict[Action, list[frozenset[str]]] = defaultdict(list)
        self.D: dict[Action, frozenset[str]] = {}
        self.calls: defaultdict[frozenset[Obstruction], Calls] = defaultdict(Calls)
        self.Q: frozenset[Obstruction] = frozenset()
        self.read = 0
        self.runs: Sequence[RunStep] = ()

    # 1. Effort

    def effort(self, a: Action, q: float) -> float:
        successes, failures = self.efforts[a.name, True], self.efforts[a.name, False]
        success = float(np.mean(successes)) if successes else self.constants.effort
        failure = float(np.mean(failures)) if failures else success
        return success + (1 / q - 1) * failure

    def efforts_of(self, tree: Tree[Any]) -> list[float]:
        """ε(n, p) of every node with every plan."""
        self.ask(tree)
        known: dict[tuple[Lineage, Way, Key], float] = {}
        return [self.effort_of(tree, run, known) for run in tree.runs]

    def effort_of(self, tree: Tree[Any], run: RunStep, known: dict[tuple[Lineage, Way, Key], float]) -> float:
        p, lineage, way = tree.plans[run.plan], tree.lineage(run.node), tree.way(run.node)
        total = self.effort(p.actions[0], self.belief_here(self.key(p, 0, way), lineage, way, self.P[run]))
        for i in range(1, len(p)):
            ahead = way + p.actions[:i]
            asked = lineage, ahead, self.key(p, i, ahead)
            if asked not in known:
                known[asked] = self.effort(p.actions[i], self.belief_ahead(asked[2], lineage, ahead))
            total += known[asked]
        return total

    # 2. Evidence

    def learn(self, tree: Tree[Any], step: Step[Any]) -> None:
        attempt, lineage, way = step.attempt, tree.lineage(step.node), tree.way(step.node)
        a, t = attempt.action, attempt.tried
        success = step.child is not None and tree.candidates.get(step.child, True)
        for key in self.both_keys(tree, step.node, a):
            edge = self.edges.setdefault(key, Edge())
            edge.R = max(edge.R, len(way))
            if step.refuted is not None:
                edge.attempts.append((lineage, -1, -1))
            edge.attempts.append((lineage, 1, 1) if success else (lineage, t, 0))
            if not success:
                edge.votes[frozenset({*a.args, *attempt.obstacles} if attempt.obstacles else ())] += 1
        self.learn_what_is_in_the_way(tree, way, attempt, success)
        self.efforts[a.name, success].append(self.constants.trying * t + self.constants.simulating * attempt.duration)

    def ask(self, tree: Tree[Any]) -> None:
        """P of every step; the first value for a node and an action is cached."""
        for run in tree.runs:
            if run not in self.P:
                value = self.estimator.estimate([(tree.nodes[run.node].c, tree.plans[run.plan])])[0]
                self.P[run] = max(self.constants.floor, float(value))
        for run in tree.runs:
            a = tree.plans[run.plan].actions[0]
            if (run.node, a) not in self.first_P:
                self.first_P[run.node, a] = self.P[run]
                for key in self.both_keys(tree, run.node, a):
                    self.edges.setdefault(key, Edge()).estimates.append((tree.lineage(run.node), self.P[run]))

    def usual(self, a: Action) -> float:
        for same in (lambda other: other == a, lambda other: other.name == a.name):
            values = [P for (_, other), P in self.first_P.items() if same(other)]
            if values:
                return float(np.mean(values))
        return self.constants.hope

    # 3. The belief about an edge

    def belief_here(self, key: Key, lineage: Lineage, way: Way, P: float) -> float:
        edge = self.edges[key]
        edge.R = max(edge.R, len(way))
        groups = [lineage[min(r, len(way))] for r in range(edge.R + 1)]
        return self.mixture(edge, groups, way, P)

    def belief_ahead(self, key: Key, lineage: Lineage, way: Way) -> float:
        a, edge = key[1], self.edges.get(key)
        if edge is None:
            return self.usual(a)
        edge.R = max(edge.R, len(way))
        P = self.usual(a)
        for n in lineage:
            below = [value for other, value in edge.estimates if n in other]
            P = (P + sum(below)) / (1 + len(below))
        groups = [lineage[r] if r < len(lineage) else None for r in range(edge.R + 1)]
        return self.mixture(edge, groups, way, P)

    def mixture(self, edge: Edge, groups: Sequence[int | None], way: Way, P: float) -> float:
        q = np.zeros(edge.R + 1)
        for r, own in enumerate(groups):
            N, S = _evidence(edge.attempts, own)
            A, B = self.all_groups(edge, r) - self.shrink(N, S)
            mu = (self.constants.strength * P + B) / (self.constants.strength + A)
            q[r] = (self.constants.strength * mu + S) / (self.constants.strength + N)
        return float(self.shares(edge, way) @ q)

    def all_groups(self, edge: Edge, r: int) -> np.ndarray:
        """A and B: changes of each attempt, in turn, to the share of its own group."""
        total = np.zeros(2)
        for number, (lineage, _, _) in enumerate(edge.attempts):
            g = lineage[min(r, len(lineage) - 1)]
            after, before = (_evidence(edge.attempts[:count], g) for count in (number + 1, number))
            total += self.shrink(*after) - self.shrink(*before)
        return total

    def shrink(self, N: int, S: int) -> np.ndarray:
        return self.constants.strength / (self.constants.strength + N) * np.array([N, S])

    # 4. Which earlier step is to blame

    def shares(self, edge: Edge, way: Way) -> np.ndarray:
        h = np.full(edge.R + 1, (1 + edge.votes[frozenset()]) / (edge.R + 1))
        for objects, v in edge.votes.items():
            if objects:
                suspects = sorted(_suspects(way, objects))
                h[suspects] += v / len(suspects)
        return h / h.sum()

    # 5. Boxes in the way

    def learn_what_is_in_the_way(self, tree: Tree[Any], way: Way, attempt: Attempt[Any], success: bool) -> None:
        a, moved = attempt.action, _moved(way)
        movable = {atom.args[0] for atom in tree.root.s if atom.args}
        for b in attempt.obstacles:
            if b in movable - moved - set(a.args):
                self.F[a][b] += 1 / attempt.tried  # type: ignore[assignment]  (a share)
        if success:
            self.successes[a].append(moved)
        Z = {b: sum(b not in before for before in self.successes[a]) for b in self.F[a]}
        self.D[a] = frozenset(b for b, F in self.F[a].items() if F / (1 + Z[b]) >= self.constants.patience - CLOSE)

    def key(self, p: Skeleton, i: int, way: Way) -> Key:
        D = self.D.get(p.actions[i], frozenset())
        return (("moved", D & _moved(way)) if D else p.states[i]), p.actions[i]

    def both_keys(self, tree: Tree[Any], node: int, a: Action) -> tuple[Key, Key]:
        D = self.D.get(a, frozenset())
        return (tree.nodes[node].s, a), (("moved", D & _moved(tree.way(node))), a)

    # 6. The choice

    def check(self, tree: Tree[Any], option: Option, computed: Sequence[float] | None) -> None:
        """Assert that the option agrees with the equations, and that the efforts are the computed ones."""
        if not tree.runs:
            assert option == OpenPlan()
            return
        news, self.read = tree.log[self.read :], len(tree.log)
        for entry in news:
            if isinstance(entry, Step):
                self.learn(tree, entry)
        efforts = self.efforts_of(tree)
        assert computed == pytest.approx(efforts, rel=CLOSE)
        assert computed is not None
        run = tree.runs[int(np.argmin(computed))]  # rounding decides between equal ones
        for entry in news:
            if isinstance(entry, Opening):
                calls = self.calls[self.Q]
                calls.expanded.append(entry.expanded)
                calls.in_vain = calls.in_vain + 1 if run in self.runs else 0
                calls.brought = entry.plan is not None
        self.runs = tree.runs
        actions = (*tree.way(run.node), *tree.plans[run.plan].actions)
        self.Q = frozenset(Obstruction(a, b) for a in actions for b in self.D.get(a, ()))
        assert option == (OpenPlan(self.Q) if self.opening_pays(tree, min(efforts)) else run)

    def opening_pays(self, tree: Tree[Any], least: float) -> bool:
        calls = self.calls[self.Q]
        if tree.exhausted and not (self.Q and calls.brought):
            return False
        hoped = sum(self.effort(a, self.usual(a)) for a in tree.plans[tree.opened[-1]].actions)
        L = float(np.mean(calls.expanded)) if calls.expanded else 0.0
        cost, W = self.config.opening + self.config.expanding * L, (least - hoped) / (2 + calls.in_vain)
        assert abs(cost - W) > CLOSE, "too close to call"
        return cost < W


def _evidence(attempts: Sequence[tuple[Lineage, int, int]], group: int | None) -> tuple[int, int]:
    """N and S of a node."""
    found = [(weight, successes) for lineage, weight, successes in attempts if group in lineage]
    return sum(weight for weight, _ in found), sum(successes for _, successes in found)


def _suspects(way: Way, objects: frozenset[str]) -> set[int]:
    sought, moved, suspects = set(objects), set(), {0}
    for j in range(len(way), 0, -1):
        b = way[j - 1].args[0] if way[j - 1].args else None
        if b in sought - moved:
            moved.add(b)
            sought |= set(way[j - 1].args)
            suspects.add(j)
    return suspects


def _moved(way: Way) -> frozenset[str]:
    return frozenset(a.args[0] for a in way if a.args)


class HeardBeliefs(Beliefs[Any]):
    """The implementation, with the efforts that it computed last."""

    heard: list[float] | None = None

    def estimate_effort(self, tree: Tree[Any], runs: Sequence[RunStep]) -> list[float]:
        self.heard = super().estimate_effort(tree, runs)
        return self.heard


class Checked:
    """Adaptive allocation that compares every choice with the equations; its own configuration."""

    def __init__(self, config: AdaptiveConfig) -> None:
        self.config = config
        self.chosen: list[Option] = []

    def create(self, context: RuleContext[Any], /) -> "Checked":
        self.beliefs = HeardBeliefs(self.config.beliefs, context.estimator)
        self.rule, self.equations = Adaptive(self.config, self.beliefs), Equations(self.config, context.estimator)
        return self

    def choose(self, tree: Tree[Any], rng: np.random.Generator) -> Option:
        option = self.rule.choose(tree, rng)
        self.equations.check(tree, option, self.beliefs.heard)
        self.chosen.append(option)
        return option


@pytest.mark.parametrize("name", ["adaptive", "adaptive_door"])
def test_the_equations_choose_every_step_of_the_golden_searches(name: str) -> None:
    world, rule = CASES[name]
    golden = json.loads((GOLDEN / f"{name}.json").read_text(encoding="utf-8"))["tree"]
    assert isinstance(rule, AdaptiveConfig)
    checked = Checked(rule)
    tree = toy_planner(world, seed=5, steps=80, rule=checked).run().tree
    assert [(entry["event"], entry.get("node"), entry["plan"]) for entry in golden["log"]] == [
        ("opening", None, entry.plan) if isinstance(entry, Opening) else ("step", entry.node, entry.plan)
        for entry in tree.log
    ]
    assert len(checked.chosen) == len(golden["log"])


def refuse_two() -> Callable[[object], bool]:
    """Verifier of whole plans that refuses the first two."""
    verdicts = iter((False, False))
    return lambda _: next(verdicts, True)


def slip_twice() -> Callable[..., Attempt[ToyConfiguration]]:
    """Physics that refuses the third and the sixth promised step."""
    steps = iter(range(10**6))

    def execute(c: ToyConfiguration, attempt: Attempt[ToyConfiguration], _: object) -> Attempt[ToyConfiguration]:
        return replace(attempt, failure=Failure.SLIPPED, successor=c) if next(steps) in (2, 5) else attempt

    return execute


@pytest.mark.parametrize("seed", range(3))
@pytest.mark.parametrize(
    ("world", "more"),
    [
        (ToyWorld(size=(3, 2), success=0.5, walls=((1, 1),)), dict),
        (
            ToyWorld(size=(3, 1), success=0.8, doors={(3, 1): 0.3}),
            lambda: {"estimator": TableEstimator({RIGHT: 0.8, UP: 0.05})},
        ),
        (ToyWorld(size=(2, 1), success=0.8), lambda: {"verify": refuse_two()}),
        (ToyWorld(size=(2, 1), success=0.8), lambda: {"execute": slip_twice()}),
    ],
    ids=["walls", "unequal P", "plans refused as a whole", "steps refused by physics"],
)
def test_they_choose_every_step_in_other_toy_worlds(
    world: ToyWorld, more: Callable[[], dict[str, Any]], seed: int
) -> None:
    checked = Checked(ADAPTIVE)
    toy_planner(world, rule=checked, seed=seed, steps=60, **more()).run()
    assert len(checked.chosen) > 4


@pytest.mark.parametrize("lot", [LOT, TINY, replace(TINY, in_the_way={"low": "tall", "tall": "low"})])
@pytest.mark.parametrize("patience", [1.5, 20.0])
def test_they_choose_every_step_where_boxes_are_in_the_way(lot: ParkingLot, patience: float) -> None:
    """Failures name obstacles here, and the search asks for plans that move them first."""
    beliefs = replace(ADAPTIVE.beliefs, patience=patience)
    checked = Checked(replace(ADAPTIVE, beliefs=beliefs))
    search_parking_lot(lot=lot, rule=checked, steps=60)
    asked = {option.obstructions for option in checked.chosen if isinstance(option, OpenPlan)}
    assert any(asked)
