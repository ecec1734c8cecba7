"""Formulas of the paper's section Heuristics, and draws in proportion to them."""

from bisect import bisect
from collections.abc import Iterable, Sequence
from itertools import accumulate

import numpy as np

from ictamp_drake.core.types import C
from ictamp_drake.planning.tree import Opening, RunStep, Tree


def latest_plan_cost(openings: Iterable[Opening]) -> int:
    """L_nodes: nodes expanded for the most recent plan, 1 before the first (paper, Heuristics).

    Expansions of a call without a plan count toward the next plan. A plan without expansions counts as one.
    """
    cost, since = 1, 0
    for opening in openings:
        since += opening.expanded
        if opening.plan is not None:
            cost, since = max(1, since), 0
    return cost


def score_high(L_nodes: int, W: float) -> float:
    """Score_high = W / L_nodes of opening one more high-level plan (paper, Heuristics)."""
    return W / L_nodes


def score_low(P: float, cnt: int, floor: float) -> float:
    """Score_low = max(floor, P) / (1 + cnt_i(p_j)) of running plan p_j from node n_i (paper, Heuristics)."""
    return max(floor, P) * node_weight(cnt)


def node_weight(cnt: int) -> float:
    """1 / (1 + cnt_i(p_j)), the weight of n_i among the nodes that hold p_j (paper, Heuristics)."""
    return 1 / (1 + cnt)


def draw(weights: Sequence[float], rng: np.random.Generator) -> int:
    """Draw an index in proportion to the weights. There is at least one weight, and none is negative."""
    cumulative = list(accumulate(weights))
    return bisect(cumulative, rng.random() * cumulative[-1], hi=len(cumulative) - 1)


def draw_node(tree: Tree[C], plan: int, rng: np.random.Generator) -> RunStep:
    """Draw a node for the plan among those that hold it, in proportion to 1 / (1 + cnt) (paper, Heuristics)."""
    holders = tree.holders[plan]
    return RunStep(holders[draw([node_weight(tree.nodes[node].cnt[plan]) for node in holders], rng)], plan)
