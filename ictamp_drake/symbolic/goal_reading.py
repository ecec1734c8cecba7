"""Reader of goals: PDDL text to a `Goal`, and all checks of a goal before planning starts."""

from collections.abc import Iterable, Iterator, Mapping, Sequence

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import Atom, State
from ictamp_drake.symbolic.atoms import CLEAR, HAND_EMPTY, IN_HAND, LYING, ON, TIPPED, UPRIGHT, tipped_boxes
from ictamp_drake.symbolic.expressions import Group, quote_expression, read
from ictamp_drake.symbolic.formulas import And, Formula, Not, Or, disjuncts, leaves, negation
from ictamp_drake.symbolic.goal import Alternative, Goal
from ictamp_drake.symbolic.grounding import expand
from ictamp_drake.symbolic.pddl import FormulaReader, Scope, boxes_domain

_FORM = "write e.g. (on BOX OBJECT), lying for on if BOX is tipped over, and join atoms by and, or, not, exists, forall"
_FIELD = "goal"
_AT = "at"
_CONNECTIVES = ("and", "or", "not", "imply", "exists", "forall", "=")


def parse_goal(
    text: str,
    boxes: Sequence[str],
    supports: Sequence[str],
    kinds: Mapping[str, str] | None = None,
    support_of: Mapping[str, str] | None = None,
) -> Goal:
    """Read a goal: atoms of the planning domain, joined by and, or, not, imply, exists and forall.

    A box on a support may be in any region and at any pose of it, and a box at a pose may be upright or tipped over.

    Args:
        text: Goal in PDDL.
        boxes: Names of the boxes.
        supports: Names of the supports.
        kinds: "region" or "pose" by the name of each region and pose.
        support_of: Support by the name of each region and pose on it.

    Raises:
        IctampError: Syntax, an unknown predicate or object, a wrong number of objects, too many alternatives, or atoms
            that cannot hold together.
    """
    kinds = kinds or {}
    objects = {**dict.fromkeys(boxes, "box"), **dict.fromkeys(supports, "support"), **kinds}
    formula = _read_formula(text, objects)
    try:
        goal = Goal.from_formula(_name_places(expand(formula, boxes_domain(), objects), support_of or {}))
    except IctampError as error:
        error.add_field(_FIELD)
        raise
    single = [*boxes, *(name for name, kind in kinds.items() if kind == "pose")]
    return _keep_possible(goal, {each: _contradictions(each, single) for each in goal.alternatives}, text)


def check_goal(goal: Goal, initial: State) -> Goal:
    """Return the goal without alternatives that no plan can reach from the initial state.

    Raises:
        IctampError: The goal asks for a tipped box to be upright or an upright box to be tipped.
    """
    return _keep_possible(goal, {each: _wrong_postures(each, initial) for each in goal.alternatives})


def _keep_possible(goal: Goal, reasons: dict[Alternative, Iterator[tuple[str, str]]], text: str = "") -> Goal:
    """Return the goal without the alternatives that have a reason against them.

    Raises:
        IctampError: All of them have one.
    """
    first = [next(reasons[each], None) for each in goal.alternatives]
    possible = tuple(each for each, reason in zip(goal.alternatives, first, strict=True) if reason is None)
    if not possible:
        value, problem = next(filter(None, first), (quote_expression(text), "{value} is false in every state"))
        others = ", and every other alternative is impossible too" if len(first) > 1 else ""
        raise IctampError(Code.IMPOSSIBLE_GOAL, problem + others, field=_FIELD, value=value)
    return Goal(possible)


def _name_places(formula: Formula, support_of: Mapping[str, str]) -> Formula:
    """Replace `at`, and `on` and `lying` of a support, by atoms of states, which name a region or pose if possible."""
    match formula:
        case Atom(predicate, (box, pose)) if predicate == _AT:
            return Or((Atom(ON, (box, pose)), Atom(LYING, (box, pose))))
        case Atom(predicate, (box, place)) if place in support_of.values():
            parts = [name for name, support in support_of.items() if support == place]
            return Or(tuple(Atom(predicate, (box, each)) for each in (place, *parts)))
        case Not(part):
            return negation(_name_places(part, support_of))
        case And(parts):
            return And(tuple(_name_places(part, support_of) for part in parts))
        case Or(parts):
            return Or(disjuncts(Or(tuple(_name_places(part, support_of) for part in parts))))
    return formula


class _GoalReader(FormulaReader):
    """Reads formulas about the objects of a scene."""

    def atom(self, group: Group, scope: Scope) -> Atom:
        predicate, *names = group.items
        written = quote_expression(group)
        if isinstance(predicate, str) and predicate not in (*self.predicates, *_CONNECTIVES):
            choices = (*self.predicates, *_CONNECTIVES)
            raise IctampError(
                Code.UNKNOWN_CHOICE, f"unknown word {{value}} in {written}", value=predicate, choices=choices
            )
        if predicate in _CONNECTIVES or not all(isinstance(item, str) for item in group.items):
            return super().atom(group, scope)
        if len(names) != len(self.predicates[str(predicate)]):
            wanted = " ".join(map(str.upper, self.predicates[str(predicate)]))
            problem = f"expected ({f'{predicate} {wanted}'.strip()}), got {{value}}"
            raise IctampError(Code.WRONG_LENGTH, problem, value=written)
        for name in map(str, names):
            if name not in scope and name not in self.constants:
                choices = (*scope, *self.constants)
                problem = f"unknown object {{value}} in {written}"
                raise IctampError(Code.UNKNOWN_CHOICE, problem, value=name, choices=choices)
        kind = self.constants.get(str(names[0]), "box") if names else "box"
        if kind != "box":
            why = "is never clear" if predicate == CLEAR else "cannot be moved"
            problem = f"{{value}} cannot be reached: {names[0]} is a {kind}, which {why}"
            boxes = [name for name, kind in self.constants.items() if kind == "box"]
            raise IctampError(Code.IMPOSSIBLE_GOAL, problem, value=written, choices=boxes)
        return super().atom(group, scope)


def _read_formula(text: str, objects: dict[str, str]) -> Formula:
    try:
        written = read(text)
    except IctampError as error:
        raise _not_a_goal(f"cannot read {{value}}: {error}", quote_expression(text)) from error
    domain = boxes_domain()
    predicates = {**domain.predicates, _AT: ("box", "pose")}
    try:
        formula = _GoalReader(domain.types, objects, predicates).formula(written, {}, written)
    except IctampError as error:
        if error.code is Code.NOT_PDDL:
            raise _not_a_goal(error.problem, error.value) from error
        error.add_field(_FIELD)
        raise
    if not any(leaves(formula)):
        raise _not_a_goal("expected atoms, got {value}", text)
    return formula


def _not_a_goal(problem: str, found: object) -> IctampError:
    return IctampError(Code.NOT_PDDL, problem, field=_FIELD, value=found, advice=_FORM)


def _contradictions(goal: Alternative, single: Sequence[str]) -> Iterator[tuple[str, str]]:
    """Yield atoms or boxes that exclude each other, each with a sentence why; `single` are places for one box."""
    resting = [atom for atom in sorted(goal.atoms) if atom.predicate in (ON, LYING)]
    lifted = [atom for atom in sorted(goal.atoms) if atom.predicate == IN_HAND]
    for atom in resting:
        if atom.args[0] == atom.args[1]:
            yield _pddl(atom), f"{{value}} puts {atom.args[0]} on itself"
    for box, atoms in _group_shared([*resting, *lifted], 0):
        yield _text(atoms), f"{{value}} puts {box} in more than one place"
    for below, atoms in _group_shared(resting, 1):
        if below in single:
            yield _text(atoms), f"{{value}} puts more than one box on {below}"
    for box in sorted(box for box, places in goal.places.items() if not places):
        yield box, "{value} is wanted in more than one place"
    for place, boxes in _group_by_value(goal.targets):
        if place in single:
            yield place, f"{{value}} has room for one box, not for {', '.join(boxes)}"
    for circle in _circles(goal.targets):
        yield ", ".join(circle), "the boxes {value} stand on each other in a circle"
    yield from _exclusions(goal, resting, lifted)


def _exclusions(goal: Alternative, resting: Sequence[Atom], lifted: Sequence[Atom]) -> Iterator[tuple[str, str]]:
    """Yield atoms of which one excludes another, with a sentence; `resting` and `lifted` say where boxes are to be."""
    if len(lifted) + (Atom(HAND_EMPTY, ()) in goal.atoms) > 1:
        yield _text({*lifted, Atom(HAND_EMPTY, ())} & goal.atoms), "{value} exclude each other"
    for atom in [atom for atom in sorted(goal.atoms) if atom.predicate == CLEAR]:
        others = [each for each in (*resting, *lifted) if atom.args[0] == each.args[-1]]
        if others:
            yield _text([atom, *others]), "{value} exclude each other"
    for atom in sorted(goal.atoms & goal.absent):
        yield f"{_pddl(atom)} (not {_pddl(atom)})", "{value} exclude each other"
    for atoms in sorted(map(sorted, goal.either)):
        if goal.absent.issuperset(atoms):
            yield _text(atoms), f"{{value}} are all excluded, and {atoms[0].args[0]} must be in one of these places"


def _wrong_postures(goal: Alternative, initial: State) -> Iterator[tuple[str, str]]:
    """Yield atoms that ask for another posture of a box than the initial one, each with a sentence why not."""
    tipped = tipped_boxes(initial)
    for atom in sorted(goal.atoms):
        if atom.predicate in (ON, LYING, UPRIGHT, TIPPED):
            wanted = atom.predicate in (LYING, TIPPED)
            if wanted != (atom.args[0] in tipped):
                yield _pddl(atom), f"{{value}} cannot be reached: {_explain_posture(atom.args[0], initial)}"
    for atom in sorted(goal.absent):
        if atom.predicate in (UPRIGHT, TIPPED) and (atom.predicate == TIPPED) == (atom.args[0] in tipped):
            yield f"(not {_pddl(atom)})", f"{{value}} cannot be reached: {_explain_posture(atom.args[0], initial)}"
    for atoms in sorted(map(sorted, goal.either)):
        box = atoms[0].args[0]
        if all((atom.predicate == LYING) != (box in tipped) for atom in atoms):
            yield _text(atoms), f"none of {{value}} can be reached: {_explain_posture(box, initial)}"


def _explain_posture(box: str, initial: State) -> str:
    tipped = box in tipped_boxes(initial)
    posture, change = ("tipped over", "stands a box up") if tipped else ("upright", "tips a box over")
    return f"{box} is {posture} at the start, and no skill {change}"


def _group_shared(atoms: Iterable[Atom], position: int) -> Iterator[tuple[str, list[Atom]]]:
    """Yield each object that several atoms have at the position, with these atoms."""
    by_object: dict[str, list[Atom]] = {}
    for atom in atoms:
        by_object.setdefault(atom.args[position], []).append(atom)
    return ((name, atoms) for name, atoms in by_object.items() if len(atoms) > 1)


def _group_by_value(below: Mapping[str, str]) -> Iterator[tuple[str, list[str]]]:
    """Yield each place on which there is more than one box, with these boxes."""
    for place in sorted(set(below.values())):
        boxes = sorted(box for box, each in below.items() if each == place)
        if len(boxes) > 1:
            yield place, boxes


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
