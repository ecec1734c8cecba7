"""Adaptive allocation, ours, after the paper's Future Work: the search learns from what its own steps came to.

A plan is judged by all its remaining actions, as the computing time that they are believed to take until each has
succeeded. The plan that is nearest to its end is run, from the node from which it is. Every failure makes it look
further away, until another node, an earlier action or another plan is nearer.
"""

from collections import defaultdict
from dataclasses import dataclass, field
from typing import Generic

import numpy as np

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.protocols import Estimator
from ictamp_drake.core.types import C, Obstruction
from ictamp_drake.planning.beliefs import Beliefs, BeliefsConfig, Mean
from ictamp_drake.planning.rule import OpenPlan, Option
from ictamp_drake.planning.tree import Opening, Step, Tree


@dataclass(frozen=True)
class AdaptiveConfig:
    """Constants of adaptive allocation.

    Attributes:
        beliefs: about success and computing time of steps.
        opening: what opening a plan counts for besides its computing time, since it must be judged from then on [s].
    """

    beliefs: BeliefsConfig = BeliefsConfig()
    opening: float = 0.1

    def __post_init__(self) -> None:
        if not self.opening >= 0:
            raise IctampError(f"opening of adaptive allocation is {self.opening}, but must be 0 or more.")

    def create(self, estimator: Estimator[C]) -> "Adaptive[C]":
        """The rule for one search."""
        return Adaptive(self.opening, Beliefs(self.beliefs, estimator))


class Adaptive(Generic[C]):
    """Runs what is believed to be finished first, and opens a plan when that is likely to save time.

    A new plan is hoped to be as good as the latest one was before anything failed. Whether that comes true is learned,
    for each set of boxes that are to be moved first: W, the worth of opening, is 1 / (2 + openings in vain) of the time
    that such a plan would save, where those in vain are the latest ones, none of which was better than all others when
    it came.
    """

    def __init__(self, opening: float, beliefs: Beliefs[C]) -> None:
        self._opening = opening
        self._beliefs = beliefs
        self._seen = 0
        self._best = np.inf
        self._openings: defaultdict[frozenset[Obstruction], _Openings] = defaultdict(_Openings)
        self._asked: frozenset[Obstruction] = frozenset()

    def choose(self, tree: Tree[C], rng: np.random.Generator) -> Option:  # noqa: ARG002  (nothing is random)
        """The next computational action."""
        news, self._seen = tree.log[self._seen :], len(tree.log)
        for entry in news:
            if isinstance(entry, Step):
                self._beliefs.learn(tree, entry)
        runs = tree.runs
        remaining = self._beliefs.remaining(tree, runs)
        best = min(remaining, default=np.inf)
        for entry in news:
            if isinstance(entry, Opening):
                self._openings[self._asked].add(entry.seconds, improved=best < self._best)
        self._best = best
        if not runs:
            return OpenPlan()
        run = runs[remaining.index(best)]
        self._asked = self._beliefs.obstructions((*tree.way(run.node), *tree.plans[run.plan].actions))
        if not tree.exhausted and self._opening_pays(tree):
            return OpenPlan(self._asked)
        return run

    def _opening_pays(self, tree: Tree[C]) -> bool:
        saved = self._best - self._beliefs.hoped(tree.plans[tree.opened[-1]])
        openings = self._openings[self._asked]
        W = saved / (2 + openings.in_vain)
        return openings.seconds.or_else(0.0) + self._opening < W


@dataclass
class _Openings:
    seconds: Mean = field(default_factory=Mean)
    in_vain: int = 0

    def add(self, seconds: float, *, improved: bool) -> None:
        self.seconds.add(seconds)
        self.in_vain = 0 if improved else self.in_vain + 1
