"""Grounding: from the operators of a PDDL domain and the objects of a scene to actions without variables.

A predicate that no effect speaks of is static: its atoms are as they are in the initial state for good. So they are
settled here, none of them is left in what comes out, and an action that they rule out does not come out.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass
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
"""Parts of formulas that are looked at in grounding a domain: some ten seconds."""

_Binding = dict[str, str]
"""The objects that variables stand for, by variable."""


@dataclass(frozen=True)
class ConditionalEffect:
    """What an action does besides where `condition` holds before it."""

    condition: Formula
    add: frozenset[Atom]
    delete: frozenset[Atom]


@dataclass(frozen=True)
class GroundAction:
    """An action a: applicable where its preconditions hold; what it deletes goes before what it adds comes.

    Attributes:
        action: name and objects.
        preconditions, add, delete: ground atoms, none of them static.
        further: a precondition that is more than a set of atoms.
        conditional: effects that depend on the state.
    """

    action: Action
    preconditions: frozenset[Atom]
    add: frozenset[Atom]
    delete: frozenset[Atom]
    further: Formula = TRUE
    conditional: tuple[ConditionalEffect, ...] = ()

    @cached_property
    def is_plain(self) -> bool:
        """Whether preconditions, add and delete are all that there is."""
        return self.further == TRUE and not self.conditional

    def applies(self, state: State) -> bool:
        """Tell whether the action can be applied in the state."""
        return self.preconditions <= state and (self.is_plain or holds(self.further, state))

    def apply(self, state: State) -> State:
        """The state after the action."""
        add, delete = self.add, self.delete
        for effect in self.conditional:
            if holds(effect.condition, state):
                add, delete = add | effect.add, delete | effect.delete
        return (state - delete) | add


def ground(domain: PddlDomain, objects: Mapping[str, str], initial: State) -> tuple[GroundAction, ...]:
    """The ground actions that the static atoms of the initial state allow, operator by operator.

    Args:
        domain: the operators.
        objects: types of the objects, by name.
        initial: the state that settles static atoms.

    Raises:
        IctampError: there are too many ways to choose objects.
    """
    grounder = _Grounder(domain, objects, initial)
    return tuple(action for operator in domain.operators for action in grounder.ground(operator))


class _Grounder:
    """Puts objects in the place of variables, and settles what is static."""

    def __init__(self, domain: PddlDomain, objects: Mapping[str, str], initial: State) -> None:
        self._objects: dict[str, list[str]] = {}
        for name, kind in {**domain.constants, **objects}.items():
            for ancestor in lineage(kind, domain.types):
                self._objects.setdefault(ancestor, []).append(name)
        changed = {effect.atom.predicate for operator in domain.operators for effect in operator.effects}
        self._static = domain.predicates.keys() - changed
        self._facts = frozenset(atom for atom in initial if atom.predicate in self._static)
        self._parts_left = MAX_PARTS

    def ground(self, operator: Operator) -> Iterator[GroundAction]:
        """The actions that come of an operator, in the order of their objects."""
        for binding in self._choices(operator):
            precondition = conjuncts(self._simplify(operator.precondition, binding))
            atoms = frozenset(part for part in precondition if isinstance(part, Atom))
            further = tuple(part for part in precondition if not isinstance(part, Atom))
            if FALSE in further or any(isinstance(part, Not) and part.part in atoms for part in further):
                continue
            action = Action(operator.name, tuple(binding[variable.name] for variable in operator.parameters))
            always, *conditional = self._effects(operator, binding)
            yield GroundAction(action, atoms, always.add, always.delete, _conjunction(further), tuple(conditional))

    def _choices(self, operator: Operator) -> Sequence[_Binding]:
        """The bindings of the parameters that no static part of the precondition rules out."""
        parts = conjuncts(operator.precondition)
        bindings: list[_Binding] = [{}]
        for number, variable in enumerate(operator.parameters):
            later = {each.name for each in operator.parameters[number + 1 :]}
            decided = [part for part in parts if self._is_static(part) and _terms(part).isdisjoint(later)]
            decided = [part for part in decided if variable.name in _terms(part)]
            bindings = [
                binding
                for binding in self._extend_bindings(bindings, variable, parts)
                if all(self._simplify(part, binding) is TRUE for part in decided)
            ]
        return bindings

    def _effects(self, operator: Operator, binding: _Binding) -> list[ConditionalEffect]:
        """What happens always, and then what depends on the state."""
        found: dict[Formula, tuple[set[Atom], set[Atom]]] = {TRUE: (set(), set())}
        for effect in operator.effects:
            for wider in self._instances(effect.variables, binding, conjuncts(effect.condition)):
                condition = self._simplify(effect.condition, wider)
                if condition is not FALSE:
                    add, delete = found.setdefault(condition, (set(), set()))
                    (add if effect.adds else delete).add(_bind(effect.atom, wider))
        return [ConditionalEffect(when, frozenset(add), frozenset(delete)) for when, (add, delete) in found.items()]

    def _simplify(self, formula: Formula, binding: _Binding) -> Formula:
        """What is left of a formula: TRUE, FALSE, or a ground formula of atoms that can change."""
        self._count()
        match formula:
            case Atom():
                atom = _bind(formula, binding)
                return atom if atom.predicate not in self._static else TRUE if atom in self._facts else FALSE
            case Equal((left, right)):
                return TRUE if binding.get(left, left) == binding.get(right, right) else FALSE
            case Not(part):
                return negation(self._simplify(part, binding))
            case And(parts):
                return _conjunction(self._simplify(part, binding) for part in parts)
            case Or(parts):
                return _disjunction(self._simplify(part, binding) for part in parts)
            case Exists(variables, body):
                instances = self._instances(variables, binding, conjuncts(body))
                return _disjunction(self._simplify(body, wider) for wider in instances)

    def _instances(
        self, variables: Sequence[Variable], binding: _Binding, parts: Sequence[Formula]
    ) -> Iterable[_Binding]:
        """The binding with objects for more variables, save some for which the parts do not all hold."""
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
        """The objects that a variable can stand for: just one where the parts say which it equals."""
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
            advice = "use fewer parameters or fewer objects"
            raise IctampError(Code.TOO_LARGE, "the planning domain has too many ground actions", advice=advice)


def _bind(atom: Atom, binding: _Binding) -> Atom:
    return Atom(atom.predicate, tuple([binding.get(term, term) for term in atom.args]))


def _terms(formula: Formula) -> set[str]:
    return {term for leaf in leaves(formula) for term in (leaf.terms if isinstance(leaf, Equal) else leaf.args)}


def _conjunction(parts: Iterable[Formula]) -> Formula:
    """The conjunction in its simplest form; parts after the first that is FALSE are not looked at."""
    left = list[Formula]()
    for part in parts:
        if part is FALSE:
            return FALSE
        if part is not TRUE:
            left.extend(conjuncts(part))
    distinct = tuple(dict.fromkeys(left))
    return distinct[0] if len(distinct) == 1 else And(distinct) if distinct else TRUE


def _disjunction(parts: Iterable[Formula]) -> Formula:
    """The disjunction in its simplest form; parts after the first that is TRUE are not looked at."""
    left = list[Formula]()
    for part in parts:
        if part is TRUE:
            return TRUE
        if part is not FALSE:
            left.extend(disjuncts(part))
    distinct = tuple(dict.fromkeys(left))
    return distinct[0] if len(distinct) == 1 else Or(distinct) if distinct else FALSE
