"""The ground domain: effects of pick and place, and laws of all their sequences."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.core.errors import Code
from ictamp_drake.core.types import Action, Atom, Obstruction, State
from ictamp_drake.symbolic.atoms import CLEAR, HAND_EMPTY, IN_HAND, LYING, MOVED, ON, held_box, supporters, tipped_boxes
from ictamp_drake.symbolic.domain import Domain
from tests.refusals import refusal
from tests.symbolic.towers import LEVELS, Problem, problems, state

BOXES, SUPPORTS = ("cyan", "red"), ("rack", "table")


def reachable(domain: Domain, initial: State) -> set[State]:
    seen, frontier = {initial}, [initial]
    while frontier:
        frontier = [s for before in frontier for _, s in domain.successors(before) if s not in seen]
        seen.update(frontier)
    return seen


def applicable(domain: Domain, s: State) -> list[Action]:
    return [action for action, _ in domain.successors(s)]


def test_pick_takes_an_upright_box_off_another_box() -> None:
    initial = state([("table", "cyan", "red")])
    picked = Domain.create(BOXES, SUPPORTS, initial).successor(initial, Action("pick", ("red", "cyan")))
    gone = {Atom(ON, ("red", "cyan")), Atom(CLEAR, ("red",)), Atom(HAND_EMPTY, ())}
    assert picked == (initial - gone) | {Atom(IN_HAND, ("red",)), Atom(CLEAR, ("cyan",))}


def test_a_tipped_box_is_picked_and_placed_lying() -> None:
    initial = state([("table", "red"), ("table", "cyan")], tipped=("red",))
    domain = Domain.create(BOXES, SUPPORTS, initial)
    picked = domain.successor(initial, Action("pick", ("red", "table")))
    placed = domain.successor(picked, Action("place", ("red", "cyan")))
    assert placed == state([("table", "cyan", "red")], tipped=("red",))
    assert Atom(LYING, ("red", "cyan")) in placed


def test_supports_hold_several_boxes_and_are_never_clear() -> None:
    initial = state([("table", "red"), ("rack", "cyan")])
    domain = Domain.create(BOXES, SUPPORTS, initial)
    picked = domain.successor(initial, Action("pick", ("cyan", "rack")))
    assert applicable(domain, picked) == [Action("place", ("cyan", b)) for b in ("rack", "table", "red")]
    assert all(atom.args[0] in BOXES for action in domain.actions for atom in action.add if atom.predicate == CLEAR)


def test_actions_are_strips_without_static_atoms_supports_first() -> None:
    domain = LEVELS["easy"].domain
    places = [*domain.supports, *domain.boxes]
    order = [(g.action.name, places.index(g.action.args[1]), g.action.args[0]) for g in domain.actions]
    assert order == sorted(order)
    assert len(domain.actions) == 2 * 4 * 5
    predicates = {atom.predicate for g in domain.actions for atom in g.preconditions | g.add | g.delete}
    assert predicates == {ON, IN_HAND, CLEAR, HAND_EMPTY}


def test_an_action_waits_until_what_is_in_its_way_was_moved() -> None:
    initial = state([("table", "cyan"), ("table", "red")])
    pick_cyan, pick_red = Action("pick", ("cyan", "table")), Action("pick", ("red", "table"))
    domain = Domain.create(BOXES, SUPPORTS, initial)
    minding = domain.with_obstructions({Obstruction(pick_cyan, "red")})
    assert applicable(minding, initial) == [pick_red]
    picked = minding.successor(initial, pick_red)
    assert picked == domain.successor(initial, pick_red)
    placed = minding.successor(picked, Action("place", ("red", "table")))
    assert placed == initial | {Atom(MOVED, ("red",))}
    assert pick_cyan in applicable(minding, placed)


def test_an_action_that_does_not_apply_is_refused() -> None:
    initial = state([("table", "cyan", "red")])
    domain = Domain.create(BOXES, SUPPORTS, initial)
    for action in (Action("pick", ("cyan", "table")), Action("place", ("red", "rack")), Action("push", ("red",))):
        with pytest.raises(ValueError, match="not applicable"):
            domain.successor(initial, action)


@pytest.mark.parametrize("problem", LEVELS.values(), ids=LEVELS)
def test_four_boxes_and_two_supports_have_480_states(problem: Problem) -> None:
    assert len(reachable(problem.domain, problem.initial)) == 480


@given(problems(boxes=3))
def test_every_box_is_in_one_place_and_clear_says_what_is_free(problem: Problem) -> None:
    for s in reachable(problem.domain, problem.initial):
        below, held = supporters(s), held_box(s)
        assert sorted((*below, *([held] if held else []))) == sorted(problem.boxes)
        assert sum(atom.predicate in (ON, LYING, IN_HAND) for atom in s) == len(problem.boxes)
        assert (Atom(HAND_EMPTY, ()) in s) == (held is None)
        free = set(problem.boxes) - set(below.values()) - {held}
        assert {atom.args[0] for atom in s if atom.predicate == CLEAR} == free
        assert tipped_boxes(s) == tipped_boxes(problem.initial)
        assert all((Atom(LYING, pair) in s) == (pair[0] in tipped_boxes(s)) for pair in below.items())
        assert len(set(below.values()) & set(problem.boxes)) == sum(b in problem.boxes for b in below.values())


@given(problems(boxes=4), st.data())
def test_place_undoes_pick_and_pick_undoes_place(problem: Problem, data: st.DataObject) -> None:
    domain, inverse = problem.domain, {"pick": "place", "place": "pick"}
    s = problem.initial
    for _ in range(6):
        for action, after in domain.successors(s):
            assert domain.successor(after, Action(inverse[action.name], action.args)) == s
        s = data.draw(st.sampled_from(domain.successors(s)))[1]


@pytest.mark.parametrize("name", ["on", "pick", "box", "thing", "cyan"])
def test_a_name_that_is_taken_is_refused(name: str) -> None:
    initial = state([("table", "cyan"), ("table", name)])
    with refusal(Code.BAD_NAME, value=name):
        Domain.create(("cyan", name), SUPPORTS, initial)


def test_a_box_in_two_places_or_none_is_refused() -> None:
    initial = state([("table", "cyan"), ("table", "red")])
    two = initial | {Atom(ON, ("red", "cyan"))}
    with refusal(
        Code.BAD_STATE,
        "red",
        value=sorted(atom for atom in two if atom.args[:1] == ("red",) and atom.predicate != "clear"),
    ):
        Domain.create(BOXES, SUPPORTS, two)
    with refusal(Code.BAD_STATE, "blue", value=[]):
        Domain.create((*BOXES, "blue"), SUPPORTS, initial)
