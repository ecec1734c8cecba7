"""Success counted instead of estimated: an upper bound for every estimator, at the price of many executions."""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from ictamp_drake.core.checks import check_range
from ictamp_drake.core.protocols import SkillRunner
from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.core.types import Action, Configuration, FloatArray, Skeleton
from ictamp_drake.estimators.context import EstimatorContext


@dataclass(frozen=True)
class MonteCarloConfig:
    """Configuration of counted success.

    Attributes:
        executions: Number of executions of ψ_a in simulation for each estimate.
        seed: Random seed of the parameters k that they draw.
    """

    executions: int = 20
    seed: int = 0

    def __post_init__(self) -> None:
        check_range("estimators.monte-carlo.executions", self.executions, 1, 1e6)
        check_range("estimators.monte-carlo.seed", self.seed, 0, 2**63 - 1)

    def create(self, context: EstimatorContext) -> "MonteCarlo":
        """The estimator for one search, with the skills that the search runs."""
        return MonteCarlo(self, context.skills)


class MonteCarlo:
    """Fraction of successes among executions, counted once for each configuration and action."""

    def __init__(self, config: MonteCarloConfig, skills: SkillRunner[Configuration]) -> None:
        self._config = config
        self._skills = skills
        self._rng = generator(Stream.EVALUATION, config.seed)
        self._known: dict[tuple[Configuration, Action], float] = {}

    def estimate(self, options: Sequence[tuple[Configuration, Skeleton]]) -> FloatArray:
        """Fraction of successes of the first action of each option, shape (len(options),)."""
        return np.array([self._share(c, Skeleton(plan.states[:2], plan.actions[:1])) for c, plan in options])

    def _share(self, c: Configuration, step: Skeleton) -> float:
        (action,) = step.actions
        if (c, action) not in self._known:
            runs = (self._skills.attempt(c, step, self._rng) for _ in range(self._config.executions))
            self._known[c, action] = float(np.mean([attempt.succeeded for attempt in runs]))
        return self._known[c, action]
