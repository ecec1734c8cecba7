"""Formulas of PDDL. Words that begin with ? are variables, and a formula without variables is ground.

Two connectives have no class: imply becomes an `Or`, and forall becomes a `Not` of an `Exists` with the body negated.
"""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

from ictamp_drake.core.types import Atom, State


class Variable(NamedTuple):
    """A variable name with its type, such as ?x - box."""

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
    """The body holds for some choice of objects for the variables."""

    variables: tuple[Variable, ...]
    body: "Formula"


Formula = Atom | Equal | Not | And | Or | Exists

TRUE = And(())
FALSE = Or(())


def holds(formula: Formula, state: State) -> bool:
    """Whether a ground formula without quantifiers is true in the state."""
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
    """Negate the formula, with each `Not` pushed inward as far as possible."""
    match formula:
        case Not(part):
            return part
        case And(parts):
            return Or(tuple(map(negation, parts))) if parts else FALSE
        case Or(parts):
            return And(tuple(map(negation, parts))) if parts else TRUE
    return Not(formula)


def conjuncts(formula: Formula) -> tuple[Formula, ...]:
    """Split a formula into parts that all hold exactly when the formula does."""
    return tuple(each for part in formula.parts for each in conjuncts(part)) if isinstance(formula, And) else (formula,)


def disjuncts(formula: Formula) -> tuple[Formula, ...]:
    """Split a formula into parts of which at least one holds exactly when the formula does."""
    return tuple(each for part in formula.parts for each in disjuncts(part)) if isinstance(formula, Or) else (formula,)


def leaves(formula: Formula) -> Iterator[Atom | Equal]:
    """Yield the atoms and equalities in a formula."""
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
