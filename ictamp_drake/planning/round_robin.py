"""Round robin, the baseline of the paper's Table 1: every known plan gets one attempt, round after round."""

from collections import deque
from dataclasses import dataclass
from typing import Generic

import numpy as np

from ictamp_drake.core.protocols import RuleContext
from ictamp_drake.core.types import C
from ictamp_drake.planning.rule import OpenPlan, Option
from ictamp_drake.planning.scores import draw_node
from ictamp_drake.planning.tree import Tree


@dataclass(frozen=True)
class RoundRobinConfig:
    """Configuration of round robin, which has no settings."""

    def create(self, _: RuleContext[C]) -> "RoundRobin[C]":
        """The rule for one search."""
        return RoundRobin()


class RoundRobin(Generic[C]):
    """Attempt every plan known at the start of a round once, those nearest to the goal first, then open one more.

    The node that attempts a plan is drawn in proportion to 1 / (1 + cnt) among the nodes that hold the plan.
    """

    def __init__(self) -> None:
        self._round: deque[int | None] = deque()  # numbers of plans, None for opening one

    def choose(self, tree: Tree[C], rng: np.random.Generator) -> Option:
        """Choose the next option of the round."""
        if not self._round:
            plans = sorted(tree.open_plans, key=lambda number: len(tree.plans[number]))
            self._round.extend(plans)
            self._round.extend([] if tree.exhausted else [None])
        plan = self._round.popleft()
        if plan is not None and not tree.holders[plan]:
            return self.choose(tree, rng)
        return OpenPlan() if plan is None else draw_node(tree, plan, rng)
