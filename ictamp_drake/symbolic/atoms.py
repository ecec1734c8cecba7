"""Names of the predicates of `domain.pddl`, and what can be read off a state.

A complete state, as H must emit it, holds
- for each box that is not held either on(box, x) or lying(box, x), where x is the box or support that it rests on,
- for each box either upright(box) or tipped(box), the held one included: on goes with upright, lying with tipped,
- clear(box) for each box that is not held and on which nothing rests; clear says nothing about supports,
- in-hand(box) for the held box, or hand-empty() when there is none.

A search for plans that get boxes out of the way adds moved(box) to its own states, which no plan shows.
"""

from collections.abc import Iterator, Mapping

from ictamp_drake.core.types import State

ON = "on"
LYING = "lying"
IN_HAND = "in-hand"
CLEAR = "clear"
HAND_EMPTY = "hand-empty"
UPRIGHT = "upright"
TIPPED = "tipped"
MOVED = "moved"


def supporters(state: State) -> dict[str, str]:
    """What each box rests on, standing or lying; the held box is absent."""
    return {atom.args[0]: atom.args[1] for atom in state if atom.predicate in (ON, LYING)}


def objects_beneath(box: str, supporter: Mapping[str, str]) -> Iterator[str]:
    """What is beneath the box, down to the support."""
    while box in supporter:
        box = supporter[box]
        yield box


def held_box(state: State) -> str | None:
    """The box in the hand."""
    return next((atom.args[0] for atom in state if atom.predicate == IN_HAND), None)


def tipped_boxes(state: State) -> frozenset[str]:
    """The boxes that are not upright."""
    return frozenset(atom.args[0] for atom in state if atom.predicate == TIPPED)
