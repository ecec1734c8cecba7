"""Streams of high-level plans p = (s_0, a_1, s_1, ..., s_n), resumable after any number of expansions.

A stream contains every plan that visits no state twice and ends where it first reaches the goal. Different plans may
share states. The order depends only on the problem.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from heapq import heappop, heappush, heapreplace
from typing import NamedTuple, Optional

from ictamp_drake.core.checks import check_fields
from ictamp_drake.core.protocols import Guide, PlanGenerator
from ictamp_drake.core.types import Action, Obstruction, Skeleton, State
from ictamp_drake.symbolic.atoms import MOVED, objects_beneath, supporters
from ictamp_drake.symbolic.context import GeneratorContext
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.symbolic.goal import Goal
from ictamp_drake.symbolic.guides import BreadthFirstDistance, MoveCount, Patience


@dataclass(frozen=True)
class BreadthFirst:
    """Plans in order of length. The first one takes about as many nodes as breadth-first search.

    Attributes:
        patience: Maximum number of states that breadth-first search expands. When it is used up, as with many objects,
            the number of unavoidable moves guides the search from then on (A*).
    """

    patience: int = 50_000

    def __post_init__(self) -> None:
        check_fields(self, "generators.breadth-first", patience=(1, math.inf))

    def create(self, context: GeneratorContext) -> PlanGenerator:
        """A stream of plans from the initial state to states that hold the goal."""
        domain, initial, goal = context.domain, context.initial, context.goal
        distance, moves = BreadthFirstDistance(domain, initial, goal), MoveCount(domain, goal, weight=1.0)
        return Detours(domain, initial, goal, Patience(distance, moves, self.patience))


MAX_WEIGHT = 1e6
"""Maximum weight of a bound; an infinite product would mean that the goal cannot be reached."""


@dataclass(frozen=True)
class BestFirst:
    """Plans for many objects, roughly the shortest first.

    Attributes:
        weight: Factor on the lower bound for the actions that a state still needs. With 1, plans come in order of
            length. A greater weight means fewer nodes until the first plan and a looser order.
    """

    weight: float = 2.0

    def __post_init__(self) -> None:
        check_fields(self, "generators.best-first", weight=(0, MAX_WEIGHT))

    def create(self, context: GeneratorContext) -> PlanGenerator:
        """A stream of plans from the initial state to states that hold the goal."""
        domain, goal = context.domain, context.goal
        return Detours(domain, context.initial, goal, MoveCount(domain, goal, self.weight))


@dataclass(frozen=True, slots=True, eq=False)
class _Path:
    """Beginning of a plan, linked to the path that is one action shorter."""

    state: State
    length: int = 0
    action: Action | None = None
    parent: Optional["_Path"] = None

    def __iter__(self) -> Iterator["_Path"]:
        path: _Path | None = self
        while path is not None:
            yield path
            path = path.parent


class _Entry(NamedTuple):
    """Path in the queue, ordered by smallest bound, then greatest length, then first generated."""

    bound: float
    minus_length: int
    order: int
    path: _Path


class PlanStream:
    """Best-first search over paths instead of states. The bound of a path is its length plus the guide's estimate.

    A node is a path taken from the queue or a state that the guide expands. A plan costs at least one node. Paths that
    a guide with a finite horizon cannot order yet wait just beyond its horizon.
    """

    def __init__(self, domain: Domain, initial: State, goal: Goal, guide: Guide) -> None:
        self._domain = domain
        self._goal = goal
        self._guide = guide
        self._queue = [_Entry(0, 0, 0, _Path(initial))]
        self._generated = 1
        self._expanded = 0

    @property
    def exhausted(self) -> bool:
        """Whether no further plan can come."""
        return not self._queue

    @property
    def expanded(self) -> int:
        """Number of nodes expanded since the start."""
        return self._expanded

    def next_plan(self, max_expansions: int) -> Skeleton | None:
        """Expand at most `max_expansions` nodes and return the first new plan found, otherwise None."""
        limit = self._expanded + max_expansions
        while self._settle_first() and self._expanded < limit:
            self._expanded += 1
            if self._queue[0].bound > self._guide.horizon:
                self._guide.grow()
                continue
            path = heappop(self._queue).path
            if self._goal.holds(path.state):
                return _skeleton(path)
            self._expand(path)
        return None

    def _settle_first(self) -> bool:
        """Update the bound of the first path until it stays first. Return False when no path is left."""
        while self._queue:
            entry = self._queue[0]
            bound = self._bound(entry.path)
            if bound == math.inf:
                heappop(self._queue)
            elif bound > entry.bound:
                heapreplace(self._queue, entry._replace(bound=bound))
            else:
                return True
        return False

    def _bound(self, path: _Path) -> float:
        return min(path.length + self._guide.estimate_distance(path.state), self._guide.horizon + 1)

    def _expand(self, path: _Path) -> None:
        visited = {each.state for each in path}
        for action, state in self._domain.successors(path.state):
            if state not in visited:
                longer = _Path(state, path.length + 1, action, path)
                heappush(self._queue, _Entry(self._bound(longer), -longer.length, self._generated, longer))
                self._generated += 1


class Detours:
    """A stream of plans and, for each set of obstructions, a stream of plans that move them first.

    Such a plan either avoids the obstructed action or moves the obstructing box before it, possibly just to another
    place on the same receptacle. The plan does not guarantee that the box is then out of the way; the low-level steps
    decide that. No plan is returned twice.
    """

    def __init__(self, domain: Domain, initial: State, goal: Goal, guide: Guide) -> None:
        self._domain = domain
        self._initial = initial
        self._goal = goal
        self._plain = PlanStream(domain, initial, goal, guide)
        self._around: dict[frozenset[Obstruction], PlanStream] = {}
        self._barren: set[frozenset[Obstruction]] = set()
        self._given: set[Skeleton] = set()

    @property
    def exhausted(self) -> bool:
        """Whether no further plan can come."""
        return self._plain.exhausted

    @property
    def expanded(self) -> int:
        """Number of nodes expanded since the start."""
        return sum(stream.expanded for stream in (self._plain, *self._around.values()))

    def next_plan(self, max_expansions: int, obstructions: frozenset[Obstruction] = frozenset()) -> Skeleton | None:
        """Expand at most `max_expansions` nodes and return the first new plan found, otherwise None.

        When no plan that moves the obstructions is found, the next call with the same obstructions returns any plan.
        """
        obstructions = frozenset(filter(self._can_be_moved_first, obstructions))
        if not obstructions or obstructions in self._barren:
            return self._next_new(self._plain, max_expansions)
        if obstructions not in self._around:
            self._around[obstructions] = self._stream_around(obstructions)
        plan = self._next_new(self._around[obstructions], max_expansions)
        if plan is None:
            self._barren.add(obstructions)
        return plan

    def _next_new(self, stream: PlanStream, max_expansions: int) -> Skeleton | None:
        limit = stream.expanded + max_expansions
        while (plan := stream.next_plan(limit - stream.expanded)) is not None:
            plan = Skeleton(tuple(map(_drop_moved, plan.states)), plan.actions)
            if plan not in self._given:
                self._given.add(plan)
                return plan
        return None

    def _can_be_moved_first(self, obstruction: Obstruction) -> bool:
        """Whether the box of an obstruction can be moved first: not a support, and not beneath the box to pick."""
        (name, args), box = obstruction
        return box in self._domain.boxes and not (
            name == "pick" and box in objects_beneath(args[0], supporters(self._initial))
        )

    def _stream_around(self, obstructions: frozenset[Obstruction]) -> PlanStream:
        domain = self._domain.with_obstructions(obstructions)
        guide = MoveCount(domain, self._goal, weight=1.0, obstructions=obstructions)
        return PlanStream(domain, self._initial, self._goal, guide)


def _skeleton(path: _Path) -> Skeleton:
    paths = list(path)[::-1]
    return Skeleton(
        tuple(each.state for each in paths), tuple(each.action for each in paths if each.action is not None)
    )


def _drop_moved(state: State) -> State:
    return frozenset(atom for atom in state if atom.predicate != MOVED)
