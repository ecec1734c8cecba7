"""Each verdict, from an outcome made by hand."""

import numpy as np
import pytest

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Atom, Configuration, Recording, State
from ictamp_drake.skills.judge import judge
from ictamp_drake.world.outcome import Outcome

C = Configuration(np.zeros(7), np.zeros(2), {})
PICK, PLACE = Action("pick", ("red", "table")), Action("place", ("red", "rack"))


def outcome(*, settled: bool = True, stopped_after: str | None = None) -> Outcome:
    """An unrecorded outcome of a simulation."""
    recording = Recording(np.zeros(1), np.zeros((1, 0)))
    return Outcome(C, settled and stopped_after is None, stopped_after, (), recording)


def state(*atoms: str) -> State:
    """Atoms written as on(a,b)."""
    parts = (atom.rstrip(")").split("(") for atom in atoms)
    return frozenset(Atom(name, tuple(args.split(",")) if args else ()) for name, args in parts)


PICKED = state("in-hand(red)", "upright(red)", "on(blue,table)", "upright(blue)", "clear(blue)")
PLACED = state("hand-empty()", "on(red,rack)", "upright(red)", "clear(red)", "on(blue,table)", "upright(blue)")
STILL_THERE = state(
    "hand-empty()", "on(red,table)", "upright(red)", "clear(red)", "on(blue,table)", "upright(blue)", "clear(blue)"
)


@pytest.mark.parametrize(
    ("reached", "promised", "action", "ended", "failure"),
    [
        (PICKED, PICKED, PICK, outcome(), None),
        (PLACED, PLACED, PLACE, outcome(), None),
        (PICKED, PICKED, PICK, outcome(settled=False), Failure.NOT_SETTLED),
        (PICKED, PICKED, PICK, outcome(stopped_after="grasp"), Failure.NOT_GRASPED),
        (PICKED, PICKED, PICK, outcome(stopped_after="lift"), Failure.SLIPPED),
        (PLACED, PLACED, PLACE, outcome(stopped_after="transfer"), Failure.SLIPPED),
        (STILL_THERE, PICKED, PICK, outcome(), Failure.SLIPPED),
        (
            PICKED - state("on(blue,table)") | state("lying(blue,table)"),
            PICKED,
            PICK,
            outcome(),
            Failure.OTHER_MOVED,
        ),
        (PICKED - state("on(blue,table)"), PICKED, PICK, outcome(), Failure.OTHER_MOVED),
        (
            STILL_THERE - state("on(red,table)", "upright(red)") | state("lying(red,table)", "tipped(red)"),
            PICKED,
            PICK,
            outcome(),
            Failure.TOPPLED,
        ),
        (
            PLACED - state("on(red,rack)", "upright(red)") | state("lying(red,rack)", "tipped(red)"),
            PLACED,
            PLACE,
            outcome(),
            Failure.TOPPLED,
        ),
        (PLACED - state("on(red,rack)") | state("on(red,table)"), PLACED, PLACE, outcome(), Failure.WRONG_STATE),
        (PLACED - state("on(red,rack)"), PLACED, PLACE, outcome(), Failure.WRONG_STATE),
        (PICKED | state("clear(table)"), PICKED, PICK, outcome(), Failure.WRONG_STATE),
    ],
)
def test_verdict(reached: State, promised: State, action: Action, ended: Outcome, failure: Failure | None) -> None:
    verdict, detail = judge(reached, promised, action, ended)
    assert verdict is failure
    if reached != promised:
        for atom in promised - reached:
            assert str(atom) in detail.split("unexpected")[0]
        for atom in reached - promised:
            assert str(atom) in detail.split("unexpected")[1]
    elif failure is None:
        assert detail == ""


def test_an_empty_grasp_names_the_box() -> None:
    assert "red" in judge(STILL_THERE, PICKED, PICK, outcome(stopped_after="grasp"))[1]
