"""The same domains in unified-planning, as a reference for our semantics."""

from collections.abc import Mapping
from functools import cache
from typing import Any

from unified_planning.engines import CompilationKind
from unified_planning.engines.compilers import GrounderHelper, QuantifiersRemover
from unified_planning.engines.sequential_simulator import UPSequentialSimulator
from unified_planning.io import PDDLReader

from ictamp_drake.core.types import Action, Atom, State

Problem = Any
"""A problem of unified-planning, which ships no types."""


@cache
def _read(domain: str) -> Problem:
    return PDDLReader().parse_problem_string(domain)


def problem(domain: str, objects: Mapping[str, str], initial: State, goal: frozenset[Atom] = frozenset()) -> Problem:
    """The domain with objects, start and goal."""
    filled = _read(domain).clone()
    for name, kind in objects.items():
        filled.add_object(name, filled.user_type(kind))
    for atom in initial:
        filled.set_initial_value(_fluent(filled, atom), True)
    for atom in goal:
        filled.add_goal(_fluent(filled, atom))
    return filled


def ground(theirs: Problem) -> dict[Action, tuple[frozenset[Atom], frozenset[Atom], frozenset[Atom]]]:
    """Preconditions, added atoms and deleted atoms of the ground actions, all of which must be plain STRIPS."""
    lifted = QuantifiersRemover().compile(theirs, CompilationKind.QUANTIFIERS_REMOVING).problem
    found = {}
    for action, arguments, grounded in GrounderHelper(lifted).get_grounded_actions():
        if grounded is not None:
            assert all(effect.condition.is_true() for effect in grounded.effects)
            found[Action(action.name, tuple(map(str, arguments)))] = (
                frozenset(map(_atom, grounded.preconditions)),
                frozenset(_atom(effect.fluent) for effect in grounded.effects if effect.value.is_true()),
                frozenset(_atom(effect.fluent) for effect in grounded.effects if effect.value.is_false()),
            )
    return found


class Simulator:
    """Simulator of a problem's actions, state by state."""

    def __init__(self, theirs: Problem) -> None:
        self._problem = theirs
        self._simulator = UPSequentialSimulator(theirs, error_on_failed_checks=False)
        self._atoms = {value: _atom(value) for value in theirs.initial_values}

    def initial(self) -> Any:
        """Initial state in unified-planning."""
        return self._simulator.get_initial_state()

    def atoms(self, theirs: Any) -> State:
        """Atoms that hold in a state."""
        return frozenset(atom for value, atom in self._atoms.items() if theirs.get_value(value).is_true())

    def successors(self, theirs: Any) -> dict[Action, Any]:
        """Successors by the applicable actions."""
        found = {}
        for action, arguments in self._simulator.get_applicable_actions(theirs):
            found[Action(action.name, tuple(map(str, arguments)))] = self._simulator.apply(theirs, action, arguments)
        return found


def _fluent(theirs: Problem, atom: Atom) -> Any:
    return theirs.fluent(atom.predicate)(*(theirs.object(name) for name in atom.args))


def _atom(expression: Any) -> Atom:
    return Atom(expression.fluent().name, tuple(argument.object().name for argument in expression.args))
