"""Rollouts of plans without a simulator: policies choose k, critics estimate success, learned dynamics the result."""

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from ictamp_drake.core.types import Action, FloatArray
from ictamp_drake.estimators.learned import ConfiguredPlan, score_by_skill
from ictamp_drake.observation.situations import Numbers, Situations
from ictamp_drake.observation.state_matrix import Observation, Observer

if TYPE_CHECKING:
    from ictamp_drake.learning.models import DynamicsModel, SkillModel

ELITES = 0.25
"""Fraction of the rollouts that the cross-entropy method keeps."""


class Rollouts(NamedTuple):
    """Several runs of each of n plans, the longest of which has L steps.

    Attributes:
        k: Parameters of each step, zero after a plan's end, shape (n, runs, L, 4).
        product: Product of Q along the plan, shape (n, runs).
    """

    k: FloatArray
    product: FloatArray


class Imagination:
    """Runs the plans of one scene without a simulator.

    Args:
        observer: Observer that makes the matrices of the scene.
        skills: Policies and critics by skill.
        dynamics: Dynamics by skill, which predict what the skill leaves. A depth of 1 needs none.
        depth: Maximum number of steps run of each plan. If None, all are run.
    """

    def __init__(
        self,
        observer: Observer,
        skills: Mapping[str, "SkillModel"],
        dynamics: Mapping[str, "DynamicsModel"],
        depth: int | None = None,
    ) -> None:
        self._observer = observer
        self._skills = skills
        self._dynamics = dynamics
        self._depth = depth

    def run(
        self, options: Sequence[ConfiguredPlan], runs: int, rng: np.random.Generator, given: FloatArray | None = None
    ) -> Rollouts:
        """Several runs of each option's plan, computed together step by step.

        Args:
            options: Configurations with plans, n of them and at least one.
            runs: Number of runs of each plan.
            rng: Random numbers of the policies' draws.
            given: Parameters k to use instead of draws, in the shape of the result.
        """
        plans, n = [plan.actions[: self._depth] for _, plan in options], len(options)
        longest = max(map(len, plans))
        k = np.zeros((n * runs, longest, 4)) if given is None else given.reshape(n * runs, longest, 4)
        product = np.ones(n * runs)
        situations = self._observer.situations([c for c, _ in options])
        of = np.arange(n * runs).reshape(n, runs)  # the runs in each situation; those of a plan share the first one
        for step in range(longest):
            going = np.flatnonzero([step < len(plans[number]) for number in of[:, 0] // runs])
            of, situations = of[going], situations.select(going)
            actions = [plans[number][step] for number in of[:, 0] // runs]
            seen = self._observer.see(situations, self._observer.steps(actions))
            if given is None:
                k[of, step] = self._draw(actions, seen, of.shape[1], rng)
            product[of] *= self._Q(actions, seen, k[of, step])
            if step + 1 < longest:
                situations = self._predict_after(situations, actions, seen, k[of, step])
                of = of.reshape(-1, 1)
        return Rollouts(k.reshape(n, runs, longest, 4), product.reshape(n, runs))

    def _draw(self, actions: Sequence[Action], seen: Observation, count: int, rng: np.random.Generator) -> FloatArray:
        """Draws of the policies, `count` for each situation, shape (m, count, 4)."""
        return score_by_skill(actions, seen, lambda skill, part, _: self._skills[skill].draw(part, count, rng))

    def _Q(self, actions: Sequence[Action], seen: Observation, k: FloatArray) -> FloatArray:
        """Q of several k in each situation, shape (m, count, 4) -> (m, count)."""
        return score_by_skill(actions, seen, lambda skill, part, at: self._skills[skill].Q(part, k[at]))

    def _predict_after(
        self, situations: Situations, actions: Sequence[Action], seen: Observation, k: FloatArray
    ) -> Situations:
        """Situations that each of several k leaves, one situation after the other: k of shape (m, count, 4)."""
        count, k = k.shape[1], k.reshape(-1, 4)
        each = np.repeat(np.arange(len(actions)), count)
        actions = [action for action in actions for _ in range(count)]
        seen = Observation(seen.matrix[each], seen.mask[each])

        def predict_pose(skill: str, part: Observation, at: Numbers) -> FloatArray:
            return self._dynamics[skill].predict(part, k[at])

        return situations.select(each).predict_after(
            self._observer.steps(actions), k, score_by_skill(actions, seen, predict_pose)
        )


def refine(rollouts: Rollouts, rng: np.random.Generator) -> FloatArray:
    """k of the best rollouts, and draws around them: an iteration of the cross-entropy method, shape (n, runs, L, 4).

    The Gaussian of each plan has no covariances, as in STAP. Yaw is relative to that of the best rollout, and draws of
    it stay on the circle.
    """
    n, runs = rollouts.product.shape
    count = max(1, round(ELITES * runs))
    order = np.argsort(-rollouts.product, axis=1, kind="stable")[:, :count]
    elite = np.take_along_axis(rollouts.k, order[..., None, None], axis=1)
    offset = elite - elite[:, :1]
    offset[..., 3] = _wrap_angle(offset[..., 3])
    mean, std = offset.mean(axis=1, keepdims=True), offset.std(axis=1, keepdims=True)
    drawn = elite[:, :1] + mean + std * rng.normal(size=(n, runs - count, *elite.shape[2:]))
    drawn[..., 3] = _wrap_angle(drawn[..., 3])
    return np.concatenate([elite, drawn], axis=1)


def _wrap_angle(angle: FloatArray) -> FloatArray:
    return (angle + np.pi) % (2 * np.pi) - np.pi
