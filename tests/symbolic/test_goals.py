"""Goals: how they are read, and which are refused."""

import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.core.types import Atom
from ictamp_drake.symbolic.goals import check_goal, parse_goal
from tests.refusals import refusal
from tests.symbolic.towers import state, tower_goal

BOXES, SUPPORTS = ("cyan", "red", "blue"), ("rack", "table")


def test_one_atom_is_a_goal() -> None:
    assert parse_goal("(on cyan rack)", BOXES, SUPPORTS) == {Atom("on", ("cyan", "rack"))}


def test_a_conjunction_may_be_spread_over_lines() -> None:
    text = "(and (on cyan rack) ; the lowest\n     ( on red cyan )\n(on blue red))"
    assert parse_goal(text, BOXES, SUPPORTS) == tower_goal(("rack", "cyan", "red", "blue"))


def test_several_boxes_may_go_to_one_support() -> None:
    assert len(parse_goal("(and (on cyan rack) (on red rack))", BOXES, SUPPORTS)) == 2


@pytest.mark.parametrize(
    ("text", "code", "value"),
    [
        ("", Code.NOT_PDDL, ""),
        ("on cyan rack", Code.NOT_PDDL, "on cyan rack"),
        ("(on cyan\nrack", Code.NOT_PDDL, "(on cyan rack"),
        ("(on cyan rack))", Code.NOT_PDDL, "(on cyan rack))"),
        ("(and)", Code.NOT_PDDL, "(and)"),
        ("(and cyan)", Code.NOT_PDDL, "cyan"),
        ("(not (on cyan rack))", Code.NOT_PDDL, "(not (on cyan rack))"),
        ("()", Code.UNKNOWN_CHOICE, ""),
        ("(clear cyan)", Code.UNKNOWN_CHOICE, "clear"),
        ("(on cyan)", Code.WRONG_LENGTH, "(on cyan)"),
        ("(lying cyan)", Code.WRONG_LENGTH, "(lying cyan)"),
        ("(on cian rack)", Code.UNKNOWN_CHOICE, "cian"),
        ("(on rack table)", Code.IMPOSSIBLE_GOAL, "(on rack table)"),
        ("(on cyan cyan)", Code.IMPOSSIBLE_GOAL, "(on cyan cyan)"),
        ("(and (on cyan rack) (on cyan red))", Code.IMPOSSIBLE_GOAL, "(on cyan rack) (on cyan red)"),
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
    with refusal(Code.UNKNOWN_CHOICE, choices=("on", "lying")):
        parse_goal("(clear cyan)", BOXES, SUPPORTS)


def test_a_goal_that_holds_already_is_a_goal() -> None:
    initial = state([("table", "cyan", "red"), ("rack", "blue")])
    check_goal(tower_goal(("table", "cyan", "red")), initial)
    check_goal(tower_goal(("rack", "cyan", "red")), initial)


def test_a_tipped_box_cannot_stand_but_can_carry() -> None:
    initial = state([("table", "cyan"), ("table", "red")], tipped=("red",))
    with refusal(Code.IMPOSSIBLE_GOAL, "goal", value="(on red cyan)"):
        check_goal(tower_goal(("rack", "cyan", "red")), initial)
    check_goal(frozenset({Atom("on", ("cyan", "red"))}), initial)


def test_a_tipped_box_can_lie_in_a_goal_and_an_upright_one_cannot() -> None:
    initial = state([("table", "cyan"), ("table", "red")], tipped=("red",))
    goal = parse_goal("(and (on cyan rack) (lying red cyan))", BOXES, SUPPORTS)
    assert goal == {Atom("on", ("cyan", "rack")), Atom("lying", ("red", "cyan"))}
    check_goal(goal, initial)
    with refusal(Code.IMPOSSIBLE_GOAL, "goal", value="(lying cyan rack)"):
        check_goal(frozenset({Atom("lying", ("cyan", "rack"))}), initial)
