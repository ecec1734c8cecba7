"""Adaptive allocation, ours, after the paper's Future Work: the search learns from what its own steps came to.

A plan is judged by all its remaining actions, as the computing time that they are believed to take until each has
succeeded. The plan that is nearest to its end is run, from the node from which it is. Every failure makes it look
further away, until another node, an earlier action or another plan is nearer.
"""

from dataclasses import dataclass
from typing import Generic

import numpy as np

from ictamp_drake.core.protocols import Estimator
from ictamp_drake.core.types import C
from ictamp_drake.planning.beliefs import Beliefs, BeliefsConfig
from ictamp_drake.planning.rule import OpenPlan, Option, RunStep
from ictamp_drake.planning.tree import ROOT, Opening, Tree


@dataclass(frozen=True)
class AdaptiveConfig:
    """Constants of adaptive allocation.

    Attributes:
        beliefs: about success and computing time of steps.
    """

    beliefs: BeliefsConfig = BeliefsConfig()

    def create(self, estimator: Estimator[C]) -> "Adaptive[C]":
        """The rule for one search."""
        return Adaptive(Beliefs(self.beliefs, estimator))


class Adaptive(Generic[C]):
    """Runs what is believed to be finished first, and opens a plan when that is likely to save time.

    A new plan is hoped to be as good as the latest one was before anything failed. How often that comes true is
    learned: W, the worth of opening, is (1 + improvements) / (2 + openings) times the time that such a plan would save,
    where an improvement is a plan that was better than all others when it came.
    """

    def __init__(self, beliefs: Beliefs[C]) -> None:
        self._beliefs = beliefs
        self._seen = 0
        self._best = np.inf
        self._openings: list[float] = []
        self._improvements = 0

    def choose(self, tree: Tree[C], rng: np.random.Generator) -> Option:  # noqa: ARG002  (nothing is random)
        """The next computational action."""
        self._take_in(tree)
        runs = [RunStep(*run) for run in tree.runs]
        remaining = self._beliefs.remaining(tree, runs)
        self._best = min(remaining, default=np.inf)
        if not runs or (not tree.exhausted and self._opening_pays(tree)):
            return OpenPlan()
        return runs[remaining.index(self._best)]

    def _take_in(self, tree: Tree[C]) -> None:
        for entry in tree.log[self._seen :]:
            if isinstance(entry, Opening):
                self._openings.append(entry.seconds)
                self._improvements += self._improves(tree, entry.plan)
            else:
                self._beliefs.learn(tree, entry)
        self._seen = len(tree.log)

    def _improves(self, tree: Tree[C], plan: int | None) -> bool:
        if plan is None or not tree.plans[plan].actions:
            return False
        return self._beliefs.remaining(tree, [RunStep(ROOT, plan)])[0] < self._best

    def _opening_pays(self, tree: Tree[C]) -> bool:
        saved = self._best - self._beliefs.hoped(tree.plans[tree.opened[-1]])
        W = (1 + self._improvements) / (2 + len(self._openings)) * saved
        return bool(np.mean(self._openings) < W)
