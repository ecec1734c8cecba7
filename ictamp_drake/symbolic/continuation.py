"""Plans that begin with a given action and continue to the goal, for estimators that look ahead."""

from ictamp_drake.core.types import Action, Skeleton, State
from ictamp_drake.symbolic.context import GeneratorContext
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.symbolic.goal import Goal
from ictamp_drake.symbolic.skeletons import BreadthFirst

EXPANSIONS = 1000
"""Maximum number of nodes in the search for the rest of a plan."""


def continue_plan(
    domain: Domain, state: State, action: Action, goal: Goal, max_expansions: int = EXPANSIONS
) -> Skeleton:
    """Return the action followed by the shortest plan to the goal, or the action alone when no plan is found.

    Raises:
        ValueError: The action is not applicable in the state.
    """
    promised = domain.successor(state, action)
    stream = BreadthFirst().create(GeneratorContext(domain, promised, goal))
    rest = stream.next_plan(max_expansions) or Skeleton((promised,), ())
    return Skeleton((state, *rest.states), (action, *rest.actions))
