"""Goals written by a user: PDDL text to atoms, and all checks of a goal before planning starts."""

from collections.abc import Iterable, Iterator, Sequence

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.types import Atom, State
from ictamp_drake.symbolic.atoms import LYING, ON, tipped_boxes
from ictamp_drake.symbolic.expressions import Expression, Group, quote_expression, read

_FORM = "a goal is (on BOX OBJECT) or (and (on BOX OBJECT) (on BOX OBJECT) ...), with lying for on if BOX is tipped"


def parse_goal(text: str, boxes: Sequence[str], supports: Sequence[str], where: str = "goal") -> frozenset[Atom]:
    """Parse a conjunction of (on BOX OBJECT) and, for boxes on their side, (lying BOX OBJECT) into atoms.

    Raises:
        IctampError: The syntax is wrong, a predicate or object is unknown, the number of objects is wrong, or the atoms
            cannot hold together. The message begins with `where`, e.g. "scene.yaml: goal".
    """
    goal = frozenset(_atom(literal, boxes, supports, where) for literal in _literals(text, where))
    for contradiction in _contradictions(goal, boxes):
        raise IctampError(f"{where}: {contradiction}.")
    return goal


def check_goal(goal: frozenset[Atom], initial: State, where: str = "goal") -> None:
    """Refuse a goal that needs no plan or that no plan can reach from the initial state.

    Raises:
        IctampError: The goal already holds, or it asks for a tipped box to be upright or an upright box to be tipped.
    """
    if goal <= initial:
        raise IctampError(f"{where}: {_text(goal)} already holds in the initial state, there is nothing to plan.")
    for atom in sorted(goal):
        tipped = atom.args[0] in tipped_boxes(initial)
        if tipped != (atom.predicate == LYING):
            posture, change = ("tipped over", "stands a box up") if tipped else ("upright", "tips a box over")
            why = f"{atom.args[0]} is {posture} in the initial state and no skill {change}"
            raise IctampError(f"{where}: {_pddl(atom)} cannot be reached, {why}.")


def _literals(text: str, where: str) -> Sequence[Expression]:
    try:
        formula = read(text)
    except IctampError as error:
        raise IctampError(f'{where}: cannot read "{quote_expression(text)}", {error}; {_FORM}.') from error
    literals = formula.items[1:] if formula.items[:1] == ("and",) else (formula,)
    if not literals:
        raise IctampError(f"{where}: (and) is empty; {_FORM}.")
    return literals


def _atom(literal: Expression, boxes: Sequence[str], supports: Sequence[str], where: str) -> Atom:
    written = quote_expression(literal)
    words = [word for word in literal.items if isinstance(word, str)] if isinstance(literal, Group) else []
    if not isinstance(literal, Group) or len(words) < len(literal.items):
        raise IctampError(f"{where}: {written} is not an atom; {_FORM}.")
    predicate, *names = words or [""]
    if predicate not in (ON, LYING):
        raise IctampError(f'{where}: predicate "{predicate}" in {written} is neither "on" nor "lying"; {_FORM}.')
    if len(names) != 2:
        raise IctampError(f'{where}: "{predicate}" takes 2 objects, not {len(names)} as in {written}; {_FORM}.')
    for name in names:
        if name not in (*boxes, *supports):
            known = f"the boxes are {', '.join(boxes)}, the supports {', '.join(supports)}"
            raise IctampError(f'{where}: object "{name}" in {written} is not in the scene; {known}.')
    if names[0] not in boxes:
        what = f"{names[0]} is a support and cannot be moved; the boxes are {', '.join(boxes)}"
        raise IctampError(f"{where}: {written} cannot be reached, {what}.")
    return Atom(predicate, (names[0], names[1]))


def _contradictions(goal: frozenset[Atom], boxes: Sequence[str]) -> Iterator[str]:
    for atom in sorted(goal):
        if atom.args[0] == atom.args[1]:
            yield f"{_pddl(atom)} puts {atom.args[0]} on itself"
    for box, atoms in _group_shared(goal, 0):
        yield f"{_text(atoms)} puts {box} in more than one place"
    for below, atoms in _group_shared(goal, 1):
        if below in boxes:
            yield f"{_text(atoms)} puts more than one box on the box {below}"
    for circle in _circles({atom.args[0]: atom.args[1] for atom in goal}):
        yield f"the boxes {', '.join(circle)} are to stand on each other in a circle"


def _group_shared(goal: frozenset[Atom], position: int) -> Iterator[tuple[str, list[Atom]]]:
    """Yield each object that several atoms have at the position, with these atoms."""
    by_object: dict[str, list[Atom]] = {}
    for atom in sorted(goal):
        by_object.setdefault(atom.args[position], []).append(atom)
    return ((name, atoms) for name, atoms in by_object.items() if len(atoms) > 1)


def _circles(below: dict[str, str]) -> Iterator[list[str]]:
    for box in sorted(below):
        tower = [box]
        while below.get(tower[-1], box) not in tower:
            tower.append(below[tower[-1]])
        if below.get(tower[-1]) == box:
            yield tower


def _pddl(atom: Atom) -> str:
    return f"({' '.join((atom.predicate, *atom.args))})"


def _text(atoms: Iterable[Atom]) -> str:
    return " ".join(_pddl(atom) for atom in sorted(atoms))
