"""Guides of the search for plans: estimates of the number of actions from a state to the goal."""

import math
from collections import deque
from collections.abc import Collection, Iterator
from functools import cache
from itertools import pairwise

from ictamp_drake.core.protocols import Guide
from ictamp_drake.core.types import Atom, Obstruction, State
from ictamp_drake.symbolic.atoms import CLEAR, IN_HAND, LYING, MOVED, ON, held_box, objects_beneath, supporters
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.symbolic.goal import Alternative, Goal
from ictamp_drake.symbolic.masks import Masks


class BreadthFirstDistance:
    """Exact distances from a breadth-first search that stores each state once and grows on demand.

    All states of a plan with n actions, except the last, are less than n actions away from the start. So once the
    layers 0 to n - 1 are expanded, every path to the goal that such a plan can take is known: the horizon is n.
    """

    def __init__(self, domain: Domain, initial: State, goal: Goal) -> None:
        self._masks = Masks(domain, goal)
        self._mask_of = cache(self._masks.encode)
        start = self._mask_of(initial)
        self._depth = {start: 0}
        self._remaining: dict[int, int] = {}
        self._predecessors: dict[int, list[int]] = {start: []}
        self._frontier: deque[int] = deque()
        self._reach(start)

    @property
    def horizon(self) -> float:
        return self._depth[self._frontier[0]] if self._frontier else math.inf

    def estimate_distance(self, state: State) -> float:
        return self._remaining.get(self._mask_of(state), math.inf)

    def grow(self) -> None:
        mask = self._frontier.popleft()
        deeper = self._depth[mask] + 1
        for successor in self._masks.successors(mask):
            if successor in self._depth:
                self._predecessors[successor].append(mask)
            else:
                self._predecessors[successor] = [mask]
                self._depth[successor] = deeper
                self._reach(successor)
            if successor in self._remaining:
                self._shorten(mask, self._remaining[successor] + 1)

    def _reach(self, mask: int) -> None:
        if self._masks.is_goal(mask):
            self._remaining[mask] = 0
        else:
            self._frontier.append(mask)

    def _shorten(self, mask: int, distance: int) -> None:
        """Lower the distance of the state and those of the states before it."""
        pending = deque([(mask, distance)])
        while pending:
            mask, distance = pending.popleft()
            if distance < self._remaining.get(mask, math.inf):
                self._remaining[mask] = distance
                pending.extend((before, distance + 1) for before in self._predecessors[mask])


class MoveCount:
    """A lower bound from the towers alone, times a weight: two actions for each unavoidable move.

    A goal with several alternatives is as near as the nearest one. An action lowers the bound by at most one, so with
    weight 1 plans come in order of length. A greater weight means fewer nodes and longer plans.
    """

    horizon = math.inf

    def __init__(
        self,
        domain: Domain,
        goal: Goal,
        weight: float,
        obstructions: Collection[Obstruction] = frozenset(),
    ) -> None:
        self._weight = weight
        self._moves = [_Moves(domain, alternative, obstructions) for alternative in goal.alternatives]
        self._known: dict[State, float] = {}

    def estimate_distance(self, state: State) -> float:
        if state not in self._known:
            supporter = supporters(state)
            self._known[state] = self._weight * min(
                [moves.count_actions(state, supporter) for moves in self._moves], default=math.inf
            )
        return self._known[state]

    def grow(self) -> None:
        raise RuntimeError("nothing can be added to a bound with an infinite horizon")


def boxes_to_move(domain: Domain, goal: Goal, state: State) -> frozenset[str]:
    """Return the boxes that every plan from the state to the goal moves from what they rest on."""
    supporter = supporters(state)
    needed = (_Moves(domain, each, frozenset()).list_to_move(state, supporter) for each in goal.alternatives)
    return frozenset[str]().union(next(needed, set())).intersection(*needed)


class _Moves:
    """Unavoidable moves to one alternative of a goal.

    A box must move when it is not where the goal wants it, when the goal excludes it from where it is or wants another
    box or nothing there, when the goal wants it in the hand, when it is in the way of an unavoidable action, or when it
    rests on a box that must move. It must move twice when a box that must move is beneath it both now and in the goal:
    it has to leave before that box does, and can take its place only afterwards. The last move may end in the hand,
    unless the goal is only about what boxes rest on.
    """

    def __init__(self, domain: Domain, goal: Alternative, obstructions: Collection[Obstruction]) -> None:
        self._goal = goal
        self._obstructions = obstructions
        self._allowed = goal.places
        self._target = goal.targets
        single = {*domain.boxes, *domain.poses}
        self._occupant = {below: box for box, below in self._target.items() if below in single}
        self._beneath_in_goal = {box: frozenset(objects_beneath(box, self._target)) for box in self._target}
        self._lifted = frozenset(atom.args[0] for atom in goal.atoms if atom.predicate == IN_HAND)
        self._clear = frozenset(atom.args[0] for atom in goal.atoms if atom.predicate == CLEAR)
        self._may_end_in_hand = bool(goal.absent) or any(atom.predicate not in (ON, LYING) for atom in goal.atoms)

    def count_actions(self, state: State, supporter: dict[str, str]) -> int:
        """Return a lower bound on the number of actions from the state; `supporter` says what each box rests on."""
        if self._goal.holds(state):
            return 0
        to_move = self.list_to_move(state, supporter)
        actions = 2 * len(to_move)
        actions += sum(2 for box in to_move if self._must_move_twice(box, supporter, to_move))
        held = held_box(state)
        if held is not None:
            actions += 1 if self._can_be_placed(held, supporter, to_move) else 3
        return max(actions - self._may_end_in_hand, 1)

    def list_to_move(self, state: State, supporter: dict[str, str]) -> set[str]:
        """Return the boxes that every plan to the alternative moves; `supporter` says what each box rests on."""
        unwanted = {atom.args for atom in self._goal.absent & state}
        in_the_way, before = set[str](), None
        while in_the_way != before:
            to_move = {box for box in supporter if self._must_move(box, supporter, in_the_way, unwanted)}
            in_the_way, before = set(self._list_in_the_way(state, supporter, to_move)), in_the_way
        return to_move

    def _list_in_the_way(self, state: State, supporter: dict[str, str], to_move: set[str]) -> Iterator[str]:
        """Yield boxes in the way of an unavoidable action: a pick of a box that must move, or a place of the goal."""
        for (name, (box, place)), obstacle in self._obstructions:
            there, moves = supporter.get(box) == place, box in to_move
            needed = there and moves if name == "pick" else self._target.get(box) == place and (moves or not there)
            if needed and Atom(MOVED, (obstacle,)) not in state:
                yield obstacle

    def _must_move(
        self, box: str, supporter: dict[str, str], in_the_way: set[str], unwanted: Collection[tuple[str, ...]]
    ) -> bool:
        tower = (box, *objects_beneath(box, supporter))
        return not in_the_way.isdisjoint(tower) or any(
            self._is_misplaced(each, below) or (each, below) in unwanted for each, below in pairwise(tower)
        )

    def _is_misplaced(self, box: str, below: str) -> bool:
        return (
            below not in self._allowed.get(box, (below,))
            or self._occupant.get(below, box) != box
            or box in self._lifted
            or below in self._clear
        )

    def _must_move_twice(self, box: str, supporter: dict[str, str], to_move: set[str]) -> bool:
        in_goal = self._beneath_in_goal.get(box, frozenset())
        return any(below in to_move and below in in_goal for below in objects_beneath(box, supporter))

    def _can_be_placed(self, held: str, supporter: dict[str, str], to_move: set[str]) -> bool:
        in_goal = self._beneath_in_goal.get(held, frozenset())
        occupied = self._target.get(held) in self._occupant and self._target[held] in supporter.values()
        return to_move.isdisjoint(in_goal) and not occupied


class Patience:
    """Uses one guide until it has grown a given number of times, then another one."""

    def __init__(self, first: Guide, then: Guide, growths: int) -> None:
        self._guide = first
        self._then = then
        self._left = growths

    @property
    def horizon(self) -> float:
        return self._guide.horizon

    def estimate_distance(self, state: State) -> float:
        return self._guide.estimate_distance(state)

    def grow(self) -> None:
        self._guide.grow()
        self._left -= 1
        if not self._left:
            self._guide = self._then
