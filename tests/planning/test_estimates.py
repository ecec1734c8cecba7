"""Valid answers of your own estimators about steps."""

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.types import Skeleton
from ictamp_drake.planning.els import ElsConfig
from ictamp_drake.planning.estimates import ask_estimator
from ictamp_drake.planning.proportional import ProportionalConfig
from ictamp_drake.planning.rule import RuleConfig
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
    ("values", "sentence"),
    [
        ([0.5, 1.7], r"P of Saying is 1\.7, but must be between 0 and 1\."),
        ([-0.1, 0.5], r"P of Saying is -0\.1, but"),
        ([0.5, float("nan")], "P of Saying is nan, but"),
        ([0.5], r"P of Saying is of shape \(1,\), but must be of \(2,\), one an option\."),
        ([[0.5], [0.5]], r"P of Saying is of shape \(2, 1\), but"),
        (0.5, r"P of Saying is of shape \(\), but"),
    ],
)
def test_what_is_no_probability_of_each_step_is_refused(values: object, sentence: str) -> None:
    with pytest.raises(IctampError, match=sentence):
        ask_estimator(Saying(values), [OPTION] * 2)


@pytest.mark.parametrize("rule", [ProportionalConfig(), ElsConfig(weighted=True)])
def test_rules_refuse_what_is_no_probability(rule: RuleConfig) -> None:
    with pytest.raises(IctampError, match=r"P of Saying is 1\.7"):
        toy_planner(ToyWorld(), estimator=Saying([1.7]), rule=rule).run()
