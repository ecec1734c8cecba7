"""Estimator without any knowledge: every step is as likely to succeed as every other."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass

import numpy as np

from ictamp_drake.core.checks import check_range
from ictamp_drake.core.types import FloatArray, Skeleton
from ictamp_drake.estimators.context import EstimatorContext


@dataclass(frozen=True)
class ConstantConfig:
    """Configuration of the constant estimator.

    Attributes:
        P: Probability given to every step, in [0, 1]. With 1, which is optimism where nothing is known,
            Score_low is 1 / (1 + cnt): only attempts count. A lower P opens more high-level plans.
    """

    P: float = 1.0

    def __post_init__(self) -> None:
        check_range("estimators.constant.P", self.P, 0, 1)

    def create(self, _: EstimatorContext) -> "Constant":
        """The estimator, the same in every scene."""
        return Constant(self.P)


@dataclass(frozen=True)
class Constant:
    """P(c, a) = P, the baseline of every learned estimator."""

    P: float

    def estimate(self, options: Sequence[tuple[Hashable, Skeleton]]) -> FloatArray:
        """P of each option, shape (len(options),)."""
        return np.full(len(options), self.P)
