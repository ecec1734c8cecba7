"""The domain on integers agrees with the domain on sets of atoms."""

import pytest
from hypothesis import given

from ictamp_drake.core.types import Action, Atom, State
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.symbolic.formulas import Not, Or
from ictamp_drake.symbolic.goal import Goal
from ictamp_drake.symbolic.grounding import ConditionalEffect, GroundAction
from ictamp_drake.symbolic.masks import Masks
from tests.symbolic.towers import LEVELS, Problem, problems

P, Q, R = (Atom(name, ()) for name in "pqr")
NOTHING = frozenset[Atom]()


def check(domain: Domain, goal: Goal, initial: State, limit: int = 200) -> set[State]:
    """Compare the successors of all states, or of the first ones."""
    masks, seen, frontier = Masks(domain, goal), {initial}, [initial]
    while frontier and len(seen) < limit:
        state = frontier.pop()
        after = [successor for _, successor in domain.successors(state)]
        assert list(masks.successors(masks.encode(state))) == [masks.encode(successor) for successor in after]
        frontier += [successor for successor in after if successor not in seen]
        seen.update(after)
    assert len({masks.encode(state) for state in seen}) == len(seen)
    return seen


@given(problems(boxes=3))
def test_successors_are_the_same_in_the_same_order(problem: Problem) -> None:
    check(problem.domain, problem.goal, problem.initial)


@pytest.mark.parametrize("problem", LEVELS.values(), ids=LEVELS)
def test_so_it_is_in_the_levels(problem: Problem) -> None:
    check(problem.domain, problem.goal, problem.initial)


def test_so_it_is_with_conditions_of_every_sort() -> None:
    add_q = GroundAction(Action("add", ("q",)), NOTHING, frozenset({Q}), NOTHING, further=Or((Not(P), R)))
    flip = GroundAction(
        Action("flip", ("p",)),
        NOTHING,
        NOTHING,
        NOTHING,
        conditional=(
            ConditionalEffect(P, frozenset({R}), frozenset({P})),
            ConditionalEffect(Not(P), frozenset({P}), frozenset({R})),
        ),
    )
    drop_q = GroundAction(Action("drop", ("q",)), frozenset({Q, R}), NOTHING, frozenset({Q}))
    domain = Domain((), (), (add_q, flip, drop_q))
    assert len(check(domain, Goal.of({Q}), frozenset({P}))) == 4


def test_a_goal_that_no_action_speaks_of_has_bits_too() -> None:
    masks = Masks(Domain((), (), ()), Goal.of({P}))
    assert masks.encode(frozenset({P})) != masks.encode(NOTHING)
    assert masks.encode(frozenset({Q})) == masks.encode(NOTHING)
