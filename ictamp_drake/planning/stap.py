"""STAP's method (Agia et al. 2023) as a selection rule: optimize whole plans first, then execute the best."""

from collections import deque
from collections.abc import Mapping
from dataclasses import dataclass
from math import inf
from typing import Generic

import numpy as np

from ictamp_drake.core.checks import check_fields
from ictamp_drake.core.protocols import PlanOptimizer, RuleContext
from ictamp_drake.core.types import C, FloatArray
from ictamp_drake.planning.rule import OpenPlan, Option
from ictamp_drake.planning.tree import ROOT, RunStep, Tree


@dataclass(frozen=True)
class StapConfig:
    """Constants of STAP's planner.

    Attributes:
        extra: Number of actions that a plan may have beyond the shortest plan; the sum is the depth of the plan search.
        plans: Maximum number of plans to optimize.
        draws: Number of rollouts of each plan in one iteration of the cross-entropy method.
        iterations: Number of iterations of the cross-entropy method after the first draws.
    """

    extra: int = 0
    plans: int = 16
    draws: int = 100
    iterations: int = 4

    def __post_init__(self) -> None:
        check_fields(self, "planners.stap", extra=(0, inf), plans=(1, inf), draws=(1, inf), iterations=(0, inf))

    @property
    def estimator(self) -> tuple[str, Mapping[str, object]]:
        """STAP's objective, sought as these constants say."""
        return "q-value", {"horizon": "plan", "best": True, "draws": self.draws, "refinements": self.iterations}

    def create(self, context: RuleContext[C]) -> "Stap[C]":
        """The rule for one search.

        Raises:
            TypeError: The estimator is not a `PlanOptimizer`.
        """
        if not isinstance(context.estimator, PlanOptimizer):
            raise TypeError(f"{type(context.estimator).__name__} does not optimize plans")
        return Stap(self, context.estimator)


class Stap(Generic[C]):
    """Open all plans up to a depth, optimize each from c_0, and execute the best; after a failure, the next best.

    When all plans have failed, all are optimized again.
    """

    def __init__(self, config: StapConfig, optimizer: PlanOptimizer[C]) -> None:
        self._config = config
        self._optimizer = optimizer
        self._ranking: deque[tuple[int, FloatArray]] = deque()
        self._k = np.zeros((0, 4))

    def choose(self, tree: Tree[C], rng: np.random.Generator) -> Option:
        """Open a plan, continue the current one, or begin the next best."""
        if self._wants_plans(tree):
            return OpenPlan()
        if (step := self._next_of_plan(tree)) is not None:
            return step
        if not self._ranking:
            self._ranking.extend(self._rank_plans(tree, rng))
        plan, self._k = self._ranking.popleft()
        return RunStep(ROOT, plan, self._k[0])

    def _wants_plans(self, tree: Tree[C]) -> bool:
        near, known = self._list_near(tree), tree.opened
        return not tree.exhausted and len(near) < self._config.plans and (not near or near[-1] == known[-1])

    def _list_near(self, tree: Tree[C]) -> list[int]:
        """Plans up to the depth, in order of opening."""
        opened = [plan for plan in tree.opened if tree.plans[plan].actions]
        depth = min((len(tree.plans[plan]) for plan in opened), default=0) + self._config.extra
        return [plan for plan in opened if len(tree.plans[plan]) <= depth]

    def _next_of_plan(self, tree: Tree[C]) -> RunStep | None:
        reached = tree.reached
        return reached and reached._replace(k=self._k[tree.nodes[reached.node].depth])

    def _rank_plans(self, tree: Tree[C], rng: np.random.Generator) -> list[tuple[int, FloatArray]]:
        """Rank the plans, each with its parameters, most promising first."""
        plans = self._list_near(tree)
        found = self._optimizer.optimize([(tree.root.c, tree.plans[plan]) for plan in plans], rng)
        order = sorted(range(len(plans)), key=lambda number: -found[number].value)
        return [(plans[number], found[number].k) for number in order]
