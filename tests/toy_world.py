"""A world without Drake in which the whole search runs in milliseconds.

A robot walks on a grid from (0, 0) to the far corner with the actions right and up. A configuration is the cell and an
offset inside it: the parameter k that the last step happened to draw. Cells may be walled off, and steps may slip. A
cell with a narrow door can be entered only from a small enough offset in the previous cell. The only remedy then is to
go back and enter the previous cell again with another k.
"""

from collections import deque
from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import asdict, dataclass, field
from itertools import accumulate, combinations, islice
from typing import Any, NamedTuple

import numpy as np

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.protocols import Estimator, PlanParameters
from ictamp_drake.core.types import Action, Atom, Attempt, FloatArray, Obstruction, Parameter, Skeleton, State
from ictamp_drake.estimators.constant import Constant
from ictamp_drake.planning.adaptive import AdaptiveConfig
from ictamp_drake.planning.beliefs import BeliefsConfig
from ictamp_drake.planning.events import Listener
from ictamp_drake.planning.planner import Budget, Execute, Planner, PlannerConfig
from ictamp_drake.planning.proportional import ProportionalConfig
from ictamp_drake.planning.rule import RuleConfig
from ictamp_drake.planning.tree import Tree

Cell = tuple[int, int]
RIGHT, UP = Action("right", ()), Action("up", ())
MOVES = {RIGHT: (1, 0), UP: (0, 1)}
ADAPTIVE = AdaptiveConfig(BeliefsConfig(trying=0.5))
"""Adaptive allocation where nothing moves, so that all effort of a step belongs to its k."""


class ToyConfiguration(NamedTuple):
    """c: the cell, and the offset in [0, 1] that was drawn on entering it."""

    cell: Cell
    offset: float


def abstraction(c: ToyConfiguration) -> State:
    """H: the cell."""
    return frozenset({Atom("at", (str(c.cell[0]), str(c.cell[1])))})


@dataclass(frozen=True)
class ToyWorld:
    """The grid and its hazards.

    Attributes:
        size: Far corner of the grid, which is the goal.
        success: Probability that a step does not slip.
        walls: Cells that cannot be entered.
        doors: Cells that can be entered only from an offset below the door's width.
        offsets: Parameters k that a step can draw; empty for uniform in [0, 1).
        max_plans: Number of plans that the generator knows, in lexicographic order; None for all.
        expansions: Number of nodes that the generator expands for each plan.
        seconds: Simulated computing time of a step [s].
    """

    size: Cell = (1, 1)
    success: float = 1.0
    walls: tuple[Cell, ...] = ()
    doors: Mapping[Cell, float] = field(default_factory=dict)
    offsets: tuple[float, ...] = ()
    max_plans: int | None = None
    expansions: int = 10
    seconds: float = 0.5

    @property
    def draws(self) -> int:
        return 3  # all are refused at a wall

    @property
    def start(self) -> ToyConfiguration:
        return ToyConfiguration((0, 0), 0.5)

    def to_dict(self) -> dict[str, Any]:
        """The world in the types of JSON."""
        return asdict(self) | {"doors": [[*cell, width] for cell, width in self.doors.items()]}

    def plans(self) -> Iterator[Skeleton]:
        """All monotone paths from the start to the goal, in lexicographic order."""
        length = sum(self.size)
        for rights in islice(combinations(range(length), self.size[0]), self.max_plans):
            actions = tuple(RIGHT if step in rights else UP for step in range(length))
            cells = [(0, 0)]
            for action in actions:
                cells.append(_move(cells[-1], action))
            yield Skeleton(tuple(abstraction(ToyConfiguration(cell, 0.0)) for cell in cells), actions)

    def attempt(
        self,
        c: ToyConfiguration,
        plan: Skeleton,
        rng: np.random.Generator,
        k: Parameter | None = None,
    ) -> Attempt[ToyConfiguration]:
        """Run one step from c; draws exactly two random numbers."""
        action, promised = plan.actions[0], plan.states[1]
        offset, luck = (float(value) for value in rng.random(2))
        if k is not None:
            offset = float(k[0])
        elif self.offsets:
            offset = self.offsets[int(offset * len(self.offsets))]
        cell = _move(c.cell, action)
        seconds = {"physics": self.seconds}
        if cell in self.walls:
            return Attempt(action, Failure.NO_PATH, rejections=(Failure.NO_INVERSE_KINEMATICS,) * 2, seconds=seconds)
        if c.offset >= self.doors.get(cell, 1.0):
            return Attempt(action, Failure.GOAL_IN_COLLISION, k=np.array([offset]), seconds=seconds)
        if luck >= self.success:
            return Attempt(action, Failure.SLIPPED, successor=c, k=np.array([offset]), seconds=seconds)
        successor = ToyConfiguration(cell, offset)
        assert abstraction(successor) == promised
        return Attempt(action, None, successor, np.array([offset]), seconds=seconds)


def _move(cell: Cell, action: Action) -> Cell:
    return cell[0] + MOVES[action][0], cell[1] + MOVES[action][1]


class ToyGenerator:
    """Generates the plans of a world one after the other, each after a fixed number of expansions."""

    def __init__(self, world: ToyWorld) -> None:
        self._plans = deque(world.plans())
        self._cost = world.expansions
        self._paid = 0
        self.expanded = 0

    @property
    def exhausted(self) -> bool:
        return not self._plans

    def next_plan(
        self,
        max_expansions: int,
        obstructions: frozenset[Obstruction] = frozenset(),  # noqa: ARG002  (nothing can be moved)
    ) -> Skeleton | None:
        """Return the next plan once its expansions are paid for, if necessary in several calls."""
        if self.exhausted:
            return None
        paid = min(max_expansions, self._cost - self._paid)
        self.expanded += paid
        self._paid += paid
        if self._paid < self._cost:
            return None
        self._paid = 0
        return self._plans.popleft()


@dataclass
class TableEstimator:
    """P by first action, with a record of the queries."""

    P: Mapping[Action, float]
    asked: list[list[tuple[ToyConfiguration, Skeleton]]] = field(default_factory=list)

    def estimate(self, options: Sequence[tuple[ToyConfiguration, Skeleton]]) -> FloatArray:
        self.asked.append(list(options))
        return np.array([self.P[plan.actions[0]] for _, plan in options])


@dataclass
class ToyOptimizer:
    """An optimizer that knows the widths of the doors, but neither walls nor luck, and prefers later plans."""

    world: ToyWorld
    asked: list[int] = field(default_factory=list)

    def estimate(self, options: Sequence[tuple[ToyConfiguration, Skeleton]]) -> FloatArray:
        return np.ones(len(options))

    def optimize(
        self, options: Sequence[tuple[ToyConfiguration, Skeleton]], rng: np.random.Generator
    ) -> list[PlanParameters]:
        self.asked.append(len(options))
        return [
            PlanParameters(value, np.array([[offset] for offset in self._offsets(plan)]) * rng.random())
            for value, (_, plan) in enumerate(options)
        ]

    def _offsets(self, plan: Skeleton) -> list[float]:
        """Largest offset that passes the next cell's door, for each entered cell."""
        cells = list(accumulate((MOVES[action] for action in plan.actions), lambda a, b: (a[0] + b[0], a[1] + b[1])))
        return [self.world.doors.get(cell, 1.0) for cell in [*cells[1:], cells[-1]]]


@dataclass
class TickingClock:
    """A clock that advances by a fixed time whenever it is read."""

    tick: float = 0.0
    now: float = 0.0

    def __call__(self) -> float:
        self.now += self.tick
        return self.now


def toy_planner(
    world: ToyWorld,
    *,
    seed: int = 0,
    steps: int | None = 200,
    seconds: float = 60.0,
    cpu_seconds: float | None = None,
    rule: RuleConfig | None = None,
    max_expansions: int = 1000,
    estimator: Estimator[ToyConfiguration] | None = None,
    verify: Callable[[tuple[Attempt[ToyConfiguration], ...]], bool] = lambda _: True,
    execute: Execute[ToyConfiguration] | None = None,
    listeners: Sequence[Listener] = (),
    stop: Callable[[], bool] = lambda: False,
    clock: Callable[[], float] | None = None,
    cpu_clock: Callable[[], float] | None = None,
) -> Planner[ToyConfiguration]:
    """The planner for a world. Time stands still unless a clock is given."""
    config = PlannerConfig(Budget(seconds, steps, cpu_seconds), max_expansions, rule or ProportionalConfig())
    return config.create(
        c=world.start,
        s=abstraction(world.start),
        generator=ToyGenerator(world),
        skills=world,
        estimator=estimator or Constant(1.0),
        verify=verify,
        rng=np.random.default_rng(seed),
        execute=execute,
        listeners=listeners,
        stop=stop,
        clock=clock or TickingClock(),
        cpu_clock=cpu_clock or clock or TickingClock(),
    )


def encode(c: ToyConfiguration) -> list[float]:
    """A configuration in the types of JSON."""
    return [*c.cell, c.offset]


def assert_consistent(tree: Tree[ToyConfiguration]) -> None:
    """Assert laws that hold in every tree, whatever the rule."""
    steps = tree.steps
    assert sum(sum(node.cnt.values()) for node in tree.nodes) == len(steps)
    assert len(tree.nodes) == 1 + sum(step.attempt.succeeded for step in steps)
    for node in tree.nodes:
        assert abstraction(node.c) == node.s
        assert node.depth == len(tree.path(node.index))
        for plan, cnt in node.cnt.items():
            assert tree.plans[plan].states[0] == node.s
            assert (node.index in tree.holders[plan]) == (node.index not in tree.refuted)
            assert cnt == sum((step.node, step.plan) == (node.index, plan) for step in steps)
    held = [len(node.cnt) for node in tree.nodes if node.index not in tree.refuted]
    assert sum(map(len, tree.holders)) == sum(held)
    assert len(set(tree.plans)) == len(tree.plans)
    for step in steps:
        if step.child is not None:
            child = tree.nodes[step.child]
            assert child.parent == step.node < step.child
            assert child.attempt is step.attempt
            assert [tree.plans[plan] for plan in child.cnt] == [tree.plans[step.plan].suffix(1)]
