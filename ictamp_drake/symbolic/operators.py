"""What a PDDL domain declares: types, constants, predicates, and actions whose objects are still open."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

from ictamp_drake.core.types import Atom
from ictamp_drake.symbolic.formulas import Formula, Variable

OBJECT = "object"
"""The type that all others belong to."""


@dataclass(frozen=True)
class Effect:
    """What an action does to one atom: if `condition` holds before, the atom holds after (`adds`), or does not.

    Attributes:
        variables: what else the atom and the condition speak of than parameters; it happens for all objects.
        condition: TRUE for what always happens.
        atom: with variables for objects.
        adds: False for an atom that is deleted.
    """

    variables: tuple[Variable, ...]
    condition: Formula
    atom: Atom
    adds: bool


@dataclass(frozen=True)
class Operator:
    """An action whose objects are still open."""

    name: str
    parameters: tuple[Variable, ...]
    precondition: Formula
    effects: tuple[Effect, ...]


@dataclass(frozen=True)
class PddlDomain:
    """What a domain file declares.

    Attributes:
        types: each type with the one that it is a kind of; OBJECT has none and is left out.
        constants: objects of every problem, with their types.
        predicates: types of the arguments of each.
        operators: the actions.
    """

    types: Mapping[str, str]
    constants: Mapping[str, str]
    predicates: Mapping[str, tuple[str, ...]]
    operators: tuple[Operator, ...]


def lineage(kind: str, types: Mapping[str, str]) -> Iterator[str]:
    """The type and all that it is a kind of, up to OBJECT."""
    while kind != OBJECT:
        yield kind
        kind = types[kind]
    yield OBJECT
