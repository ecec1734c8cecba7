"""The constant estimator."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.core.errors import Code
from ictamp_drake.core.types import Action, Skeleton
from ictamp_drake.estimators.constant import Constant, ConstantConfig
from tests.refusals import refusal


@given(st.floats(0, 1), st.integers(0, 5))
def test_every_option_gets_the_same_probability(P: float, options: int) -> None:
    plans = [Skeleton((frozenset(), frozenset()), (Action("pick", (str(i),)),)) for i in range(options)]
    estimates = Constant(P).estimate([("c", plan) for plan in plans])
    np.testing.assert_array_equal(estimates, [P] * options)
    assert estimates.dtype == np.float64


@pytest.mark.parametrize("P", [-0.1, 1.1, float("nan")])
def test_what_is_no_probability_is_refused(P: float) -> None:
    with refusal(Code.OUT_OF_RANGE, "estimators.constant.P", value=P):
        ConstantConfig(P)
