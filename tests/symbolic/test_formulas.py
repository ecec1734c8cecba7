"""Formulas: when they hold, and their negations."""

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.core.types import Atom, State
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

ATOMS = [Atom(name, ()) for name in "pqr"]
formulas: st.SearchStrategy[Formula] = st.recursive(
    st.sampled_from(ATOMS),
    lambda parts: st.one_of(
        st.builds(Not, parts),
        st.builds(And, st.lists(parts, max_size=3).map(tuple)),
        st.builds(Or, st.lists(parts, max_size=3).map(tuple)),
    ),
)
states = st.frozensets(st.sampled_from(ATOMS))


def test_connectives_mean_what_they_say() -> None:
    p, q, _ = ATOMS
    only_p = frozenset({p})
    assert holds(p, only_p)
    assert not holds(q, only_p)
    assert holds(Not(q), only_p)
    assert holds(Or((p, q)), only_p)
    assert not holds(And((p, q)), only_p)
    assert holds(TRUE, only_p)
    assert not holds(FALSE, only_p)


@given(formulas, states)
def test_a_negation_holds_where_the_formula_does_not(formula: Formula, state: State) -> None:
    assert holds(negation(formula), state) != holds(formula, state)


@given(formulas, states)
def test_parts_hold_together_as_the_formula_does(formula: Formula, state: State) -> None:
    assert all(holds(part, state) for part in conjuncts(formula)) == holds(formula, state)
    assert any(holds(part, state) for part in disjuncts(formula)) == holds(formula, state)
    assert not any(isinstance(part, And) for part in conjuncts(formula))
    assert not any(isinstance(part, Or) for part in disjuncts(formula))


def test_leaves_are_the_atoms_and_equalities() -> None:
    atom, equal = Atom("p", ("?x",)), Equal(("?x", "a"))
    formula = Or((Not(Exists((Variable("?x", "object"),), And((atom, equal)))), ATOMS[0]))
    assert list(leaves(formula)) == [atom, equal, ATOMS[0]]


def test_what_is_not_ground_holds_nowhere() -> None:
    with pytest.raises(TypeError, match="expected a ground formula without quantifiers"):
        holds(Equal(("?x", "a")), frozenset())
