"""Grounding: turns the operators of a PDDL domain and the objects of a scene into actions without variables.

A predicate is static if no effect mentions it. Its atoms never change from the initial state, so grounding evaluates
them: ground actions contain no static atoms, and actions that static atoms rule out are left out.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import Action, Atom, State
from ictamp_drake.symbolic.formulas import (
    FALSE,
    TRUE,
    And,
    Equal,
    Exists,
    Formula,
    Not,
    Or,
    Variable,
    conjuncts,
    disjuncts,
    holds,
    leaves,
    negation,
)
from ictamp_drake.symbolic.operators import Operator, PddlDomain, lineage

MAX_PARTS = 10_000_000
"""Maximum number of formula parts evaluated while grounding a domain, which takes about ten seconds."""

MAX_GOAL_PARTS = 100_000
"""Maximum number of formula parts evaluated while a goal's quantifiers are written out, about a tenth of a second."""

_Binding = dict[str, str]
"""Object of each variable, by the name of the variable."""


@dataclass(frozen=True)
class ConditionalEffect:
    """Additional effect of an action when `condition` holds before it."""

    condition: Formula
    add: frozenset[Atom]
    delete: frozenset[Atom]


@dataclass(frozen=True)
class GroundAction:
    """An action a, applicable where its preconditions hold. It deletes atoms before it adds others.

    Attributes:
        action: Name and objects of the action.
        preconditions, add, delete: Ground atoms, none of them static.
        further: Additional precondition that is not just a set of atoms.
        conditional: Effects that depend on the state.
    """

    action: Action
    preconditions: frozenset[Atom]
    add: frozenset[Atom]
    delete: frozenset[Atom]
    further: Formula = TRUE
    conditional: tuple[ConditionalEffect, ...] = ()

    @cached_property
    def is_plain(self) -> bool:
        """Whether the action consists of `preconditions`, `add` and `delete` only."""
        return self.further == TRUE and not self.conditional

    def applies(self, state: State) -> bool:
        """Whether the action is applicable in the state."""
        return self.preconditions <= state and (self.is_plain or holds(self.further, state))

    def apply(self, state: State) -> State:
        """Return the state after the action."""
        add, delete = self.add, self.delete
        for effect in self.conditional:
            if holds(effect.condition, state):
                add, delete = add | effect.add, delete | effect.delete
        return (state - delete) | add


def ground(domain: PddlDomain, objects: Mapping[str, str], initial: State) -> tuple[GroundAction, ...]:
    """Return the ground actions that the static atoms of the initial state allow, operator by operator.

    Args:
        domain: Domain with the operators.
        objects: Types of the objects by name.
        initial: Initial state, which decides static atoms.

    Raises:
        IctampError: There are too many ways to choose objects.
    """
    grounder = _Grounder(domain, objects, initial, MAX_PARTS)
    return tuple(action for operator in domain.operators for action in grounder.ground(operator))


def expand(formula: Formula, domain: PddlDomain, objects: Mapping[str, str]) -> Formula:
    """Return a formula without variables in its simplest form: atoms, negated atoms, conjunctions and disjunctions.

    Args:
        formula: Formula whose variables are all quantified.
        domain: Domain with the types.
        objects: Types of the objects by name.

    Raises:
        IctampError: There are too many ways to choose objects.
    """
    grounder = _Grounder(replace(domain, predicates={}), objects, frozenset(), MAX_GOAL_PARTS)
    return grounder.simplify(formula, {})


class _Grounder:
    """Replaces variables by objects and evaluates static atoms."""

    def __init__(self, domain: PddlDomain, objects: Mapping[str, str], initial: State, max_parts: int) -> None:
        self._objects: dict[str, list[str]] = {}
        for name, kind in {**domain.constants, **objects}.items():
            for ancestor in lineage(kind, domain.types):
                self._objects.setdefault(ancestor, []).append(name)
        changed = {effect.atom.predicate for operator in domain.operators for effect in operator.effects}
        self._static = domain.predicates.keys() - changed
        self._facts = frozenset(atom for atom in initial if atom.predicate in self._static)
        self._parts_left = max_parts

    def ground(self, operator: Operator) -> Iterator[GroundAction]:
        """Yield the ground actions of an operator, in the order of their objects."""
        for binding in self._choices(operator):
            precondition = conjuncts(self.simplify(operator.precondition, binding))
            atoms = frozenset(part for part in precondition if isinstance(part, Atom))
            further = tuple(part for part in precondition if not isinstance(part, Atom))
            if FALSE in further or any(isinstance(part, Not) and part.part in atoms for part in further):
                continue
            action = Action(operator.name, tuple(binding[variable.name] for variable in operator.parameters))
            always, *conditional = self._effects(operator, binding)
            yield GroundAction(action, atoms, always.add, always.delete, _conjunction(further), tuple(conditional))

    def _choices(self, operator: Operator) -> Sequence[_Binding]:
        """Return the bindings of the parameters that no static part of the precondition rules out."""
        parts = conjuncts(operator.precondition)
        bindings: list[_Binding] = [{}]
        for number, variable in enumerate(operator.parameters):
            later = {each.name for each in operator.parameters[number + 1 :]}
            decided = [part for part in parts if self._is_static(part) and _terms(part).isdisjoint(later)]
            decided = [part for part in decided if variable.name in _terms(part)]
            bindings = [
                binding
                for binding in self._extend_bindings(bindings, variable, parts)
                if all(self.simplify(part, binding) is TRUE for part in decided)
            ]
        return bindings

    def _effects(self, operator: Operator, binding: _Binding) -> list[ConditionalEffect]:
        """Return the unconditional effect, followed by those that depend on the state."""
        found: dict[Formula, tuple[set[Atom], set[Atom]]] = {TRUE: (set(), set())}
        for effect in operator.effects:
            for wider in self._instances(effect.variables, binding, conjuncts(effect.condition)):
                condition = self.simplify(effect.condition, wider)
                if condition is not FALSE:
                    add, delete = found.setdefault(condition, (set(), set()))
                    (add if effect.adds else delete).add(_bind(effect.atom, wider))
        return [ConditionalEffect(when, frozenset(add), frozenset(delete)) for when, (add, delete) in found.items()]

    def simplify(self, formula: Formula, binding: _Binding) -> Formula:
        """Reduce a formula to TRUE, FALSE, or a ground formula of atoms that can change."""
        self._count()
        match formula:
            case Atom():
                atom = _bind(formula, binding)
                return atom if atom.predicate not in self._static else TRUE if atom in self._facts else FALSE
            case Equal((left, right)):
                return TRUE if binding.get(left, left) == binding.get(right, right) else FALSE
            case Not(part):
                return negation(self.simplify(part, binding))
            case And(parts):
                return _conjunction(self.simplify(part, binding) for part in parts)
            case Or(parts):
                return _disjunction(self.simplify(part, binding) for part in parts)
            case Exists(variables, body):
                instances = self._instances(variables, binding, conjuncts(body))
                return _disjunction(self.simplify(body, wider) for wider in instances)

    def _instances(
        self, variables: Sequence[Variable], binding: _Binding, parts: Sequence[Formula]
    ) -> Iterable[_Binding]:
        """Extend the binding by objects for more variables. Some that violate the parts may be left out."""
        bindings: Iterable[_Binding] = [binding]
        for variable in variables:
            bindings = self._extend_bindings(bindings, variable, parts)
        return bindings

    def _extend_bindings(
        self, bindings: Iterable[_Binding], variable: Variable, parts: Sequence[Formula]
    ) -> Iterator[_Binding]:
        for binding in bindings:
            for name in self._candidates(variable, binding, parts):
                self._count()
                yield {**binding, variable.name: name}

    def _candidates(self, variable: Variable, binding: _Binding, parts: Sequence[Formula]) -> Sequence[str]:
        """Return the possible objects of a variable, at most one where the parts equate it with an object."""
        objects = self._objects.get(variable.type, [])
        for part in parts:
            if isinstance(part, Equal) and variable.name in part.terms:
                left, right = part.terms
                other = right if left == variable.name else left
                name = binding.get(other, other)
                if not name.startswith("?"):
                    return [name] if name in objects else []
        return objects

    def _is_static(self, formula: Formula) -> bool:
        return all(isinstance(leaf, Equal) or leaf.predicate in self._static for leaf in leaves(formula))

    def _count(self) -> None:
        self._parts_left -= 1
        if self._parts_left < 0:
            advice = "use fewer variables or fewer objects"
            raise IctampError(Code.TOO_LARGE, "there are too many ways to choose objects for variables", advice=advice)


def _bind(atom: Atom, binding: _Binding) -> Atom:
    return Atom(atom.predicate, tuple([binding.get(term, term) for term in atom.args]))


def _terms(formula: Formula) -> set[str]:
    return {term for leaf in leaves(formula) for term in (leaf.terms if isinstance(leaf, Equal) else leaf.args)}


def _conjunction(parts: Iterable[Formula]) -> Formula:
    """Return the conjunction in its simplest form. Parts after the first FALSE are not evaluated."""
    left = list[Formula]()
    for part in parts:
        if part is FALSE:
            return FALSE
        if part is not TRUE:
            left.extend(conjuncts(part))
    distinct = tuple(dict.fromkeys(left))
    return distinct[0] if len(distinct) == 1 else And(distinct) if distinct else TRUE


def _disjunction(parts: Iterable[Formula]) -> Formula:
    """Return the disjunction in its simplest form. Parts after the first TRUE are not evaluated."""
    left = list[Formula]()
    for part in parts:
        if part is TRUE:
            return TRUE
        if part is not FALSE:
            left.extend(disjuncts(part))
    distinct = tuple(dict.fromkeys(left))
    return distinct[0] if len(distinct) == 1 else Or(distinct) if distinct else FALSE
