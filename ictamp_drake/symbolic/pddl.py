"""The one door to unified-planning: reads `domain.pddl`, fills in a scene's objects, grounds the actions."""

from collections.abc import Iterator, Sequence
from functools import cache
from importlib.resources import as_file, files
from typing import Any

from unified_planning.engines import CompilationKind
from unified_planning.engines.compilers import GrounderHelper, QuantifiersRemover
from unified_planning.io import PDDLReader

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.types import Action, Atom, State

Expression = Any
"""A formula of unified-planning, which ships no types."""

GroundEffects = tuple[frozenset[Atom], frozenset[Atom], frozenset[Atom]]
"""Preconditions, added atoms, deleted atoms."""


def planning_problem(boxes: Sequence[str], supports: Sequence[str], initial: State, goal: frozenset[Atom]) -> Any:
    """The problem as unified-planning's `Problem`, for its validator, its writers and other planners.

    Raises:
        IctampError: two objects have one name, or an object the name of a type, predicate or action.
    """
    problem = _without_objects().clone()
    for type_name, names in (("box", boxes), ("support", supports)):
        for name in names:
            if problem.has_name(name):
                taken = "that of another object or a word of the planning domain"
                raise IctampError(f'The name "{name}" of a {type_name} is {taken}: choose another one.')
            problem.add_object(name, problem.user_type(type_name))
    for atom in sorted(initial):
        problem.set_initial_value(_fluent(problem, atom), True)
    for atom in sorted(goal):
        problem.add_goal(_fluent(problem, atom))
    return problem


def ground(problem: Any) -> Iterator[tuple[Action, GroundEffects]]:
    """The actions that can ever be applied from the problem's initial state, as plain STRIPS.

    Who is upright and who is tipped is settled here, so neither occurs in the result.
    """
    lifted = QuantifiersRemover().compile(problem, CompilationKind.QUANTIFIERS_REMOVING).problem
    for action, arguments, grounded in GrounderHelper(lifted).get_grounded_actions():
        if grounded is not None:
            name = Action(action.name, tuple(str(argument) for argument in arguments))
            yield name, _strips(grounded.preconditions, grounded.effects)


@cache
def _without_objects() -> Any:
    with as_file(files("ictamp_drake.symbolic") / "domain.pddl") as path:
        return PDDLReader().parse_problem(str(path))


def _fluent(problem: Any, atom: Atom) -> Expression:
    return problem.fluent(atom.predicate)(*(problem.object(name) for name in atom.args))


def _atom(expression: Expression) -> Atom:
    return Atom(expression.fluent().name, tuple(argument.object().name for argument in expression.args))


def _strips(preconditions: Sequence[Expression], effects: Sequence[Any]) -> GroundEffects:
    return (
        frozenset(_atom(precondition) for precondition in preconditions),
        frozenset(_atom(effect.fluent) for effect in effects if effect.value.is_true()),
        frozenset(_atom(effect.fluent) for effect in effects if effect.value.is_false()),
    )
