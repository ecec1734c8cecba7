"""Beliefs of a search about its steps: computed by hand, and their laws."""

from dataclasses import replace
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.core.errors import Code
from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Atom, Attempt, Obstruction, Skeleton
from ictamp_drake.planning.beliefs import Beliefs, BeliefsConfig
from ictamp_drake.planning.tree import ROOT, RunStep, Tree
from tests.motions import stay
from tests.refusals import refusal
from tests.toy_world import RIGHT, UP, TableEstimator, ToyConfiguration, ToyWorld, abstraction

WORLD = ToyWorld(size=(1, 1))
RIGHT_UP, UP_RIGHT = WORLD.plans()
CONFIG = BeliefsConfig(strength=2.0, effort=1.0, trying=1e-9, simulating=1.0)
CELLS = {RIGHT: (1, 0), UP: (0, 1)}


class Search:
    """A tree with both plans that grows by hand, and the beliefs about it."""

    def __init__(self, config: BeliefsConfig = CONFIG, right: float = 0.5, up: float = 0.8) -> None:
        self.tree = Tree(WORLD.start, abstraction(WORLD.start))
        self.estimator = TableEstimator({RIGHT: right, UP: up})
        self.beliefs: Beliefs[ToyConfiguration] = Beliefs(config, self.estimator)
        for plan in (RIGHT_UP, UP_RIGHT):
            self.tree.record_opening(plan, 1)

    def attempt(self, node: int, plan: int, success: bool, duration: float = 1.0, **more: Any) -> None:
        action: Action = self.tree.plans[plan].actions[0]
        x, y = self.tree.nodes[node].c.cell
        successor = ToyConfiguration((x + CELLS[action][0], y + CELLS[action][1]), 0.1)
        failure = None if success else Failure.SLIPPED
        attempt = Attempt(action, failure, successor, motion=(stay(duration),), **more)
        self.beliefs.learn(self.tree, self.tree.record_step(node, plan, attempt))

    def estimate_effort(self, node: int, plan: int) -> float:
        return self.beliefs.estimate_effort(self.tree, [RunStep(node, plan)])[0]


def test_before_any_attempt_P_says_how_often_each_action_must_be_repeated() -> None:
    search = Search()
    together = search.beliefs.estimate_effort(search.tree, [RunStep(ROOT, 0), RunStep(ROOT, 1)])
    assert together == pytest.approx([1 / 0.5 + 1 / 0.8, 1 / 0.8 + 1 / 0.5])
    assert len(search.estimator.asked) == 1


def test_an_action_of_a_name_that_was_never_estimated_is_hoped_for() -> None:
    search = Search()
    assert search.estimate_effort(ROOT, 0) == pytest.approx(1 / 0.5 + 1 / CONFIG.hope)


def test_attempts_from_the_same_node_count_in_full() -> None:
    search = Search()
    search.attempt(ROOT, 0, success=False)
    assert search.estimate_effort(ROOT, 0) == pytest.approx(1 / (2 * 0.5 / (2 + 1)) + 1 / CONFIG.hope)
    search.attempt(ROOT, 0, success=True)
    assert search.estimate_effort(ROOT, 0) == pytest.approx(1 / ((2 * 0.5 + 1) / (2 + 2)) + 1 / CONFIG.hope)


def test_a_failure_counts_as_often_as_it_tried_and_a_success_once() -> None:
    search = Search()
    search.attempt(ROOT, 0, success=False, rejections=(Failure.NO_PATH,) * 7)
    assert search.estimate_effort(ROOT, 0) == pytest.approx(1 / (2 * 0.5 / (2 + 8)) + 1 / CONFIG.hope)
    search.attempt(ROOT, 0, success=True, rejections=(Failure.NO_PATH,) * 3)
    assert search.estimate_effort(ROOT, 0) == pytest.approx(1 / ((2 * 0.5 + 1) / (2 + 9)) + 1 / CONFIG.hope)


def test_attempts_on_the_same_edge_from_elsewhere_count_a_part() -> None:
    """Either the start decides, so the failure counts fully; or the first step does, so it is one draw among others."""
    search = Search()
    search.attempt(ROOT, 0, success=True)
    search.attempt(1, 2, success=False)
    search.attempt(ROOT, 0, success=True)
    node = len(search.tree.nodes) - 1
    elsewhere = (2 * 0.8 / (2 + 1) + 2 * 0.8 / (2 + 2 / 3)) / 2
    assert search.estimate_effort(node, 2) == pytest.approx(1 / elsewhere)
    assert search.estimate_effort(1, 2) == pytest.approx(1 / (2 * 0.8 / (2 + 1)))
    from_root = 1 / ((2 * 0.5 + 2) / (2 + 2))
    assert search.estimate_effort(ROOT, 0) == pytest.approx(from_root + 1 / elsewhere)


def test_the_same_action_on_another_edge_is_no_evidence() -> None:
    search = Search()
    search.attempt(ROOT, 1, success=True)
    search.attempt(1, 2, success=False)  # right, from the upper cell
    assert search.estimate_effort(ROOT, 0) == pytest.approx(1 / 0.5 + 1 / CONFIG.hope)


def test_what_was_estimated_of_an_action_elsewhere_is_expected_of_it_and_not_of_others_of_its_name() -> None:
    here, there, far = (abstraction(ToyConfiguration((x, 0), 0.0)) for x in range(3))
    go, low, high = Action("go", ()), Action("pick", ("low",)), Action("pick", ("high",))
    tree = Tree(WORLD.start, here)
    for action, after in ((low, there), (high, there), (go, far)):
        tree.record_opening(Skeleton((here, after), (action,)), 1)
    beliefs: Beliefs[ToyConfiguration] = Beliefs(CONFIG, TableEstimator({low: 0.2, high: 0.8, go: 1.0}))
    beliefs.estimate_effort(tree, [RunStep(ROOT, 0), RunStep(ROOT, 1)])
    for action, expected in ((low, 0.2), (high, 0.8), (Action("pick", ("other",)), 0.5)):
        opening = tree.record_opening(Skeleton((here, far, there), (go, action)), 1)
        assert opening.plan is not None
        (time,) = beliefs.estimate_effort(tree, [RunStep(ROOT, opening.plan)])
        assert time == pytest.approx(1 + 1 / expected)


def test_an_edge_is_another_one_when_what_was_in_its_way_has_been_moved() -> None:
    start = abstraction(WORLD.start) | {Atom("on", ("tall", "table"))}
    low, aside = Action("pick", ("low", "table")), Action("push", ("tall", "table"))
    tree = Tree(WORLD.start, start)
    tree.record_opening(Skeleton((start, start), (low,)), 1)
    tree.record_opening(Skeleton((start, start, start), (aside, low)), 1)
    beliefs: Beliefs[ToyConfiguration] = Beliefs(CONFIG, TableEstimator({low: 0.5, aside: 1.0}))
    fresh = beliefs.estimate_effort(tree, [RunStep(ROOT, 0), RunStep(ROOT, 1)])
    assert beliefs.obstructions([aside, low]) == frozenset()
    for _ in range(2):
        failure = Attempt[ToyConfiguration](
            low, Failure.GOAL_IN_COLLISION, motion=(stay(1.0),), obstacles=("tall", "link6", "table")
        )
        beliefs.learn(tree, tree.record_step(ROOT, 0, failure))
    assert beliefs.obstructions([aside, low]) == {Obstruction(low, "tall")}
    without, around = beliefs.estimate_effort(tree, [RunStep(ROOT, 0), RunStep(ROOT, 1)])
    assert without > fresh[0]
    assert around == pytest.approx(fresh[1])


def test_failures_and_successes_take_their_own_effort() -> None:
    search = Search()
    search.attempt(ROOT, 0, success=True, duration=3.0)
    search.attempt(ROOT, 0, success=False, duration=0.1)
    right = 3.0 + (1 / ((2 * 0.5 + 1) / (2 + 2)) - 1) * 0.1
    assert search.estimate_effort(ROOT, 0) == pytest.approx(right + 1 / CONFIG.hope)


def test_each_k_is_an_effort_besides_the_motion() -> None:
    search = Search(replace(CONFIG, trying=0.1))
    search.attempt(ROOT, 0, success=True, duration=3.0, rejections=(Failure.NO_PATH,) * 3)
    search.attempt(ROOT, 0, success=False, duration=0.0)
    right = 3.4 + (1 / ((2 * 0.5 + 1) / (2 + 2)) - 1) * 0.1
    assert search.estimate_effort(ROOT, 0) == pytest.approx(right + CONFIG.effort / CONFIG.hope)


def test_a_plan_that_was_refused_as_a_whole_counts_as_a_failure_of_its_last_action() -> None:
    search = Search()
    search.attempt(ROOT, 0, success=True)
    search.tree.candidates[2] = False
    search.attempt(1, 2, success=True)
    assert search.tree.nodes[-1].index == 2
    assert search.estimate_effort(1, 2) == pytest.approx(1 / (2 * 0.8 / (2 + 1)))


def test_what_is_hoped_of_a_plan_knows_no_failures() -> None:
    search = Search()
    before = search.estimate_effort(ROOT, 0), search.estimate_effort(ROOT, 1)
    for _ in range(5):
        search.attempt(ROOT, 0, success=False)
    assert search.beliefs.estimate_prior_effort(RIGHT_UP) == pytest.approx(1 / 0.5 + 1 / 0.8)
    assert search.estimate_effort(ROOT, 0) > before[0]


def test_a_failure_at_an_obstacle_is_blamed_on_the_steps_that_put_things_there() -> None:
    """Both ways failed equally often, but no moved object was in the way, so the first step is not repeated."""
    known, unknown = Search(), Search()
    for search, obstacles in ((known, ("wall",)), (unknown, ())):
        search.attempt(ROOT, 0, success=True)
        for _ in range(9):
            search.attempt(1, 2, success=False, obstacles=obstacles)
    assert known.estimate_effort(1, 2) == pytest.approx(unknown.estimate_effort(1, 2))
    assert known.estimate_effort(ROOT, 0) > 1.5 * unknown.estimate_effort(ROOT, 0)


@given(outcomes=st.lists(st.booleans(), max_size=8), right=st.floats(0, 1), strength=st.floats(0.1, 10))
def test_a_failure_makes_a_plan_look_further_away_and_a_success_nearer(
    outcomes: list[bool], right: float, strength: float
) -> None:
    search = Search(replace(CONFIG, strength=strength), right=right)
    for success in outcomes:
        before = search.estimate_effort(ROOT, 0)
        search.attempt(ROOT, 0, success)
        assert (
            search.estimate_effort(ROOT, 0) <= before + 1e-9
            if success
            else search.estimate_effort(ROOT, 0) >= before - 1e-9
        )


@pytest.mark.parametrize("name", ["strength", "floor", "hope", "effort", "trying", "simulating", "patience"])
def test_a_constant_of_zero_is_refused_by_name(name: str) -> None:
    with refusal(Code.OUT_OF_RANGE, f"planners.adaptive.beliefs.{name}", value=0.0):
        BeliefsConfig(**{name: 0.0})


@pytest.mark.parametrize("name", ["floor", "hope"])
def test_what_is_no_probability_is_refused_by_name(name: str) -> None:
    with refusal(Code.OUT_OF_RANGE, f"planners.adaptive.beliefs.{name}", value=5.0):
        BeliefsConfig(**{name: 5.0})


@pytest.mark.parametrize("name", ["strength", "effort", "trying", "simulating"])
def test_an_infinite_constant_is_refused_by_name(name: str) -> None:
    with refusal(Code.OUT_OF_RANGE, f"planners.adaptive.beliefs.{name}", value=float("inf")):
        BeliefsConfig(**{name: float("inf")})
