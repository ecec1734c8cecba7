"""Goals written by a user: PDDL text to atoms, and all checks of a goal before planning starts."""

from collections.abc import Iterable, Iterator, Sequence

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import Atom, State
from ictamp_drake.symbolic.atoms import LYING, ON, tipped_boxes
from ictamp_drake.symbolic.expressions import Expression, Group, quote_expression, read

_FORM = "write (on BOX OBJECT) or (and (on BOX OBJECT) ...), with lying for on if BOX is tipped over"
_FIELD = "goal"


def parse_goal(text: str, boxes: Sequence[str], supports: Sequence[str]) -> frozenset[Atom]:
    """The atoms of a conjunction of (on BOX OBJECT) and, for boxes on their side, (lying BOX OBJECT).

    Raises:
        IctampError: Syntax, an unknown predicate or object, a wrong number of objects, or atoms that cannot hold
            together.
    """
    goal = frozenset(_atom(literal, boxes, supports) for literal in _literals(text))
    for atoms, contradiction in _contradictions(goal, boxes):
        raise IctampError(Code.IMPOSSIBLE_GOAL, contradiction, field=_FIELD, value=atoms)
    return goal


def check_goal(goal: frozenset[Atom], initial: State) -> None:
    """Refuse a goal that no plan can reach from the initial state. One that holds already is reached by no action.

    Raises:
        IctampError: The goal asks for a tipped box to be upright or an upright box to be tipped.
    """
    for atom in sorted(goal):
        tipped = atom.args[0] in tipped_boxes(initial)
        if tipped != (atom.predicate == LYING):
            posture, change = ("tipped over", "stands a box up") if tipped else ("upright", "tips a box over")
            problem = f"{{value}} cannot be reached: {atom.args[0]} is {posture} at the start, and no skill {change}"
            raise IctampError(Code.IMPOSSIBLE_GOAL, problem, field=_FIELD, value=_pddl(atom))


def _literals(text: str) -> Sequence[Expression]:
    try:
        formula = read(text)
    except IctampError as error:
        quoted = quote_expression(text)
        raise _not_a_goal(f"cannot read {{value}}: {error}", quoted) from error
    literals = formula.items[1:] if formula.items[:1] == ("and",) else (formula,)
    if not literals:
        raise _not_a_goal("expected atoms, got {value}", text)
    return literals


def _atom(literal: Expression, boxes: Sequence[str], supports: Sequence[str]) -> Atom:
    written = quote_expression(literal)
    words = [word for word in literal.items if isinstance(word, str)] if isinstance(literal, Group) else []
    if not isinstance(literal, Group) or len(words) < len(literal.items):
        raise _not_a_goal("expected an atom, got {value}", written)
    predicate, *names = words or [""]
    if predicate not in (ON, LYING):
        problem = f"unknown predicate {{value}} in {written}"
        raise IctampError(Code.UNKNOWN_CHOICE, problem, field=_FIELD, value=predicate, choices=(ON, LYING))
    if len(names) != 2:
        problem = f"expected two objects after {predicate}, got {{value}}"
        raise IctampError(Code.WRONG_LENGTH, problem, field=_FIELD, value=written)
    for name in names:
        if name not in (*boxes, *supports):
            problem = f"unknown object {{value}} in {written}"
            raise IctampError(Code.UNKNOWN_CHOICE, problem, field=_FIELD, value=name, choices=(*boxes, *supports))
    if names[0] not in boxes:
        problem = f"{{value}} cannot be reached: {names[0]} is a support, which cannot be moved"
        raise IctampError(Code.IMPOSSIBLE_GOAL, problem, field=_FIELD, value=written, choices=boxes)
    return Atom(predicate, (names[0], names[1]))


def _not_a_goal(problem: str, found: str) -> IctampError:
    return IctampError(Code.NOT_PDDL, problem, field=_FIELD, value=found, advice=_FORM)


def _contradictions(goal: frozenset[Atom], boxes: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Atoms, or boxes, that cannot hold or be there together, and why."""
    for atom in sorted(goal):
        if atom.args[0] == atom.args[1]:
            yield _pddl(atom), f"{{value}} puts {atom.args[0]} on itself"
    for box, atoms in _group_shared(goal, 0):
        yield _text(atoms), f"{{value}} puts {box} in more than one place"
    for below, atoms in _group_shared(goal, 1):
        if below in boxes:
            yield _text(atoms), f"{{value}} puts more than one box on {below}"
    for circle in _circles({atom.args[0]: atom.args[1] for atom in goal}):
        yield ", ".join(circle), "the boxes {value} stand on each other in a circle"


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
