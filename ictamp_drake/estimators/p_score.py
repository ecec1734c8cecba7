"""P(c, a), learned from outcomes: a calibrated ensemble over the primitive state matrix (paper, Success Prediction).

The outcome depends mostly on the k that the policy happens to draw. The ensemble is therefore given k when it learns,
and P is its mean over a few k that represent the policy's distribution. An outcome teaches more this way than a P
without k could learn from it. A step that may draw several k fails when all of them do.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, ClassVar, NamedTuple

import numpy as np

from ictamp_drake.core.checks import check_range
from ictamp_drake.core.types import FloatArray
from ictamp_drake.estimators.context import EstimatorContext
from ictamp_drake.estimators.learned import ConfiguredPlan, score_by_skill
from ictamp_drake.learning.checkpoint import SHIPPED, SKILLS, check_all
from ictamp_drake.observation.situations import Numbers
from ictamp_drake.observation.state_matrix import Observation, Observer
from ictamp_drake.robots.spec import DEFAULT

if TYPE_CHECKING:
    from ictamp_drake.learning.models import EstimatorModel


@dataclass(frozen=True)
class PScoreConfig:
    """Configuration of the learned estimator.

    Attributes:
        checkpoints: Folder of the trained estimators. The default is the package's own.
        draws: Number of the policy's k over which the mean is taken.
    """

    checkpoints: Path | None = None
    draws: int = 64
    robot: ClassVar[str] = DEFAULT
    stand_in: ClassVar[str] = "constant"

    def __post_init__(self) -> None:
        check_range("estimators.p-score.draws", self.draws, 1, 1e4)

    def create(self, context: EstimatorContext) -> "PScore":
        """The estimator for one scene, for steps with the skills that the search runs.

        Raises:
            IctampError: A checkpoint is missing, damaged or of another kind.
        """
        from ictamp_drake.learning.models import load_estimator  # noqa: PLC0415  (torch is slow to load)

        folder = self.checkpoints or SHIPPED
        models = {skill: load_estimator(folder, skill) for skill in SKILLS}
        return PScore(Observer(context.world.spec), models, self.draws, context.skills.draws)

    def check(self) -> None:
        """Check the checkpoints and raise the errors of `create`, without loading torch."""
        check_all(self.checkpoints or SHIPPED, "estimator")


class EnsembleEstimate(NamedTuple):
    """P and its uncertainty, mean and standard deviation over the ensemble, each of shape (n,)."""

    P: FloatArray
    std: FloatArray


class PScore:
    """Mean of an ensemble, computed for all options of a skill in one call."""

    def __init__(self, observer: Observer, models: Mapping[str, "EstimatorModel"], draws: int, tries: int) -> None:
        self._observer = observer
        self._models = models
        self._draws = draws
        self._tries = tries

    def estimate(self, options: Sequence[ConfiguredPlan]) -> FloatArray:
        """P of each option, shape (n,)."""
        return self.estimate_with_spread(options).P

    def estimate_with_spread(self, options: Sequence[ConfiguredPlan]) -> EnsembleEstimate:
        """P of each option, and its standard deviation over the ensemble."""
        if not options:
            return EnsembleEstimate(np.zeros(0), np.zeros(0))
        steps = [(c, plan.actions[0]) for c, plan in options]
        seen, actions = self._observer.observe_all(steps), [action for _, action in steps]
        return EnsembleEstimate(*score_by_skill(actions, seen, self._believe).T)

    def _believe(self, skill: str, part: Observation, _: Numbers) -> FloatArray:
        return self._models[skill].believe(part, self._draws, self._tries).T
