"""Valid answers of your own estimators about steps."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.core.types import Skeleton
from ictamp_drake.planning.els import ElsConfig
from ictamp_drake.planning.estimates import ask_estimator
from ictamp_drake.planning.proportional import ProportionalConfig
from ictamp_drake.planning.rule import RuleConfig
from tests.refusals import refusal
from tests.toy_world import RIGHT, UP, ToyConfiguration, ToyWorld, toy_planner

OPTION = ToyConfiguration((0, 0), 0.0), Skeleton((frozenset(),) * 3, (RIGHT, UP))


@dataclass(frozen=True)
class Saying:
    """An estimator that gives the same answer for any steps."""

    values: Any

    def estimate(self, options: Sequence[tuple[ToyConfiguration, Skeleton]]) -> Any:  # noqa: ARG002
        return self.values


@pytest.mark.parametrize("values", [[0, 0.5, 1], (0.0, 0.5, 1.0), np.array([0.0, 0.5, 1.0], dtype=np.float32)])
def test_anything_like_an_array_of_probabilities_will_do(values: object) -> None:
    assert ask_estimator(Saying(values), [OPTION] * 3) == [0.0, 0.5, 1.0]


@pytest.mark.parametrize(
    ("values", "code", "found"),
    [
        ([0.5, 1.7], Code.OUT_OF_RANGE, 1.7),
        ([-0.1, 0.5], Code.OUT_OF_RANGE, -0.1),
        ([0.5, float("nan")], Code.OUT_OF_RANGE, float("nan")),
        ([0.5], Code.WRONG_LENGTH, (1,)),
        ([[0.5], [0.5]], Code.WRONG_LENGTH, (2, 1)),
        (0.5, Code.WRONG_LENGTH, ()),
    ],
)
def test_what_is_no_probability_of_each_step_is_refused(values: object, code: Code, found: object) -> None:
    with refusal(code, "Saying", value=found):
        ask_estimator(Saying(values), [OPTION] * 2)


@pytest.mark.parametrize("rule", [ProportionalConfig(), ElsConfig(weighted=True)])
def test_rules_refuse_what_is_no_probability(rule: RuleConfig) -> None:
    with refusal(Code.OUT_OF_RANGE, "Saying", value=1.7):
        toy_planner(ToyWorld(), estimator=Saying([1.7]), rule=rule).run()
