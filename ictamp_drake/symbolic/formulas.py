"""Formulas of PDDL. Words that begin with ? are variables, and a formula without any is ground.

There are no classes for what others say: imply is an `Or`, and forall says that nothing exists which refutes it.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from ictamp_drake.core.types import Atom, State


class Variable(NamedTuple):
    """A name with a type, such as ?x - box."""

    name: str
    type: str


@dataclass(frozen=True)
class Equal:
    """Both terms are the same object."""

    terms: tuple[str, str]


@dataclass(frozen=True)
class Not:
    """The part is false."""

    part: "Formula"


@dataclass(frozen=True)
class And:
    """All of the parts hold."""

    parts: tuple["Formula", ...]


@dataclass(frozen=True)
class Or:
    """At least one of the parts holds."""

    parts: tuple["Formula", ...]


@dataclass(frozen=True)
class Exists:
    """The body holds for some objects that the variables stand for."""

    variables: tuple[Variable, ...]
    body: "Formula"


Formula = Atom | Equal | Not | And | Or | Exists

TRUE = And(())
FALSE = Or(())


def holds(formula: Formula, state: State) -> bool:
    """Tell whether a ground formula without quantifiers is true in the state."""
    match formula:
        case Atom():
            return formula in state
        case Not(part):
            return not holds(part, state)
        case And(parts):
            return all(holds(part, state) for part in parts)
        case Or(parts):
            return any(holds(part, state) for part in parts)
    raise TypeError(f"expected a ground formula without quantifiers, not {formula}")


def negation(formula: Formula) -> Formula:
    """The opposite of the formula, with `Not` as far inside as it goes."""
    match formula:
        case Not(part):
            return part
        case And(parts):
            return Or(tuple(map(negation, parts))) if parts else FALSE
        case Or(parts):
            return And(tuple(map(negation, parts))) if parts else TRUE
    return Not(formula)


def conjuncts(formula: Formula) -> tuple[Formula, ...]:
    """Formulas that hold together exactly when the formula does."""
    return tuple(each for part in formula.parts for each in conjuncts(part)) if isinstance(formula, And) else (formula,)


def disjuncts(formula: Formula) -> tuple[Formula, ...]:
    """Formulas of which one holds exactly when the formula does."""
    return tuple(each for part in formula.parts for each in disjuncts(part)) if isinstance(formula, Or) else (formula,)


def leaves(formula: Formula) -> Iterator[Atom | Equal]:
    """The atoms and equalities that a formula is made of."""
    match formula:
        case Atom() | Equal():
            yield formula
        case Not(part):
            yield from leaves(part)
        case And(parts) | Or(parts):
            for part in parts:
                yield from leaves(part)
        case Exists(_, body):
            yield from leaves(body)
