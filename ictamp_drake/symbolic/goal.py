"""Goals: alternatives of atoms that must hold and atoms that must not, made from a formula."""

from collections.abc import Iterable
from dataclasses import dataclass
from functools import cached_property

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import Atom, State
from ictamp_drake.symbolic.atoms import LYING, ON
from ictamp_drake.symbolic.formulas import And, Formula, Not, Or

MAX_ALTERNATIVES = 1000
"""Maximum number of alternatives of a goal. Guides of the search for plans estimate the distance to each."""

_NOTHING = frozenset[Atom]()


@dataclass(frozen=True)
class Alternative:
    """One way to reach a goal.

    Attributes:
        atoms: Atoms that must hold.
        absent: Atoms that must not hold.
        either: Sets of atoms; at least one of each must hold. All atoms of a set say what the same box rests on.
    """

    atoms: frozenset[Atom] = _NOTHING
    absent: frozenset[Atom] = _NOTHING
    either: frozenset[frozenset[Atom]] = frozenset()

    def holds(self, state: State) -> bool:
        """Whether the alternative holds in the state."""
        return self.atoms <= state and self.absent.isdisjoint(state) and not any(map(state.isdisjoint, self.either))

    def __and__(self, other: "Alternative") -> "Alternative":
        return Alternative(self.atoms | other.atoms, self.absent | other.absent, self.either | other.either)

    @property
    def mentioned(self) -> frozenset[Atom]:
        """Atoms that decide whether the alternative holds."""
        return self.atoms.union(self.absent, *self.either)

    @cached_property
    def places(self) -> dict[str, frozenset[str]]:
        """Possible places by box, an empty set in a contradiction. Boxes that may be anywhere are absent."""
        allowed: dict[str, frozenset[str]] = {}
        one_each = ({atom} for atom in self.atoms if atom.predicate in (ON, LYING))
        for atoms in (*one_each, *self.either):
            (box,) = {atom.args[0] for atom in atoms}
            places = frozenset(atom.args[1] for atom in atoms)
            allowed[box] = allowed.get(box, places) & places
        return allowed

    @property
    def targets(self) -> dict[str, str]:
        """Place by box, for the boxes with one possible place."""
        return {box: place for box, places in self.places.items() if len(places) == 1 for place in places}


@dataclass(frozen=True)
class Goal:
    """A goal, which holds where at least one of its alternatives does."""

    alternatives: tuple[Alternative, ...]

    @classmethod
    def of(cls, atoms: Iterable[Atom]) -> "Goal":
        """Return the goal that all of these atoms hold."""
        return cls((Alternative(frozenset(atoms)),))

    @classmethod
    def from_formula(cls, formula: Formula) -> "Goal":
        """Return the goal that a ground formula without quantifiers and equalities holds.

        Raises:
            IctampError: There are too many alternatives.
        """
        return cls(tuple(_alternatives(formula)))

    def holds(self, state: State) -> bool:
        """Whether the goal holds in the state."""
        return any(alternative.holds(state) for alternative in self.alternatives)

    @cached_property
    def mentioned(self) -> frozenset[Atom]:
        """Atoms that decide whether the goal holds."""
        return _NOTHING.union(*(alternative.mentioned for alternative in self.alternatives))


def _alternatives(formula: Formula) -> list[Alternative]:
    match formula:
        case Atom():
            return [Alternative(frozenset({formula}))]
        case Not(Atom() as atom):
            return [Alternative(absent=frozenset({atom}))]
        case And(parts):
            found = [Alternative()]
            for part in parts:
                more = _alternatives(part)
                _check_number(len(found) * len(more))
                found = list(dict.fromkeys(one & other for one in found for other in more))
            return found
        case Or(parts):
            places, others = _split_places(parts)
            found = [_allow_any(atoms) for atoms in places]
            for part in others:
                found += _alternatives(part)
                _check_number(len(found))
            return list(dict.fromkeys(found))
    raise TypeError(f"expected a ground formula without quantifiers, not {formula}")


def _split_places(parts: Iterable[Formula]) -> tuple[list[list[Atom]], list[Formula]]:
    """Return the atoms that say what a box rests on, grouped by box, and the other parts."""
    by_box: dict[str, list[Atom]] = {}
    others: list[Formula] = []
    for part in parts:
        if isinstance(part, Atom) and part.predicate in (ON, LYING):
            by_box.setdefault(part.args[0], []).append(part)
        else:
            others.append(part)
    return list(by_box.values()), others


def _allow_any(atoms: list[Atom]) -> Alternative:
    distinct = frozenset(atoms)
    return Alternative(distinct) if len(distinct) == 1 else Alternative(either=frozenset({distinct}))


def _check_number(number: int) -> None:
    if number > MAX_ALTERNATIVES:
        problem = f"expected a goal with at most {MAX_ALTERNATIVES} alternatives, got at least {{value}}"
        raise IctampError(Code.TOO_LARGE, problem, value=number, advice="nest or, exists and imply less")
