"""Names of the predicates of `domain.pddl`, and queries of a state.

H must emit complete states. A complete state contains
- for each box that is not held, either on(box, x) or lying(box, x), where x is the box or support that it rests on,
- for each box, also a held one, either upright(box) or tipped(box): on goes with upright, and lying with tipped,
- clear(box) for each box that is not held and has nothing on top; clear does not apply to supports,
- in-hand(box) for the held box, or hand-empty() when there is none.

A search for plans that get boxes out of the way adds moved(box) to its own states. Plans do not contain this atom.
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
    """Map each box to what it rests on, standing or lying. The held box is absent."""
    return {atom.args[0]: atom.args[1] for atom in state if atom.predicate in (ON, LYING)}


def objects_beneath(box: str, supporter: Mapping[str, str]) -> Iterator[str]:
    """Yield everything beneath the box, from top to bottom, down to the support."""
    while box in supporter:
        box = supporter[box]
        yield box


def held_box(state: State) -> str | None:
    """Return the box in the hand, or None."""
    return next((atom.args[0] for atom in state if atom.predicate == IN_HAND), None)


def tipped_boxes(state: State) -> frozenset[str]:
    """Return the boxes that are not upright."""
    return frozenset(atom.args[0] for atom in state if atom.predicate == TIPPED)
