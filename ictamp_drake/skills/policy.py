"""k from the learned policy: several candidates at once, of which the critics choose, and the way of the arm."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ictamp_drake.core.types import Action, Configuration, FloatArray, Parameter
from ictamp_drake.learning.checkpoint import SHIPPED, SKILLS, check_all
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.scenes.checks import check_range
from ictamp_drake.skills.geometry import hand_poses
from ictamp_drake.world.observation import Observer
from ictamp_drake.world.world import World

if TYPE_CHECKING:
    from ictamp_drake.learning.models import SkillModel

_OUT_OF_REACH = 60.0
"""Time that a hand pose without a posture of the arm counts as [s]."""


@dataclass(frozen=True)
class PolicyConfig:
    """How k is drawn from the learned policy.

    Attributes:
        checkpoints: folder of the trained policies, by default that of the package.
        candidates: drawn for one attempt, which tries the best first until motion planning refuses none
            (`skills.draws` says how many it tries at most); 1 is the paper's way, a plain draw.
        haste: what it is worth, in probability of success, that the arm is there a second sooner [1/s]; with 0, Q
            alone says which candidate is the best.
    """

    checkpoints: Path | None = None
    candidates: int = 64
    haste: float = 0.05

    def __post_init__(self) -> None:
        check_range("samplers.policy.candidates", self.candidates, 1, 4096)
        check_range("samplers.policy.haste", self.haste, 0, 1)

    def create(self, world: World, arm: ArmKinematics) -> "PolicySampler":
        """The sampler for one scene.

        Raises:
            IctampError: a checkpoint is missing, damaged or of something else.
        """
        from ictamp_drake.learning.models import load_skill  # noqa: PLC0415  (torch takes long to load)

        folder = self.checkpoints or SHIPPED
        models = {skill: load_skill(folder, skill) for skill in SKILLS}
        return PolicySampler(world, arm, models, self)

    def check(self) -> None:
        """Raise what `create` would raise because of the checkpoints, without loading torch."""
        check_all(self.checkpoints or SHIPPED, "policy")


class PolicySampler:
    """Draws k from π(k | matrix); of several, those with a great Q(matrix, k) that are near come first."""

    def __init__(
        self, world: World, arm: ArmKinematics, models: Mapping[str, "SkillModel"], config: PolicyConfig
    ) -> None:
        self._world = world
        self._arm = arm
        self._observer = Observer(world.spec)
        self._models = models
        self._config = config

    def draws(self, c: Configuration, action: Action, rng: np.random.Generator) -> Iterator[Parameter]:
        """Any number of k: all candidates, the best first, then others."""
        while True:
            yield from self._ranked(c, action, rng)

    def _ranked(self, c: Configuration, action: Action, rng: np.random.Generator) -> Sequence[Parameter]:
        model = self._models[action.name]
        observation = self._observer.observe_all([(c, action)])
        (k,) = model.draw(observation, self._config.candidates, rng)
        if len(k) == 1:
            return list(k)
        (Q,) = model.Q(observation, k[None])
        cost = self._config.haste * self._times(c, action, k) if self._config.haste else 0.0
        return list(k[np.argsort(cost - Q, kind="stable")])

    def _times(self, c: Configuration, action: Action, k: FloatArray) -> FloatArray:
        """How long the arm needs at least to the hand's pose at each k, shape (n, 4) -> (n,) [s]."""
        X_WG = hand_poses(self._world, c, action, k, self._arm.forward(c.q[:7]))
        return np.minimum(self._arm.travel_times(X_WG, c.q[:7]), _OUT_OF_REACH)
