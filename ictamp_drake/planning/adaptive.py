"""Adaptive allocation, our extension of the paper's Future Work: the search learns from the outcomes of its own steps.

A plan is rated by its remaining effort: the expected effort until each of its remaining actions has succeeded. The rule
runs the plan and node with the least remaining effort. Every failure raises the estimate, until another node, an
earlier action or another plan is cheaper.
"""

from collections import defaultdict
from dataclasses import dataclass, field
from math import inf
from typing import Generic

import numpy as np

from ictamp_drake.core.checks import check_fields
from ictamp_drake.core.protocols import RuleContext
from ictamp_drake.core.types import C, Obstruction
from ictamp_drake.planning.beliefs import Beliefs, BeliefsConfig, Mean
from ictamp_drake.planning.rule import OpenPlan, Option
from ictamp_drake.planning.tree import Opening, RunStep, Step, Tree


@dataclass(frozen=True)
class AdaptiveConfig:
    """Constants of adaptive allocation.

    Attributes:
        beliefs: Constants of the beliefs about success and effort of steps.
        opening: Effort of opening a plan, besides its expansions [s]. It covers later evaluations of the plan.
        expanding: Effort of one expansion of the plan generator [s].
    """

    beliefs: BeliefsConfig = BeliefsConfig()
    opening: float = 0.1
    expanding: float = 3e-5

    def __post_init__(self) -> None:
        check_fields(self, "planners.adaptive", opening=(0, inf), expanding=(0, inf))

    def create(self, context: RuleContext[C]) -> "Adaptive[C]":
        """The rule for one search."""
        return Adaptive(self, Beliefs(self.beliefs, context.estimator))


class Adaptive(Generic[C]):
    """Run the step with the least expected effort, and open a plan when that is likely to save effort.

    The rule expects a new plan to be as good as the latest one was before any failure. It learns how often this holds,
    separately for each set of boxes to move first: W, the worth of opening, is the effort that such a plan would save,
    divided by 2 + `in_vain`. `in_vain` counts the latest consecutive openings that did not produce the new best plan.
    """

    def __init__(self, config: AdaptiveConfig, beliefs: Beliefs[C]) -> None:
        self._config = config
        self._beliefs = beliefs
        self._seen = 0
        self._runs: list[RunStep] = []
        self._openings: defaultdict[frozenset[Obstruction], _Openings] = defaultdict(_Openings)
        self._asked: frozenset[Obstruction] = frozenset()

    def choose(self, tree: Tree[C], _: np.random.Generator) -> Option:
        """The next computational action."""
        runs = tree.runs
        if not runs:
            return OpenPlan()
        news, self._seen = tree.log[self._seen :], len(tree.log)
        for entry in news:
            if isinstance(entry, Step):
                self._beliefs.learn(tree, entry)
        efforts = self._beliefs.estimate_effort(tree, runs)
        best = min(efforts)
        run = runs[efforts.index(best)]
        for entry in news:
            if isinstance(entry, Opening):
                self._openings[self._asked].add(entry, improved=run not in self._runs)
        self._runs = runs
        self._asked = self._beliefs.obstructions((*tree.way(run.node), *tree.plans[run.plan].actions))
        return OpenPlan(self._asked) if self._opening_pays(tree, best) else run

    def _opening_pays(self, tree: Tree[C], best: float) -> bool:
        openings = self._openings[self._asked]
        if tree.exhausted and (not self._asked or openings.ended):
            return False
        saved = best - self._beliefs.estimate_prior_effort(tree.plans[tree.opened[-1]])
        W = saved / (2 + openings.in_vain)
        return self._config.opening + self._config.expanding * openings.expanded.value_or(0.0) < W


@dataclass
class _Openings:
    """Record of the openings for one set of boxes to move first; `ended` when the latest one brought no plan."""

    expanded: Mean = field(default_factory=Mean)
    in_vain: int = 0
    ended: bool = False

    def add(self, opening: Opening, *, improved: bool) -> None:
        self.expanded.add(opening.expanded)
        self.in_vain = 0 if improved else self.in_vain + 1
        self.ended = opening.plan is None
