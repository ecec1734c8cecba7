"""k from the learned policy: several candidates at once, of which the critics choose."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ictamp_drake.core.types import Action, Configuration, Parameter
from ictamp_drake.learning.checkpoint import SHIPPED, SKILLS, check_all
from ictamp_drake.scenes.checks import check_range
from ictamp_drake.world.observation import Observer
from ictamp_drake.world.world import World

if TYPE_CHECKING:
    from ictamp_drake.learning.models import SkillModel


@dataclass(frozen=True)
class PolicyConfig:
    """How k is drawn from the learned policy.

    Attributes:
        checkpoints: folder of the trained policies, by default that of the package.
        candidates: drawn for one attempt, which tries them in the order of their Q until motion planning refuses none
            (`skills.draws` says how many it tries at most); 1 is the paper's way, a plain draw.
    """

    checkpoints: Path | None = None
    candidates: int = 64

    def __post_init__(self) -> None:
        check_range("samplers.policy.candidates", self.candidates, 1, 4096)

    def create(self, world: World, arm: object = None) -> "PolicySampler":  # noqa: ARG002  (the same for all samplers)
        """The sampler for one scene.

        Raises:
            IctampError: a checkpoint is missing, damaged or of something else.
        """
        from ictamp_drake.learning.models import load_skill  # noqa: PLC0415  (torch takes long to load)

        folder = self.checkpoints or SHIPPED
        models = {skill: load_skill(folder, skill) for skill in SKILLS}
        return PolicySampler(Observer(world.spec), models, self.candidates)

    def check(self) -> None:
        """Raise what `create` would raise because of the checkpoints, without loading torch."""
        check_all(self.checkpoints or SHIPPED, "policy")


class PolicySampler:
    """Draws k from π(k | matrix), the best of several by Q(matrix, k)."""

    def __init__(self, observer: Observer, models: Mapping[str, "SkillModel"], candidates: int) -> None:
        self._observer = observer
        self._models = models
        self._candidates = candidates

    def draws(self, c: Configuration, action: Action, rng: np.random.Generator) -> Iterator[Parameter]:
        """Any number of k: all candidates, the greatest Q first, then others."""
        while True:
            yield from self._ranked(c, action, rng)

    def _ranked(self, c: Configuration, action: Action, rng: np.random.Generator) -> Sequence[Parameter]:
        model = self._models[action.name]
        observation = self._observer.observe_all([(c, action)])
        k = model.draw(observation, self._candidates, rng)
        if self._candidates == 1:
            return list(k[0])
        return list(k[0, np.argsort(-model.Q(observation, k)[0], kind="stable")])
