"""The formulas of the paper, and proportional draws."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.stats import chisquare

from ictamp_drake.planning.scores import draw, latest_plan_cost, node_weight, score_high, score_low
from ictamp_drake.planning.tree import Opening


@pytest.mark.parametrize(
    ("openings", "cost"),
    [
        ([], 1),
        ([Opening(None, 1000)], 1),
        ([Opening(0, 217)], 217),
        ([Opening(0, 217), Opening(1, 30)], 30),
        ([Opening(None, 1000), Opening(0, 217)], 1217),
        ([Opening(0, 217), Opening(None, 1000)], 217),
        ([Opening(0, 217), Opening(1, 0)], 1),
    ],
    ids=["before", "first call fruitless", "first", "most recent", "two calls for one", "fruitless later", "for free"],
)
def test_latest_plan_cost_counts_the_nodes_of_the_most_recent_plan(openings: list[Opening], cost: int) -> None:
    assert latest_plan_cost(openings) == cost


def test_a_new_plan_scores_less_the_more_nodes_the_last_one_took() -> None:
    assert score_high(L_nodes=1, W=0.5) == 0.5
    assert score_high(L_nodes=200, W=10.0) == 0.05


@pytest.mark.parametrize(("P", "cnt", "score"), [(0.8, 0, 0.8), (0.8, 3, 0.2), (0.02, 0, 0.1), (0.0, 4, 0.02)])
def test_a_step_scores_its_probability_over_its_attempts_with_a_floor(P: float, cnt: int, score: float) -> None:
    assert score_low(P, cnt, floor=0.1) == pytest.approx(score)


def test_node_weight_falls_with_attempts() -> None:
    assert [node_weight(cnt) for cnt in range(4)] == [1, 1 / 2, 1 / 3, 1 / 4]


def test_draw_is_in_proportion_to_the_weights() -> None:
    rng = np.random.default_rng(5)
    weights = np.array([1, 1 / 2, 0, 1 / 3, 1 / 6])
    counts = np.bincount([draw(weights.tolist(), rng) for _ in range(20_000)], minlength=5)
    assert counts[2] == 0
    present = weights > 0
    assert chisquare(counts[present], 20_000 * weights[present] / weights.sum()).pvalue > 0.01


@given(st.lists(st.floats(0, 1e6), min_size=1), st.integers(0, 2**32))
def test_draw_never_takes_a_weight_of_zero_unless_all_are(weights: list[float], seed: int) -> None:
    index = draw(weights, np.random.default_rng(seed))
    assert weights[index] > 0 or not any(weights)
