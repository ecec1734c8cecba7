"""k from the learned policy: several candidates at once, ranked by the critics and by the arm's travel time.

The learned policy may not fit a scene, so random candidates take turns with those of the policy. Where an action is
unlike those in training, candidates from geometry come first.
"""

from collections.abc import Iterator, Mapping
from itertools import islice
from typing import TYPE_CHECKING

import numpy as np

from ictamp_drake.core.types import Action, Configuration, FloatArray, Parameter
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.observation.state_matrix import Observation, Observer
from ictamp_drake.skills.config import PolicyConfig, UniformConfig
from ictamp_drake.skills.geometric import GeometricSampler
from ictamp_drake.skills.geometry import hand_poses
from ictamp_drake.skills.neighbours import is_covered
from ictamp_drake.skills.uniform import UniformSampler
from ictamp_drake.world.world import World

if TYPE_CHECKING:
    from ictamp_drake.learning.models import SkillModel

LEARNED_SIDES = (0.03, 0.14)
"""Sides of boxes for which the policy works [m]: those of the level `varied`, little more than in training."""
LEARNED_TOP = 0.14
"""Shortest side of the top of a support in training, and of a place for which the policy works [m]."""
_OUT_OF_REACH = 60.0
"""Travel time assumed for a hand pose that the arm cannot reach [s]."""


class PolicySampler:
    """Draws k from π(k | matrix) or at random. Those with a high Q(matrix, k) and near the arm come first."""

    def __init__(
        self, world: World, arm: ArmKinematics, models: Mapping[str, "SkillModel"], config: PolicyConfig
    ) -> None:
        self._world = world
        self._arm = arm
        self._observer = Observer(world.spec)
        self._uniform = UniformSampler(world, UniformConfig())
        self._geometric = GeometricSampler(world, arm)
        self._models = models
        self._config = config

    def draws(self, c: Configuration, action: Action, rng: np.random.Generator) -> Iterator[Parameter]:
        """Any number of k: the best of the policy's candidates, then the best random ones, in turns."""
        observation = self._observer.observe_all([(c, action)])
        uniform = self._uniform.draws(c, action, rng)
        geometric = iter(()) if self.applies(c, action) else self._geometric.draws(c, action, rng)
        while True:
            yield from islice(geometric, self._config.trust)
            (learned,) = self._models[action.name].draw(observation, self._config.candidates, rng)
            yield from learned if len(learned) == 1 else self._best(c, action, observation, learned)
            random = np.array(list(islice(uniform, self._config.candidates)))
            yield from self._best(c, action, observation, random, self._config.belief)

    def applies(self, c: Configuration, action: Action) -> bool:
        """Whether the policy was trained for the action.

        It learned from the Panda, boxes and supports of some sizes, no region, and no support above the box.
        """
        spec, (box, place) = self._world.spec, action.args
        if spec.robot != self._config.robot:
            return False
        least, most = LEARNED_SIDES
        sides = [side for name in action.args if name in spec.boxes for side in spec.boxes[name].size]
        if min(sides) < least or max(sides) > most:
            return False
        if action.name == "place":
            return place in spec.boxes or (place in spec.supports and min(spec.supports[place].size[:2]) >= LEARNED_TOP)
        return not is_covered(self._world, c, box)

    def _best(
        self, c: Configuration, action: Action, observation: Observation, k: FloatArray, least: float = 0.0
    ) -> FloatArray:
        """Candidates with a Q of at least `least`, the best first, shape (n, 4) -> (at most `trust`, 4)."""
        (Q,) = self._models[action.name].Q(observation, k[None])
        k, Q = k[least <= Q], Q[least <= Q]
        cost = self._config.haste * self._times(c, action, k) if self._config.haste else 0.0
        return k[np.argsort(cost - Q, kind="stable")][: self._config.trust]

    def _times(self, c: Configuration, action: Action, k: FloatArray) -> FloatArray:
        """Lower bound of the arm's travel time to the hand pose of each k, shape (n, 4) -> (n,) [s]."""
        X_WG = hand_poses(self._world, c, action, k, self._arm.forward(c.q))
        return np.minimum(self._arm.travel_times(X_WG, c.q), _OUT_OF_REACH)
