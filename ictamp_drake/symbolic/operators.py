"""Declarations of a PDDL domain: types, constants, predicates, and actions with variables for objects."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from ictamp_drake.core.types import Atom
from ictamp_drake.symbolic.formulas import Formula, Variable

OBJECT = "object"
"""Root type, the ancestor of all others."""


@dataclass(frozen=True)
class Effect:
    """Effect of an action on one atom: if `condition` holds before, the atom is added or deleted.

    Attributes:
        variables: Variables in the atom and the condition besides the parameters. The effect applies to all choices of
            objects for them.
        condition: Condition of the effect, TRUE for an effect that always happens.
        atom: Atom with variables for objects.
        adds: Whether the atom is added. False for an atom that is deleted.
    """

    variables: tuple[Variable, ...]
    condition: Formula
    atom: Atom
    adds: bool


@dataclass(frozen=True)
class Operator:
    """An action with variables for its objects."""

    name: str
    parameters: tuple[Variable, ...]
    precondition: Formula
    effects: tuple[Effect, ...]


@dataclass(frozen=True)
class PddlDomain:
    """Declarations of a domain file.

    Attributes:
        types: Parent of each type by name. OBJECT has no parent and is left out.
        constants: Types of the objects that exist in every problem, by name.
        predicates: Types of the arguments of each predicate, by name.
        operators: Actions of the domain.
    """

    types: Mapping[str, str]
    constants: Mapping[str, str]
    predicates: Mapping[str, tuple[str, ...]]
    operators: tuple[Operator, ...]


def lineage(kind: str, types: Mapping[str, str]) -> Iterator[str]:
    """Yield the type and all its ancestors, up to OBJECT."""
    while kind != OBJECT:
        yield kind
        kind = types[kind]
    yield OBJECT
