"""Ground actions agree with a brute-force reference, and with those of unified-planning."""

from collections.abc import Mapping
from importlib.resources import files
from itertools import pairwise, permutations, product

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ictamp_drake.core.errors import Code
from ictamp_drake.core.types import Action, Atom, State
from ictamp_drake.symbolic import grounding
from ictamp_drake.symbolic.atoms import CLEAR, HAND_EMPTY, IN_HAND, LYING, ON
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.symbolic.formulas import TRUE, Not, Or
from ictamp_drake.symbolic.grounding import GroundAction, ground
from ictamp_drake.symbolic.pddl import read_domain
from tests.refusals import refusal
from tests.symbolic import theirs
from tests.symbolic.towers import Problem, problems, state

THIRTY = tuple(f"box_{number:02}" for number in range(30))
SUPPORTS = ("rack", "table", "tray")


def reference(box: str, place: str, boxes: tuple[str, ...], lies: bool) -> list[GroundAction]:
    """Picks of a box off a place and placements of it there, written out."""
    there, held, hand = Atom(LYING if lies else ON, (box, place)), Atom(IN_HAND, (box,)), Atom(HAND_EMPTY, ())
    free, room = Atom(CLEAR, (box,)), {Atom(CLEAR, (place,))} if place in boxes else set()
    at_rest, args = frozenset({hand, free, there}), (box, place)
    return [
        GroundAction(Action("pick", args), at_rest, frozenset({held} | room), at_rest),
        GroundAction(Action("place", args), frozenset({held} | room), at_rest, frozenset({held} | room)),
    ]


@pytest.mark.parametrize("tipped", [THIRTY[::4], (), THIRTY], ids=["some", "none", "all"])
def test_thirty_boxes_have_the_actions_that_brute_force_finds(tipped: tuple[str, ...]) -> None:
    towers = [("rack", *THIRTY[:3]), *(("table", box) for box in THIRTY[3:])]
    domain = Domain.create(THIRTY, SUPPORTS, state(towers, tipped))
    pairs = [(box, place) for place in (*SUPPORTS, *THIRTY) for box in THIRTY if box != place]
    picks, places = zip(*(reference(*pair, THIRTY, pair[0] in tipped) for pair in pairs), strict=True)
    assert domain.actions == (*picks, *places)


def objects_of(problem: Problem) -> dict[str, str]:
    return dict.fromkeys(problem.boxes, "box") | dict.fromkeys(problem.supports, "support")


@settings(max_examples=20)
@given(problems(boxes=5, supports=3))
def test_the_domain_of_boxes_grounds_as_it_does_elsewhere(problem: Problem) -> None:
    text = (files("ictamp_drake.symbolic") / "domain.pddl").read_text()
    other = theirs.ground(theirs.problem(text, objects_of(problem), problem.initial))
    assert {each.action: (each.preconditions, each.add, each.delete) for each in problem.domain.actions} == other
    assert all(each.is_plain for each in problem.domain.actions)


def agree(text: str, objects: Mapping[str, str], initial: State, limit: int = 60) -> tuple[GroundAction, ...]:
    """Compare the applicable actions and their successors in all states, or in the first ones; return the actions."""
    actions = ground(read_domain(text, "toy.pddl"), objects, initial)
    simulator = theirs.Simulator(theirs.problem(text, objects, initial))
    other = simulator.initial()
    assert simulator.atoms(other) == initial
    seen, frontier = {initial}, [other]
    while frontier and len(seen) < limit:
        other = frontier.pop()
        s, after = simulator.atoms(other), simulator.successors(other)
        ours = {each.action: each.apply(s) for each in actions if each.applies(s)}
        assert ours == {action: simulator.atoms(each) for action, each in after.items()}
        frontier += [each for action, each in after.items() if ours[action] not in seen]
        seen.update(ours.values())
    assert len(seen) > 1
    return actions


ROBOT = """(define (domain robot)
  (:requirements :adl)
  (:types room thing - object cup ball - thing)
  (:constants hall - room)
  (:predicates
    (door ?a - room ?b - room) (at ?r - room) (in ?t - thing ?r - room) (held ?t - thing) (broken ?c - cup) (light))
  (:action go
    :parameters (?a - room ?b - room)
    :precondition (and (at ?a) (not (= ?a ?b)) (or (door ?a ?b) (door ?b ?a)) (or (light) (= ?b hall)))
    :effect (and (at ?b) (not (at ?a))))
  (:action switch
    :parameters ()
    :precondition (at hall)
    :effect (and (when (light) (not (light))) (when (not (light)) (light))))
  (:action take
    :parameters (?t - thing ?r - room)
    :precondition (and (at ?r) (in ?t ?r) (not (exists (?o - thing) (held ?o)))
      (forall (?c - cup) (imply (= ?c ?t) (not (broken ?c)))))
    :effect (and (held ?t) (not (in ?t ?r))))
  (:action drop
    :parameters (?t - thing)
    :precondition (held ?t)
    :effect (and (not (held ?t))
      (forall (?r - room) (when (at ?r) (in ?t ?r)))
      (forall (?c - cup) (when (and (= ?c ?t) (not (at hall))) (broken ?c)))))
  (:action tidy
    :parameters (?r - room)
    :precondition (and (at ?r) (forall (?t - thing) (or (held ?t) (in ?t ?r))))
    :effect (forall (?c - cup) (not (broken ?c)))))
"""
ROOMS = {"kitchen": "room", "attic": "room", "mug": "cup", "tennis": "ball"}
START = frozenset(
    {
        Atom("door", ("kitchen", "hall")),
        Atom("door", ("hall", "attic")),
        Atom("at", ("kitchen",)),
        Atom("in", ("mug", "kitchen")),
        Atom("in", ("tennis", "attic")),
        Atom("light", ()),
    }
)


def test_a_domain_of_all_constructs_goes_where_it_goes_elsewhere() -> None:
    actions = {each.action: each for each in agree(ROBOT, ROOMS, START, limit=150)}
    assert Action("go", ("kitchen", "attic")) not in actions, "there is no door, and doors are static"
    assert Action("go", ("hall", "hall")) not in actions
    into_the_hall = actions[Action("go", ("kitchen", "hall"))]
    assert into_the_hall == GroundAction(
        Action("go", ("kitchen", "hall")),
        frozenset({Atom("at", ("kitchen",))}),
        frozenset({Atom("at", ("hall",))}),
        frozenset({Atom("at", ("kitchen",))}),
    )
    assert len(actions[Action("switch", ())].conditional) == 2
    assert len(actions[Action("drop", ("mug",))].conditional) == 4


def test_what_is_added_and_deleted_at_once_holds() -> None:
    text = "(define (domain d) (:predicates (p) (q)) (:action a :effect (and (p) (not (p)) (when (q) (not (p))))))"
    (action,) = ground(read_domain(text, "d.pddl"), {}, frozenset())
    for before in (frozenset[Atom](), frozenset({Atom("p", ()), Atom("q", ())})):
        assert Atom("p", ()) in action.apply(before)


def test_an_action_that_contradicts_itself_is_left_out() -> None:
    text = """(define (domain d) (:predicates (p ?x) (s ?x))
      (:action a :parameters (?x ?y) :precondition (and (p ?x) (not (p ?y))) :effect (p ?y))
      (:action b :parameters (?x) :precondition (or (s ?x) (and (s ?x) (p ?x))) :effect (p ?x)))"""
    objects = dict.fromkeys("uvw", "object")
    actions = ground(read_domain(text, "d.pddl"), objects, frozenset({Atom("s", ("w",))}))
    assert [str(each.action) for each in actions if each.action.name == "a"] == [
        f"a({x}, {y})" for x, y in permutations("uvw", 2)
    ]
    (b,) = [each for each in actions if each.action.name == "b"]
    assert (b.action.args, b.preconditions, b.further) == (("w",), frozenset(), TRUE)


def test_what_is_no_set_of_atoms_is_kept_as_a_formula() -> None:
    text = "(define (domain d) (:predicates (p) (q) (r)) (:action a :precondition (and (p) (or (q) (not (r)))) "
    (action,) = ground(read_domain(f"{text} :effect (and (q) (r) (not (p)))))", "d.pddl"), {}, frozenset())
    assert action.preconditions == {Atom("p", ())}
    assert action.further == Or((Atom("q", ()), Not(Atom("r", ()))))
    assert not action.is_plain


VARIABLES = ("?x", "?y")
NAMES = ("a", "b", "c")


@st.composite
def conditions(draw: st.DrawFn, depth: int = 3, variables: tuple[str, ...] = VARIABLES) -> str:
    """Text of a random formula; s is static, and every variable has the type half."""
    kinds = ["p", "s", "q", "="] + (["and", "or", "not", "imply", "forall", "exists"] if depth else [])
    kind = draw(st.sampled_from(kinds))
    terms = st.sampled_from(variables)
    if kind in ("p", "s"):
        return f"({kind} {draw(terms)})"
    if kind in ("q", "="):
        return f"({kind} {draw(terms)} {draw(terms)})"
    if kind in ("forall", "exists"):
        bound = f"?z{depth}"
        return f"({kind} ({bound} - half) {draw(conditions(depth - 1, (*variables, bound)))})"
    count = {"not": 1, "imply": 2}.get(kind) or draw(st.integers(1, 3))
    return f"({kind} {' '.join(draw(conditions(depth - 1, variables)) for _ in range(count))})"


atoms = st.sampled_from(
    [Atom(name, (each,)) for name in "ps" for each in NAMES] + [Atom("q", pair) for pair in product(NAMES, NAMES)]
)


@settings(max_examples=25)
@given(conditions(), conditions(depth=2, variables=(*VARIABLES, "?w")), st.frozensets(atoms))
def test_random_conditions_mean_what_they_mean_elsewhere(condition: str, when: str, initial: State) -> None:
    text = f"""(define (domain random) (:requirements :adl)
      (:types half other - object)
      (:predicates (p ?h - half) (s ?h - half) (q ?h - half ?i - half) (r ?h - half) (done))
      (:action always :parameters () :effect (done))
      (:action sometimes :parameters (?x - half ?y - half) :precondition {condition}
        :effect (and (p ?x) (not (q ?x ?y))))
      (:action partly :parameters (?x - half ?y - half)
        :effect (and (r ?y) (forall (?w - half) (when {when} (q ?w ?x))))))"""
    agree(text, dict.fromkeys(NAMES[:2], "half") | {"c": "other"}, _take_half(initial), limit=12)


def _take_half(initial: State) -> State:
    return frozenset(atom for atom in initial if "c" not in atom.args)


def test_too_many_actions_are_refused_at_once(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(grounding, "MAX_PARTS", 10_000)
    objects = dict.fromkeys(THIRTY, "object")
    many = " ".join(f"?x{number}" for number in range(20))
    for action in (
        f":parameters ({many})",
        f":precondition (exists ({many}) (p ?x0))",
        f":effect (forall ({many}) (p ?x0))",
    ):
        domain = read_domain(f"(define (domain d) (:predicates (p ?x)) (:action a {action}))", "d.pddl")
        with refusal(Code.TOO_LARGE):
            ground(domain, objects, frozenset())


def test_static_parts_keep_many_parameters_in_bounds() -> None:
    """Ten rooms in a row: only one of ten billion choices of ten rooms is a path."""
    rooms = [f"room_{number}" for number in range(10)]
    ways = frozenset(Atom("next", pair) for pair in pairwise(rooms))
    variables = [f"?r{number}" for number in range(10)]
    path = " ".join(f"(next {a} {b})" for a, b in pairwise(variables))
    text = f"""(define (domain d) (:predicates (next ?a ?b) (been ?a))
      (:action walk :parameters ({" ".join(variables)}) :precondition (and {path}) :effect (been {variables[-1]})))"""
    (action,) = ground(read_domain(text, "d.pddl"), dict.fromkeys(rooms, "object"), ways)
    assert action.action.args == tuple(rooms)
