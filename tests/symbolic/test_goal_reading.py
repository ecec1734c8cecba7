"""Goals: how they are read, and which are refused."""

from collections.abc import Sequence

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import Action, Atom, State
from ictamp_drake.symbolic.context import GeneratorContext
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.symbolic.expressions import Expression, Group, read
from ictamp_drake.symbolic.goal import MAX_ALTERNATIVES, Goal
from ictamp_drake.symbolic.goal_reading import check_goal, parse_goal
from ictamp_drake.symbolic.grounding import expand
from ictamp_drake.symbolic.pddl import FormulaReader, boxes_domain
from ictamp_drake.symbolic.skeletons import BreadthFirst
from tests.refusals import refusal
from tests.symbolic.towers import Problem, formulas, problems, reachable, state, tower_goal

BOXES, SUPPORTS = ("cyan", "red", "blue"), ("rack", "table")

CHOICES = ("on", "lying", "in-hand", "clear", "hand-empty", "upright", "tipped", "at")
CHOICES += ("and", "or", "not", "imply", "exists", "forall", "=")


def test_one_atom_is_a_goal() -> None:
    assert parse_goal("(on cyan rack)", BOXES, SUPPORTS) == Goal.of({Atom("on", ("cyan", "rack"))})


def test_a_conjunction_may_be_spread_over_lines() -> None:
    text = "(and (on cyan rack) ; the lowest\n     ( on red cyan )\n(on blue red))"
    assert parse_goal(text, BOXES, SUPPORTS) == tower_goal(("rack", "cyan", "red", "blue"))


def test_several_boxes_may_go_to_one_support() -> None:
    assert len(parse_goal("(and (on cyan rack) (on red rack))", BOXES, SUPPORTS).mentioned) == 2


@pytest.mark.parametrize(
    ("text", "code", "value"),
    [
        ("", Code.NOT_PDDL, ""),
        ("on cyan rack", Code.NOT_PDDL, "on cyan rack"),
        ("(on cyan\nrack", Code.NOT_PDDL, "(on cyan rack"),
        ("(on cyan rack))", Code.NOT_PDDL, "(on cyan rack))"),
        ("(and)", Code.NOT_PDDL, "(and)"),
        ("(and cyan)", Code.NOT_PDDL, "cyan"),
        ("()", Code.NOT_PDDL, "()"),
        ("(free cyan)", Code.UNKNOWN_CHOICE, "free"),
        ("(when (clear cyan) (on cyan rack))", Code.UNKNOWN_CHOICE, "when"),
        ("(or (clear red) (preference p (on cyan rack)))", Code.UNKNOWN_CHOICE, "preference"),
        ("(on (red) (cyan))", Code.NOT_PDDL, "(red)"),
        ("((on red cyan))", Code.NOT_PDDL, "((on red cyan))"),
        ("(not (on cyan rack) (on red rack))", Code.NOT_PDDL, "(not (on cyan rack) (on red rack))"),
        ("(exists (?x - crate) (on ?x rack))", Code.NOT_PDDL, "crate"),
        ("(exists (?x - thing) (on ?x rack))", Code.NOT_PDDL, "(on ?x rack)"),
        ("(exists (?x - box) (on ?y rack))", Code.UNKNOWN_CHOICE, "?y"),
        ("(on cyan)", Code.WRONG_LENGTH, "(on cyan)"),
        ("(lying cyan)", Code.WRONG_LENGTH, "(lying cyan)"),
        ("(on cian rack)", Code.UNKNOWN_CHOICE, "cian"),
        ("(on rack table)", Code.IMPOSSIBLE_GOAL, "(on rack table)"),
        ("(on cyan cyan)", Code.IMPOSSIBLE_GOAL, "(on cyan cyan)"),
        ("(and (on cyan rack) (on cyan red))", Code.IMPOSSIBLE_GOAL, "(on cyan rack) (on cyan red)"),
        ("(and (on cyan rack) (in-hand cyan))", Code.IMPOSSIBLE_GOAL, "(in-hand cyan) (on cyan rack)"),
        ("(and (in-hand red) (in-hand cyan))", Code.IMPOSSIBLE_GOAL, "(in-hand cyan) (in-hand red)"),
        ("(and (clear red) (on cyan red))", Code.IMPOSSIBLE_GOAL, "(clear red) (on cyan red)"),
        ("(and (on cyan red) (not (on cyan red)))", Code.IMPOSSIBLE_GOAL, "(on cyan red) (not (on cyan red))"),
        ("(or (on cyan cyan) (on red red))", Code.IMPOSSIBLE_GOAL, "(on cyan cyan)"),
        (
            "(and (or (on cyan rack) (on cyan table)) (forall (?x - support) (not (on cyan ?x))))",
            Code.IMPOSSIBLE_GOAL,
            "(on cyan rack) (on cyan table)",
        ),
        (
            "(exists (?x - box) (and (= ?x cyan) (= ?x red) (on ?x rack)))",
            Code.IMPOSSIBLE_GOAL,
            "(exists (?x - box) (and (= ?x cyan) (= ?x red) (on ?x rack)))",
        ),
        ("(exists (?a ?b ?c ?d ?e ?f ?g ?h ?i ?j ?k - box) (and (on ?a rack) (on ?b rack)))", Code.TOO_LARGE, None),
        ("(and (on cyan rack) (lying cyan rack))", Code.IMPOSSIBLE_GOAL, "(lying cyan rack) (on cyan rack)"),
        ("(and (on cyan red) (on blue red))", Code.IMPOSSIBLE_GOAL, "(on blue red) (on cyan red)"),
        ("(and (on cyan red) (on red cyan))", Code.IMPOSSIBLE_GOAL, "cyan, red"),
        ("(and (on cyan red) (on red blue) (on blue cyan))", Code.IMPOSSIBLE_GOAL, "blue, cyan, red"),
    ],
)
def test_a_wrong_goal_is_refused(text: str, code: Code, value: str) -> None:
    with refusal(code, "goal", value=value):
        parse_goal(text, BOXES, SUPPORTS)


def test_what_is_not_in_the_scene_is_answered_with_what_is() -> None:
    with refusal(Code.UNKNOWN_CHOICE, choices=(*BOXES, *SUPPORTS)):
        parse_goal("(on cian rack)", BOXES, SUPPORTS)
    with refusal(Code.UNKNOWN_CHOICE, choices=CHOICES):
        parse_goal("(free cyan)", BOXES, SUPPORTS)


def test_a_goal_that_holds_already_is_a_goal() -> None:
    initial = state([("table", "cyan", "red"), ("rack", "blue")])
    check_goal(tower_goal(("table", "cyan", "red")), initial)
    check_goal(tower_goal(("rack", "cyan", "red")), initial)


def test_a_tipped_box_cannot_stand_but_can_carry() -> None:
    initial = state([("table", "cyan"), ("table", "red")], tipped=("red",))
    with refusal(Code.IMPOSSIBLE_GOAL, "goal", value="(on red cyan)"):
        check_goal(tower_goal(("rack", "cyan", "red")), initial)
    check_goal(Goal.of({Atom("on", ("cyan", "red"))}), initial)


def test_a_tipped_box_can_lie_in_a_goal_and_an_upright_one_cannot() -> None:
    initial = state([("table", "cyan"), ("table", "red")], tipped=("red",))
    goal = parse_goal("(and (on cyan rack) (lying red cyan))", BOXES, SUPPORTS)
    assert goal == Goal.of({Atom("on", ("cyan", "rack")), Atom("lying", ("red", "cyan"))})
    check_goal(goal, initial)
    with refusal(Code.IMPOSSIBLE_GOAL, "goal", value="(lying cyan rack)"):
        check_goal(Goal.of({Atom("lying", ("cyan", "rack"))}), initial)


def test_alternatives_that_cannot_be_reached_are_left_out() -> None:
    initial = state([("table", "cyan"), ("table", "red")], tipped=("red",))
    goal = parse_goal("(or (on red cyan) (on cyan red) (on blue blue))", BOXES, SUPPORTS)
    assert check_goal(goal, initial) == Goal.of({Atom("on", ("cyan", "red"))})
    for text in ("(or (on red cyan) (and (on red rack) (clear cyan)))", "(not (tipped red))", "(upright red)"):
        with refusal(Code.IMPOSSIBLE_GOAL, "goal"):
            check_goal(parse_goal(text, BOXES, SUPPORTS), initial)


def test_places_of_one_box_are_one_alternative() -> None:
    """Otherwise a goal about several boxes with several places each has a great many."""
    text = "(forall (?x - box) (exists (?y - support) (on ?x ?y)))"
    (alternative,) = parse_goal(text, BOXES, SUPPORTS).alternatives
    assert len(alternative.either) == len(BOXES)


def test_too_many_alternatives_are_refused() -> None:
    boxes = [f"box_{number}" for number in range(11)]
    text = "(and {})".format(" ".join(f"(or (clear {box}) (in-hand {box}))" for box in boxes))
    with refusal(Code.TOO_LARGE, "goal"):
        parse_goal(text, boxes, SUPPORTS)
    assert len(parse_goal("(exists (?x ?y - box) (on ?x ?y))", boxes, SUPPORTS).alternatives) <= MAX_ALTERNATIVES


def evaluate(written: Expression, atoms: State, values: dict[str, str]) -> bool:
    """Whether a formula holds, straight from its text."""
    assert isinstance(written, Group)
    word, *rest = written.items
    if word in ("exists", "forall"):
        (variable, _, kind), body = rest[0].items, rest[1]
        objects = {"box": BOXES, "support": SUPPORTS}.get(kind, (*BOXES, *SUPPORTS))
        found = [evaluate(body, atoms, {**values, variable: each}) for each in objects]
        return any(found) if word == "exists" else all(found)
    if word in ("and", "or", "not", "imply"):
        parts = [evaluate(part, atoms, values) for part in rest]
        return {"and": all(parts), "or": any(parts), "not": not parts[0], "imply": not parts[0] or parts[-1]}[word]
    terms = tuple(values.get(term, term) for term in rest)
    return terms[0] == terms[1] if word == "=" else Atom(str(word), terms) in atoms


STATES = st.frozensets(
    st.builds(
        lambda predicate, box, thing: Atom(
            predicate, {"hand-empty": (), "on": (box, thing), "lying": (box, thing)}.get(predicate, (box,))
        ),
        st.sampled_from(["on", "on", "lying", "clear", "in-hand", "hand-empty"]),
        st.sampled_from(BOXES),
        st.sampled_from([*BOXES, *SUPPORTS]),
    )
)
"""Sets of atoms, most of which no scene can be in."""


def goal_of(text: str, boxes: Sequence[str], supports: Sequence[str]) -> Goal:
    """The goal before any of its alternatives is left out."""
    written, domain = read(text), boxes_domain()
    objects = {**dict.fromkeys(boxes, "box"), **dict.fromkeys(supports, "support")}
    formula = FormulaReader(domain.types, objects, domain.predicates).formula(written, {}, written)
    try:
        return Goal.from_formula(expand(formula, domain, objects))
    except IctampError as error:
        assume(error.code is not Code.TOO_LARGE)
        raise


@given(formulas(BOXES, SUPPORTS), st.lists(STATES, min_size=1, max_size=20))
def test_a_goal_holds_where_its_formula_does(text: str, states: list[State]) -> None:
    goal = goal_of(text, BOXES, SUPPORTS)
    for atoms in states:
        assert goal.holds(atoms) == evaluate(read(text), atoms, {})


@given(st.data(), problems())
def test_alternatives_left_out_hold_in_no_state_that_can_be_reached(data: st.DataObject, problem: Problem) -> None:
    text = data.draw(formulas(problem.boxes, problem.supports, depth=2))
    try:
        kept = check_goal(parse_goal(text, problem.boxes, problem.supports), problem.initial)
    except IctampError as error:
        assume(error.code is Code.IMPOSSIBLE_GOAL)
        kept = Goal(())
    goal = goal_of(text, problem.boxes, problem.supports)
    for s in reachable(problem.domain, problem.initial):
        assert kept.holds(s) == goal.holds(s)


KINDS = {"near": "region", "far": "region", "spot": "pose"}
SUPPORT_OF = {"near": "table", "far": "rack", "spot": "table"}


def read_goal(text: str) -> Goal:
    return parse_goal(text, BOXES, SUPPORTS, KINDS, SUPPORT_OF)


def test_a_box_on_a_support_may_be_in_any_region_of_it() -> None:
    goal = read_goal("(on cyan table)")
    assert [goal.holds(frozenset({Atom("on", ("cyan", where))})) for where in ("table", "near", "spot")] == [True] * 3
    assert not goal.holds(frozenset({Atom("on", ("cyan", "far"))}))
    assert not read_goal("(not (on cyan table))").holds(frozenset({Atom("on", ("cyan", "near"))}))
    assert read_goal("(on cyan near)") == Goal.of({Atom("on", ("cyan", "near"))})


def test_a_box_at_a_pose_is_upright_or_tipped_over() -> None:
    goal = read_goal("(exists (?x - pose) (at cyan ?x))")
    assert [goal.holds(frozenset({Atom(word, ("cyan", "spot"))})) for word in ("on", "lying")] == [True, True]
    assert read_goal("(exists (?x - region) (on cyan ?x))").mentioned == {
        Atom("on", ("cyan", where)) for where in ("near", "far")
    }


@pytest.mark.parametrize(
    ("text", "code", "value"),
    [
        ("(at cyan table)", Code.NOT_PDDL, "(at cyan table)"),
        ("(at cyan near)", Code.NOT_PDDL, "(at cyan near)"),
        ("(at spot cyan)", Code.IMPOSSIBLE_GOAL, "(at spot cyan)"),
        ("(and (on cyan near) (on cyan far))", Code.IMPOSSIBLE_GOAL, "(on cyan far) (on cyan near)"),
        ("(and (on cyan near) (on cyan rack))", Code.IMPOSSIBLE_GOAL, "cyan"),
        ("(and (at cyan spot) (at red spot))", Code.IMPOSSIBLE_GOAL, "spot"),
    ],
)
def test_a_wrong_goal_about_regions_is_refused(text: str, code: Code, value: str) -> None:
    with refusal(code, "goal", value=value):
        read_goal(text)


def test_a_pose_has_room_for_one_box() -> None:
    initial = state([("table", "cyan"), ("spot", "red"), ("table", "blue")])
    domain = Domain.create(BOXES, ("table", "near", "spot"), initial, {"near": "region", "spot": "pose"})
    held = domain.successor(initial, Action("pick", ("cyan", "table")))
    places = {action.args[1] for action, _ in domain.successors(held)}
    assert places == {"table", "near", "red", "blue"}
    plan = BreadthFirst().create(GeneratorContext(domain, initial, read_goal("(at cyan spot)"))).next_plan(1000)
    assert plan is not None
    assert plan.actions[0] == Action("pick", ("red", "spot"))
    assert len(plan) == 4
