"""Adaptive allocation: where the next step goes, and when another plan is opened."""

from dataclasses import replace

from ictamp_drake.planning.adaptive import AdaptiveConfig
from ictamp_drake.planning.beliefs import BeliefsConfig
from ictamp_drake.planning.tree import Opening
from tests.toy_world import RIGHT, UP, TableEstimator, TickingClock, ToyWorld, toy_planner

RULE = AdaptiveConfig()


def test_sure_steps_are_one_rollout() -> None:
    result = toy_planner(ToyWorld(size=(2, 2)), rule=RULE).run()
    assert result.low_level_steps == 4
    assert result.high_level_plans == 1


def test_a_step_that_failed_once_is_repeated_before_an_earlier_one() -> None:
    failed = 0
    for seed in range(20):
        steps = toy_planner(ToyWorld(size=(4, 0), success=0.7), rule=RULE, seed=seed).run().tree.steps
        first = next((number for number, step in enumerate(steps) if not step.attempt.succeeded), None)
        if first is not None:
            failed += 1
            assert steps[first + 1].node == steps[first].node
    assert failed > 10


def test_an_estimator_that_condemns_a_configuration_sends_the_search_back_at_once() -> None:
    """P of the second step is as low as its door is narrow, so no attempt at it is lost where it cannot succeed."""

    class Seeing(TableEstimator):
        def estimate(self, options):  # type: ignore[no-untyped-def]
            seen = super().estimate(options)
            seen[[c.cell == (1, 0) and c.offset >= 0.3 for c, _ in options]] = 0.0
            return seen

    world = ToyWorld(size=(2, 0), doors={(2, 0): 0.3})
    trusting = AdaptiveConfig(BeliefsConfig(floor=0.01))
    for seed in range(10):
        result = toy_planner(world, rule=trusting, estimator=Seeing({RIGHT: 1.0, UP: 1.0}), seed=seed).run()
        at_door = [step for step in result.tree.steps if result.tree.nodes[step.node].depth == 1]
        assert [step.attempt.succeeded for step in at_door] == [True]


def test_an_estimator_that_condemns_wherever_the_search_comes_is_not_trusted_for_ever() -> None:
    """Every step succeeds, but P of the second is 0; running the first again would never bring a better node."""
    world = ToyWorld(size=(2, 0))

    class Blind(TableEstimator):
        def estimate(self, options):  # type: ignore[no-untyped-def]
            seen = super().estimate(options)
            seen[[c.cell == (1, 0) for c, _ in options]] = 0.0
            return seen

    result = toy_planner(world, rule=RULE, estimator=Blind({RIGHT: 0.9, UP: 0.9})).run()
    assert result.solved
    assert result.low_level_steps <= 1 / BeliefsConfig().floor


def test_a_plan_whose_later_actions_are_blocked_is_left() -> None:
    """The paper's rule looks at the first action alone, and goes on running the half that succeeds."""
    world = ToyWorld(size=(2, 1), walls=((2, 0),))
    result = toy_planner(world, rule=RULE, steps=40).run()
    assert result.solved
    assert result.failures.total() <= 6


def test_opening_stops_paying_when_new_plans_are_no_better_and_cost_time() -> None:
    stuck = ToyWorld(size=(4, 4), walls=((1, 0), (0, 1)))
    cheap = toy_planner(stuck, rule=RULE, steps=60, clock=TickingClock(1e-6), seconds=1e6).run()
    dear = toy_planner(stuck, rule=RULE, steps=60, clock=TickingClock(1.0), seconds=1e6).run()
    assert 1 <= dear.high_level_plans < cheap.high_level_plans


def test_nothing_is_opened_while_all_goes_well() -> None:
    result = toy_planner(ToyWorld(size=(3, 3)), rule=RULE, clock=TickingClock(1e-3)).run()
    assert sum(isinstance(entry, Opening) for entry in result.tree.log) == 1


def test_a_narrow_door_is_passed_with_every_seed() -> None:
    world = ToyWorld(size=(2, 1), doors={(2, 1): 0.05}, max_plans=1)
    for seed in range(10):
        assert toy_planner(replace(world, success=0.9), rule=RULE, seed=seed, steps=2000).run().solved
