"""The paper's selection rule: options are drawn in proportion to their scores, and plans are rolled out."""

from collections.abc import Sequence
from dataclasses import dataclass
from math import inf
from typing import Generic

import numpy as np

from ictamp_drake.core.checks import check_fields
from ictamp_drake.core.protocols import Estimator, RuleContext
from ictamp_drake.core.types import C
from ictamp_drake.planning.estimates import Estimates
from ictamp_drake.planning.rule import OpenPlan, Option
from ictamp_drake.planning.scores import draw, draw_node, latest_plan_cost, score_high, score_low
from ictamp_drake.planning.tree import RunStep, Tree


@dataclass(frozen=True)
class ProportionalConfig:
    """Constants of the paper's section Heuristics.

    Attributes:
        W: Weight of opening plans against running them: a plan that cost W expansions scores as much as a fresh step
            that is certain to succeed. The paper gives no value. Raise it to leave failing plans sooner. Choose it to
            suit the generator: 30 for breadth-first, 3 for best-first, which expands far fewer nodes.
        floor: Lower bound of the estimated probability, so that no step is ever given up.
        redraw: Whether to draw the configuration anew before each step of a rollout (Algorithm 2, line 3). False
            continues from the configuration just reached.
    """

    W: float = 30.0
    floor: float = 0.1
    redraw: bool = True

    def __post_init__(self) -> None:
        check_fields(self, "planners.completion-tree", W=(0, inf), floor=(0, inf))

    def create(self, context: RuleContext[C]) -> "Proportional[C]":
        """The rule for one search."""
        return Proportional(self, context.estimator)


class Proportional(Generic[C]):
    """Algorithms 1 and 2 with the scores of the paper's section Heuristics.

    After a success the rollout continues with the rest of the plan. Algorithm 2, line 3 draws a configuration of the
    state reached, so the next step starts from any node that holds this rest, drawn in proportion to 1 / (1 + cnt):
    the node just reached weighs 1, older ones less with every attempt they made. After a failure, a finished plan or an
    opening, the rule draws one option: to open a plan or to run one of the known plans (Algorithm 1, lines 3-5). Each
    plan is scored from the node drawn for it, and runs from the same node.
    """

    def __init__(self, config: ProportionalConfig, estimator: Estimator[C]) -> None:
        self._config = config
        self._estimates = Estimates(estimator)

    def choose(self, tree: Tree[C], rng: np.random.Generator) -> Option:
        """Continue the rollout, or else draw one option in proportion to the scores."""
        return self._next_of_rollout(tree, rng) or self._draw_option(tree, rng)

    def _next_of_rollout(self, tree: Tree[C], rng: np.random.Generator) -> RunStep | None:
        reached = tree.reached
        return draw_node(tree, reached.plan, rng) if reached and self._config.redraw else reached

    def _draw_option(self, tree: Tree[C], rng: np.random.Generator) -> Option:
        runs = [draw_node(tree, plan, rng) for plan in tree.open_plans]
        options: list[Option] = [*runs]
        scores = self._scores_low(tree, runs)
        if not tree.exhausted:
            options.append(OpenPlan())
            scores.append(score_high(latest_plan_cost(tree.openings), self._config.W))
        return options[draw(scores, rng)]

    def _scores_low(self, tree: Tree[C], runs: Sequence[RunStep]) -> list[float]:
        estimates = self._estimates.look_up(tree, runs)
        counts = [tree.nodes[run.node].cnt[run.plan] for run in runs]
        return [score_low(P, cnt, self._config.floor) for P, cnt in zip(estimates, counts, strict=True)]
