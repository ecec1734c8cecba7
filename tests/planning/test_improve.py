"""Searches that go on after the first plan: each further plan is better, and the figures stay those of the first."""

from dataclasses import dataclass, replace

import numpy as np
import pytest

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Attempt, GripperCommand, Parameter, Segment, Skeleton, State
from ictamp_drake.planning.adaptive import AdaptiveConfig
from ictamp_drake.planning.els import ElsConfig
from ictamp_drake.planning.events import Event, PlanFound
from ictamp_drake.planning.planner import Planner
from ictamp_drake.planning.proportional import ProportionalConfig
from ictamp_drake.planning.result import PlanningResult, StopReason
from ictamp_drake.planning.round_robin import RoundRobinConfig
from ictamp_drake.planning.rule import RuleConfig
from ictamp_drake.planning.uniform import UniformAllocationConfig
from tests.planning.test_planner import RULES
from tests.toy_world import (
    MOVES,
    RIGHT,
    UP,
    TickingClock,
    ToyConfiguration,
    ToyWorld,
    abstraction,
    toy_planner,
)

ACROSS = Action("across", ())
RULE_NAMES = ("paper", "straight", "els", "round robin", "uniform", "adaptive")


@dataclass(frozen=True)
class TimedWorld(ToyWorld):
    """Steps that take as long to execute as the offset that they drew."""

    def attempt(
        self,
        c: ToyConfiguration,
        plan: Skeleton,
        rng: np.random.Generator,
        k: Parameter | None = None,
    ) -> Attempt[ToyConfiguration]:
        """Run one step from c."""
        attempt = super().attempt(c, plan, rng, k)
        if attempt.k is None:
            return attempt
        still = Segment("wait", float(attempt.k[0]), GripperCommand(0.0, 0.0), 1, np.zeros(2), np.zeros((1, 7)))
        return replace(attempt, motion=(still,))


WORLD = TimedWorld(size=(2, 1), success=0.8)


def improve(planner: Planner[ToyConfiguration], seconds: float = 1e6) -> PlanningResult[ToyConfiguration]:
    """Run the search, which goes on for that long after the first plan."""
    planner.config = replace(planner.config, improve=seconds)
    return planner.run()


def measure(result: PlanningResult[ToyConfiguration]) -> list[tuple[int, float]]:
    """Return the number of skills and the duration of each plan that was found."""
    paths = [result.tree.path(found.node) for found in result.found]
    return [(len(path), sum(attempt.duration for attempt in path)) for path in paths]


@pytest.mark.parametrize("rule", [RULES[name] for name in RULE_NAMES], ids=RULE_NAMES)
def test_every_further_plan_is_better_and_the_last_one_is_the_plan(rule: RuleConfig) -> None:
    events: list[Event] = []
    first = toy_planner(WORLD, rule=rule).run()
    result = improve(toy_planner(WORLD, rule=rule, steps=300, listeners=[events.append]))
    found = measure(result)
    assert len(found) > 1
    assert found == sorted(found, reverse=True)
    assert len(set(found)) == len(found)
    assert measure(first) == found[:1]
    assert result.plan == result.tree.path(result.found[-1].node)
    assert result.candidate == result.tree.solution
    assert result.stop_reason is StopReason.SOLVED
    told = [event.path for event in events if isinstance(event, PlanFound)]
    assert told == [result.tree.path(found.node) for found in result.found]


@pytest.mark.parametrize("rule", [RULES[name] for name in RULE_NAMES], ids=RULE_NAMES)
def test_figures_are_those_of_the_first_plan(rule: RuleConfig) -> None:
    first = toy_planner(WORLD, rule=rule).run()
    result = improve(toy_planner(WORLD, rule=rule, steps=300))
    assert len(result.tree.steps) == 300
    assert result.low_level_steps == first.low_level_steps
    assert result.high_level_plans == first.high_level_plans
    assert result.steps_by_depth == first.steps_by_depth
    assert result.failures == first.failures
    assert dict(result.seconds_by_stage) == dict(first.seconds_by_stage)


@pytest.mark.parametrize(
    "rule", [ProportionalConfig(), AdaptiveConfig(), UniformAllocationConfig(), RoundRobinConfig()]
)
def test_a_plan_with_fewer_skills_takes_the_place_of_a_quicker_one(
    rule: RuleConfig, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(MOVES, ACROSS, (1, 1))
    start, right, goal = (abstraction(ToyConfiguration(cell, 0.0)) for cell in ((0, 0), (1, 0), (1, 1)))
    long, short = Skeleton((start, right, goal), (RIGHT, UP)), Skeleton((start, goal), (ACROSS,))
    monkeypatch.setattr(ToyWorld, "plans", lambda _: iter((long, short)))
    world = TimedWorld(doors={(1, 1): 0.6}, offsets=(0.1,))
    planner = toy_planner(world, rule=rule, steps=60)
    result = improve(planner)
    assert result.actions == (ACROSS,)
    assert {len(result.tree.path(each.node)) for each in result.found} <= {1, 2}
    assert [result.tree.plans[plan].actions for plan in result.tree.open_plans] == [(ACROSS,)]


def test_time_is_counted_from_the_first_plan_and_the_time_limit_ends_there() -> None:
    clock = TickingClock(tick=1.0)
    result = improve(toy_planner(WORLD, steps=None, seconds=60.0, clock=clock), seconds=100.0)
    assert result.found[0].seconds < 60
    assert 100 < clock.now < 60 + 100 + 10
    assert result.planning_time_s == result.found[0].seconds


def test_ctrl_c_keeps_the_best() -> None:
    calls = iter(range(10**6))

    def stop() -> bool:
        if next(calls) > 100:
            raise KeyboardInterrupt
        return False

    result = improve(toy_planner(WORLD, steps=None, stop=stop))
    assert result.stop_reason is StopReason.SOLVED
    assert result.plan == result.tree.path(result.found[-1].node)


def test_a_plan_that_is_no_better_was_not_refused() -> None:
    result = improve(toy_planner(WORLD, steps=300))
    verified = [node for node, verdict in result.tree.candidates.items() if verdict]
    assert verified == [found.node for found in result.found]
    assert set(result.tree.candidates.values()) == {True, None}


def test_a_plan_that_is_refused_is_no_improvement() -> None:
    answers = iter([True] + [False] * 1000)
    result = improve(toy_planner(WORLD, steps=300, verify=lambda _: next(answers)))
    assert len(result.found) == 1
    assert result.candidate == result.found[0].node
    assert result.verified is True


def test_nothing_is_better_than_nothing_to_do() -> None:
    result = improve(toy_planner(ToyWorld(size=(0, 0)), steps=None))
    assert result.plan == ()
    assert not result.tree.steps


@pytest.mark.parametrize("rule", [ProportionalConfig(), AdaptiveConfig(), RoundRobinConfig(), ElsConfig()])
def test_steps_that_were_only_promised_are_executed_before_they_count(rule: RuleConfig) -> None:
    rng = np.random.default_rng(5)

    def execute(_: ToyConfiguration, attempt: Attempt[ToyConfiguration], __: State) -> Attempt[ToyConfiguration]:
        return attempt if rng.random() < 0.7 else replace(attempt, failure=Failure.SLIPPED)

    result = improve(toy_planner(WORLD, rule=rule, steps=400, execute=execute))
    found = measure(result)
    assert len(found) > 1
    assert found == sorted(found, reverse=True)
    assert not {each.node for each in result.found} & result.tree.refuted
