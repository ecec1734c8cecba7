"""Symbolic states from towers, the three packing levels, and random problems of towers."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass
from functools import cache
from itertools import pairwise

from hypothesis import strategies as st

from ictamp_drake.core.types import Atom, Obstruction, State
from ictamp_drake.symbolic.atoms import CLEAR, HAND_EMPTY, LYING, ON, TIPPED, UPRIGHT, tipped_boxes
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.symbolic.goal import Goal

Tower = tuple[str, ...]
"""A support and the boxes on it, from below."""


@cache
def _domain(boxes: tuple[str, ...], supports: tuple[str, ...], tipped: tuple[str, ...]) -> Domain:
    """The domain depends on the start only through the tipped boxes."""
    return Domain.create(boxes, supports, state([(supports[0], box) for box in boxes], tipped))


@dataclass(frozen=True)
class Problem:
    """Start and goal of a search."""

    boxes: tuple[str, ...]
    supports: tuple[str, ...]
    initial: State
    goal: Goal

    @property
    def domain(self) -> Domain:
        return _domain(self.boxes, self.supports, tuple(sorted(tipped_boxes(self.initial))))


def state(towers: Sequence[Tower], tipped: Sequence[str] = ()) -> State:
    """The state of the towers with an empty hand."""
    atoms = {Atom(HAND_EMPTY, ())}
    for tower in towers:
        for below, box in pairwise(tower):
            atoms |= {Atom(LYING if box in tipped else ON, (box, below))}
            atoms |= {Atom(TIPPED if box in tipped else UPRIGHT, (box,))}
        atoms |= {Atom(CLEAR, (tower[-1],))} if len(tower) > 1 else set()
    return frozenset(atoms)


def tower_atoms(tower: Tower, tipped: Collection[str] = ()) -> frozenset[Atom]:
    """Atoms that hold when the tower stands, with its tipped boxes lying."""
    return frozenset(Atom(LYING if box in tipped else ON, (box, below)) for below, box in pairwise(tower))


def tower_goal(tower: Tower) -> Goal:
    """Goal that the tower stands."""
    return Goal.of(tower_atoms(tower))


def level(*towers: Tower, goal: Tower) -> Problem:
    return Problem(("blue", "cyan", "red", "yellow"), ("rack", "table"), state(towers), tower_goal(goal))


LEVELS = {
    "easy": level(("table", "cyan", "yellow"), ("table", "red"), ("table", "blue"), goal=("rack", "cyan", "yellow")),
    "medium": level(("table", "cyan", "yellow", "red"), ("table", "blue"), goal=("rack", "cyan", "yellow", "red")),
    "hard": level(("table", "cyan", "yellow", "red", "blue"), goal=("rack", "cyan", "yellow", "red", "blue")),
}


@st.composite
def arrangements(draw: st.DrawFn, boxes: Sequence[str], supports: Sequence[str]) -> list[Tower]:
    """All boxes in random towers on random supports."""
    towers: list[Tower] = []
    for box in draw(st.permutations(boxes)):
        bases = [(support,) for support in supports]
        base = draw(st.sampled_from([*bases, *towers]))
        towers = [tower for tower in towers if tower != base] + [(*base, box)]
    return towers


@st.composite
def problems(draw: st.DrawFn, boxes: int = 3, supports: int = 2) -> Problem:
    """A random start, and a part of another random arrangement as goal; boxes may lie in both."""
    box_names = tuple(f"box_{i}" for i in range(draw(st.integers(1, boxes))))
    support_names = tuple(f"table_{i}" for i in range(draw(st.integers(1, supports))))
    tipped = draw(st.sets(st.sampled_from(box_names)))
    towers = draw(arrangements(box_names, support_names))
    final = frozenset[Atom]().union(*(tower_atoms(tower, tipped) for tower in towers))
    goal = Goal.of(draw(st.sets(st.sampled_from(sorted(final)), min_size=1)))
    return Problem(box_names, support_names, state(draw(arrangements(box_names, support_names)), sorted(tipped)), goal)


def draw_obstructions(problem: Problem) -> st.SearchStrategy[frozenset[Obstruction]]:
    """One or two obstructions of actions of the problem, including impossible ones."""
    actions = [ground.action for ground in problem.domain.actions]
    things = [*problem.boxes, *problem.supports]
    return st.frozensets(
        st.builds(Obstruction, st.sampled_from(actions), st.sampled_from(things)), min_size=1, max_size=2
    )


@st.composite
def formulas(
    draw: st.DrawFn,
    boxes: Sequence[str],
    supports: Sequence[str],
    depth: int = 3,
    variables: tuple[tuple[str, str], ...] = (),
) -> str:
    """A goal in PDDL, in which every variable has a quantifier."""
    bound = [name for name, kind in variables if kind == "box"]
    box = st.sampled_from([*boxes, *bound])
    thing = st.sampled_from([*boxes, *supports, *(name for name, _ in variables)])
    connective = draw(st.sampled_from(["atom", "not", "and", "or", "imply", "exists", "forall"])) if depth else "atom"
    if connective == "atom":
        predicate = draw(st.sampled_from(["on", "on", "lying", "clear", "in-hand", "hand-empty", "="]))
        terms = {"on": (box, thing), "lying": (box, thing), "hand-empty": (), "=": (thing, thing)}
        return f"({' '.join([predicate, *map(draw, terms.get(predicate, (box,)))])})"
    if connective in ("exists", "forall"):
        name, kind = f"?v{len(variables)}", draw(st.sampled_from(["box", "support", "thing"]))
        body = draw(formulas(boxes, supports, depth - 1, (*variables, (name, kind))))
        return f"({connective} ({name} - {kind}) {body})"
    count = {"not": 1, "imply": 2}.get(connective) or draw(st.integers(1, 3))
    parts = [draw(formulas(boxes, supports, depth - 1, variables)) for _ in range(count)]
    return f"({' '.join([connective, *parts])})"


def reachable(domain: Domain, initial: State) -> set[State]:
    """All states that actions lead to from the initial one, which is among them."""
    found, frontier = {initial}, [initial]
    while frontier:
        new = {after for _, after in domain.successors(frontier.pop())} - found
        found |= new
        frontier += new
    return found
