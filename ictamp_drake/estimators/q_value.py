"""STAP's estimate of success: the critics' Q of the k that the policy would take for the next action."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.core.types import FloatArray
from ictamp_drake.estimators.learned import Option, by_skill
from ictamp_drake.learning.checkpoint import SHIPPED, SKILLS, check_all
from ictamp_drake.scenes.checks import check_range
from ictamp_drake.world.observation import Observation, Observer
from ictamp_drake.world.world import World

if TYPE_CHECKING:
    from ictamp_drake.learning.models import SkillModel


@dataclass(frozen=True)
class QValueConfig:
    """Configuration of the critics' estimate.

    Attributes:
        checkpoints: folder of the trained policies and their critics, by default that of the package.
        draws: k drawn from the policy for each option; with 1, Q of a single k as in STAP.
        best: whether the greatest Q of the draws counts, as for the k that the policy's sampler takes, or their mean,
            which is the success to be expected of a single draw.
    """

    checkpoints: Path | None = None
    draws: int = 1
    best: bool = False

    def __post_init__(self) -> None:
        check_range("estimators.q-value.draws", self.draws, 1, 4096)

    def create(self, world: World, skills: object = None) -> "QValue":  # noqa: ARG002  (the same for all estimators)
        """The estimator for one scene.

        Raises:
            IctampError: a checkpoint is missing, damaged or of something else.
        """
        from ictamp_drake.learning.models import load_skill  # noqa: PLC0415  (torch takes long to load)

        folder = self.checkpoints or SHIPPED
        return QValue(self, Observer(world.spec), {skill: load_skill(folder, skill) for skill in SKILLS})

    def check(self) -> None:
        """Raise what `create` would raise because of the checkpoints, without loading torch."""
        check_all(self.checkpoints or SHIPPED, "policy")


class QValue:
    """Q(matrix, k) at draws of the policy, the same draws whenever the same options are asked about."""

    def __init__(self, config: QValueConfig, observer: Observer, models: Mapping[str, "SkillModel"]) -> None:
        self._config = config
        self._observer = observer
        self._models = models

    def estimate(self, options: Sequence[Option]) -> FloatArray:
        """Q of each option, shape (n,)."""
        return by_skill(self._observer, options, self._valued)[0]

    def _valued(self, skill: str, observation: Observation) -> FloatArray:
        model = self._models[skill]
        k = model.draw(observation, self._config.draws, generator(Stream.EVALUATION))
        Q = model.Q(observation, k)
        return np.asarray(Q.max(axis=1) if self._config.best else Q.mean(axis=1))
