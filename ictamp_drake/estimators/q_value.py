"""STAP's estimate of success: the critics' Q of the k that the policy would draw, for the next action or the plan."""

from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import ClassVar, Literal

import numpy as np

from ictamp_drake.core.checks import check_range
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.protocols import PlanParameters
from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.core.types import FloatArray
from ictamp_drake.estimators.context import EstimatorContext
from ictamp_drake.estimators.imagination import Imagination, Rollouts, refine
from ictamp_drake.estimators.learned import ConfiguredPlan
from ictamp_drake.learning.checkpoint import SHIPPED, SKILLS, check_all
from ictamp_drake.observation.state_matrix import Observer
from ictamp_drake.robots.spec import DEFAULT


@dataclass(frozen=True)
class QValueConfig:
    """Configuration of the critics' estimate.

    With the horizon "plan" it is STAP's objective, the product Q(c, k_1) Q(c', k_2) ... along the rest of the plan.
    Learned dynamics predict where a successful step leaves its box. STAP seeks the k that maximize this product by the
    cross-entropy method, starting from its policies. Here k are drawn from the policies (shooting), `best` picks the
    rollout with the largest product, and `refinements` are iterations of that method after it. Q is already a
    probability and needs no clipping.

    Attributes:
        checkpoints: Folder of the trained policies and their critics, and of the dynamics if the horizon is the plan.
            The default is the package's own.
        draws: Number of k drawn from the policy for each option, each with a rollout of the plan.
        best: Whether the largest value of the draws counts, which matches a sampler that ranks its draws. Otherwise
            the mean counts, which is the expected success of a single draw.
        horizon: Steps that Q covers: step for the next action alone, plan for the product along the rest of the plan.
        refinements: Number of iterations of the cross-entropy method after the draws. They need `best`.
        critics: Critics that give Q: policy for those that the policies were trained on, estimator for those of P,
            trained on outcomes of the policies. The mean of the latter over many draws is P.
    """

    checkpoints: Path | None = None
    draws: int = 1
    best: bool = False
    horizon: Literal["step", "plan"] = "step"
    refinements: int = 0
    critics: Literal["policy", "estimator"] = "policy"
    robot: ClassVar[str] = DEFAULT
    stand_in: ClassVar[str] = "constant"

    def __post_init__(self) -> None:
        check_range("estimators.q-value.draws", self.draws, 1, 4096)
        check_range("estimators.q-value.refinements", self.refinements, 0, 1000)
        if self.refinements and not self.best:
            problem = "refinements need the best of the draws, got {value} without it"
            raise IctampError(
                Code.CONFLICT,
                problem,
                field="estimators.q-value.refinements",
                value=self.refinements,
                advice="set --estimators.q-value.best",
            )

    def create(self, context: EstimatorContext) -> "QValue":
        """The estimator for one scene.

        Raises:
            IctampError: A checkpoint is missing, damaged or of another kind.
        """
        from ictamp_drake.learning.models import load_dynamics, load_skill  # noqa: PLC0415  (torch is slow to load)

        folder, ahead = self.checkpoints or SHIPPED, self.horizon == "plan"
        learned = {skill: load_skill(folder, skill, self.critics) for skill in SKILLS}
        dynamics = {skill: load_dynamics(folder, skill) for skill in SKILLS if ahead}
        imagination = Imagination(Observer(context.world.spec), learned, dynamics, depth=None if ahead else 1)
        return QValue(self, imagination, context.world.spec.seed)

    def check(self) -> None:
        """Check the checkpoints and raise the errors of `create`, without loading torch."""
        check_all(self.checkpoints or SHIPPED, self.critics)
        if self.horizon == "plan":
            check_all(self.checkpoints or SHIPPED, "dynamics")


class QValue:
    """Q at draws of the policy. The same options of a scene always get the same draws."""

    def __init__(self, config: QValueConfig, imagination: Imagination, seed: int) -> None:
        self._config = config
        self._imagination = imagination
        self._seed = seed

    def estimate(self, options: Sequence[ConfiguredPlan]) -> FloatArray:
        """Q of each option, or the product of Q along its plan, shape (n,)."""
        if not options:
            return np.zeros(0)
        product = self._rollouts(options, generator(Stream.EVALUATION, self._seed)).product
        return np.asarray(product.max(axis=1) if self._config.best else product.mean(axis=1))

    def optimize(self, options: Sequence[ConfiguredPlan], rng: np.random.Generator) -> list[PlanParameters]:
        """Parameters of the rollout of each plan with the largest product of Q."""
        rollouts = self._rollouts(options, rng)
        best = rollouts.product.argmax(axis=1)
        return [
            PlanParameters(float(rollouts.product[number, run]), rollouts.k[number, run, : len(plan)])
            for number, (run, (_, plan)) in enumerate(zip(best, options, strict=True))
        ]

    def _rollouts(self, options: Sequence[ConfiguredPlan], rng: np.random.Generator) -> Rollouts:
        rollouts = self._imagination.run(options, self._config.draws, rng)
        for _ in range(self._config.refinements):
            rollouts = self._imagination.run(options, self._config.draws, rng, refine(rollouts, rng))
        return rollouts
