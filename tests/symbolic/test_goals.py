"""Goals: how they are read, and an error for each possible mistake."""

import pytest

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.types import Atom
from ictamp_drake.symbolic.goals import check_goal, parse_goal
from tests.symbolic.towers import state, tower_goal

BOXES, SUPPORTS = ("cyan", "red", "blue"), ("rack", "table")
FORM = "a goal is (on BOX OBJECT) or (and (on BOX OBJECT) (on BOX OBJECT) ...), with lying for on if BOX is tipped."


def test_one_atom_is_a_goal() -> None:
    assert parse_goal("(on cyan rack)", BOXES, SUPPORTS) == {Atom("on", ("cyan", "rack"))}


def test_a_conjunction_may_be_spread_over_lines() -> None:
    text = "(and (on cyan rack) ; the lowest\n     ( on red cyan )\n(on blue red))"
    assert parse_goal(text, BOXES, SUPPORTS) == tower_goal(("rack", "cyan", "red", "blue"))


def test_several_boxes_may_go_to_one_support() -> None:
    assert len(parse_goal("(and (on cyan rack) (on red rack))", BOXES, SUPPORTS)) == 2


@pytest.mark.parametrize(
    ("text", "sentence"),
    [
        ("", f'cannot read "", line 1: expected "(", not the end of the text; {FORM}'),
        ("on cyan rack", f'cannot read "on cyan rack", line 1: expected "(", not "on"; {FORM}'),
        (
            "(on cyan\nrack",
            'cannot read "(on cyan rack", line 2: expected ")" for the "(" of line 1, not the end of the text; ' + FORM,
        ),
        (
            "(on cyan rack))",
            f'cannot read "(on cyan rack))", line 1: expected the end of the text, not ")"; {FORM}',
        ),
        ("(and)", f"(and) is empty; {FORM}"),
        ("(and cyan)", f"cyan is not an atom; {FORM}"),
        ("(not (on cyan rack))", f"(not (on cyan rack)) is not an atom; {FORM}"),
        ("()", f'predicate "" in () is neither "on" nor "lying"; {FORM}'),
        ("(clear cyan)", f'predicate "clear" in (clear cyan) is neither "on" nor "lying"; {FORM}'),
        ("(on cyan)", f'"on" takes 2 objects, not 1 as in (on cyan); {FORM}'),
        ("(lying cyan)", f'"lying" takes 2 objects, not 1 as in (lying cyan); {FORM}'),
        (
            "(on cian rack)",
            'object "cian" in (on cian rack) is not in the scene; '
            "the boxes are cyan, red, blue, the supports rack, table.",
        ),
        (
            "(on rack table)",
            "(on rack table) cannot be reached, rack is a support and cannot be moved; the boxes are cyan, red, blue.",
        ),
        ("(on cyan cyan)", "(on cyan cyan) puts cyan on itself."),
        ("(and (on cyan rack) (on cyan red))", "(on cyan rack) (on cyan red) puts cyan in more than one place."),
        (
            "(and (on cyan rack) (lying cyan rack))",
            "(lying cyan rack) (on cyan rack) puts cyan in more than one place.",
        ),
        ("(and (on cyan red) (on blue red))", "(on blue red) (on cyan red) puts more than one box on the box red."),
        ("(and (on cyan red) (on red cyan))", "the boxes cyan, red are to stand on each other in a circle."),
        (
            "(and (on cyan red) (on red blue) (on blue cyan))",
            "the boxes blue, cyan, red are to stand on each other in a circle.",
        ),
    ],
)
def test_a_wrong_goal_gets_a_sentence(text: str, sentence: str) -> None:
    with pytest.raises(IctampError) as caught:
        parse_goal(text, BOXES, SUPPORTS, where="scene.yaml: goal")
    assert str(caught.value) == f"scene.yaml: goal: {sentence}"


def test_a_goal_that_holds_already_is_refused() -> None:
    initial = state([("table", "cyan", "red"), ("rack", "blue")])
    with pytest.raises(IctampError) as caught:
        check_goal(tower_goal(("table", "cyan", "red")), initial)
    holds = "(on cyan table) (on red cyan) already holds in the initial state"
    assert str(caught.value) == f"goal: {holds}, there is nothing to plan."
    check_goal(tower_goal(("rack", "cyan", "red")), initial)


def test_a_tipped_box_cannot_stand_but_can_carry() -> None:
    initial = state([("table", "cyan"), ("table", "red")], tipped=("red",))
    with pytest.raises(IctampError) as caught:
        check_goal(tower_goal(("rack", "cyan", "red")), initial)
    why = "red is tipped over in the initial state and no skill stands a box up"
    assert str(caught.value) == f"goal: (on red cyan) cannot be reached, {why}."
    check_goal(frozenset({Atom("on", ("cyan", "red"))}), initial)


def test_a_tipped_box_can_lie_in_a_goal_and_an_upright_one_cannot() -> None:
    initial = state([("table", "cyan"), ("table", "red")], tipped=("red",))
    goal = parse_goal("(and (on cyan rack) (lying red cyan))", BOXES, SUPPORTS)
    assert goal == {Atom("on", ("cyan", "rack")), Atom("lying", ("red", "cyan"))}
    check_goal(goal, initial)
    with pytest.raises(IctampError) as caught:
        check_goal(frozenset({Atom("lying", ("cyan", "rack"))}), initial)
    why = "cyan is upright in the initial state and no skill tips a box over"
    assert str(caught.value) == f"goal: (lying cyan rack) cannot be reached, {why}."
