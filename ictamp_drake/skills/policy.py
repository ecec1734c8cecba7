"""k from the learned policy: several candidates at once, of which the critics choose, and the way of the arm.

What the policy has learned may not fit a scene, so candidates that are refused give way to random ones for a while.
"""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import islice
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from ictamp_drake.core.checks import check_range
from ictamp_drake.core.types import Action, Configuration, FloatArray, Parameter
from ictamp_drake.learning.checkpoint import SHIPPED, SKILLS, check_all
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.observation.state_matrix import Observation, Observer
from ictamp_drake.skills.geometry import hand_poses
from ictamp_drake.skills.uniform import UniformConfig, UniformSampler
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
        trust: how many of the policy's candidates are tried before as many random ones, the best of equally many, have
            their turn, and so on.
        belief: least Q of a random candidate that is tried.
    """

    checkpoints: Path | None = None
    candidates: int = 64
    haste: float = 0.05
    trust: int = 4
    belief: float = 0.5

    def __post_init__(self) -> None:
        check_range("samplers.policy.candidates", self.candidates, 1, 4096)
        check_range("samplers.policy.haste", self.haste, 0, 1)
        check_range("samplers.policy.trust", self.trust, 1, 4096)
        check_range("samplers.policy.belief", self.belief, 0, 1)

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
    """Draws k from π(k | matrix) or at random; of several, those with a great Q(matrix, k) that are near come first."""

    def __init__(
        self, world: World, arm: ArmKinematics, models: Mapping[str, "SkillModel"], config: PolicyConfig
    ) -> None:
        self._world = world
        self._arm = arm
        self._observer = Observer(world.spec)
        self._uniform = UniformSampler(world, UniformConfig())
        self._models = models
        self._config = config

    def draws(self, c: Configuration, action: Action, rng: np.random.Generator) -> Iterator[Parameter]:
        """Any number of k: the best of the policy's candidates, then the best of random ones, and so on."""
        observation = self._observer.observe_all([(c, action)])
        uniform = self._uniform.draws(c, action, rng)
        while True:
            (learned,) = self._models[action.name].draw(observation, self._config.candidates, rng)
            yield from learned if len(learned) == 1 else self._best(c, action, observation, learned)
            random = np.array(list(islice(uniform, self._config.candidates)))
            yield from self._best(c, action, observation, random, self._config.belief)

    def _best(
        self, c: Configuration, action: Action, observation: Observation, k: FloatArray, least: float = 0.0
    ) -> FloatArray:
        """The best of some candidates with at least this Q, the best first, shape (n, 4) -> (at most trust, 4)."""
        (Q,) = self._models[action.name].Q(observation, k[None])
        k, Q = k[least <= Q], Q[least <= Q]
        cost = self._config.haste * self._times(c, action, k) if self._config.haste else 0.0
        return k[np.argsort(cost - Q, kind="stable")][: self._config.trust]

    def _times(self, c: Configuration, action: Action, k: FloatArray) -> FloatArray:
        """How long the arm needs at least to the hand's pose at each k, shape (n, 4) -> (n,) [s]."""
        X_WG = hand_poses(self._world, c, action, k, self._arm.forward(c.q[:7]))
        return np.minimum(self._arm.travel_times(X_WG, c.q[:7]), _OUT_OF_REACH)
