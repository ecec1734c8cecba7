"""Explanations as data; their text only has to name what the data contain."""

from collections import Counter
from itertools import pairwise
from typing import Any

import pytest

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Attempt
from ictamp_drake.planning.adaptive import AdaptiveConfig
from ictamp_drake.planning.els import ElsConfig
from ictamp_drake.planning.proportional import ProportionalConfig
from ictamp_drake.planning.result import StopReason
from ictamp_drake.planning.rule import RuleConfig
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, SupportSpec
from ictamp_drake.tamp.explanation import SHOWN, Blocked, Explanation
from tests.toy_world import ToyConfiguration, ToyWorld, toy_planner

IN_COLLISION, NO_PATH, SLIPPED = Failure.GOAL_IN_COLLISION, Failure.NO_PATH, Failure.SLIPPED


@pytest.mark.parametrize("failure", Failure)
def test_every_failure_has_advice(failure: Failure) -> None:
    assert failure.advice
    assert failure.advice != str(failure)


def test_the_advice_is_about_the_most_frequent_cause() -> None:
    assert Blocked("pick(a, b)", {NO_PATH: 2, IN_COLLISION: 7}).advice == IN_COLLISION.advice
    assert Blocked("pick(a, b)", {NO_PATH: 7, IN_COLLISION: 2}).advice == NO_PATH.advice
    assert Blocked("pick(a, b)", {}).advice == ""


@pytest.mark.parametrize("action", ["pick(red_box, rack)", "place(red_box, rack)", "push(red_box, rack)"])
def test_a_blocked_action_is_named_with_its_causes(action: str) -> None:
    words = str(Blocked(action, {NO_PATH: 7, SLIPPED: 5}))
    assert all(part in words for part in (action, "12 of 12", str(NO_PATH), str(SLIPPED)))


def test_the_obstacles_that_were_met_most_often_are_named_first() -> None:
    obstacles = {"far": 1, "tall": 5, "rack": 2, "wall": 3, "table": 1}
    words = str(Blocked("pick(low, table)", {IN_COLLISION: 9}, obstacles)).partition(str(IN_COLLISION))[2]
    places = [words.index(name) for name in ("tall", "wall", "rack", "far")]
    assert all(one < other for one, other in pairwise(places))
    assert words.count("(") == SHOWN < len(obstacles)


def test_the_explanation_of_a_search_has_what_blocked_it() -> None:
    world = ToyWorld(size=(2, 1), success=0.0)
    result = toy_planner(world, steps=5).run()
    explanation = Explanation.of(result, planning_time_s=2.0)
    assert explanation.stop_reason == StopReason.OUT_OF_STEPS.name
    assert explanation.steps == result.low_level_steps == 5
    assert explanation.plans == result.high_level_plans
    assert explanation.failures == result.failures
    assert [blocked.action for blocked in explanation.blocked] == [str(report.action) for report in result.blocked]
    assert sum(explanation.blocked[0].refusals.values()) == 5
    assert explanation.blocked[0].advice in str(explanation)


class _Crowd(ToyWorld):
    """A world in which one thing is in the way of every step."""

    def attempt(self, *arguments: Any) -> Attempt[ToyConfiguration]:
        return Attempt(arguments[1], IN_COLLISION, obstacles=("tall_box",))


@pytest.mark.parametrize(
    ("obstacle", "rule", "advised"),
    [("tall_box", ProportionalConfig(), True), ("tall_box", AdaptiveConfig(), False), ("x", ElsConfig(), False)],
)
def test_a_planner_that_leaves_boxes_in_the_way_advises_the_one_that_moves_them(
    obstacle: str, rule: RuleConfig, advised: bool
) -> None:
    table = SupportSpec(kind="table", position=(0.3, 0.0, 0.0))
    box = BoxSpec((0.05, 0.05, 0.05), (0.5, 0.0, 0.025))
    scene = SceneSpec(supports={"table": table}, boxes={obstacle: box}, goal=f"(on {obstacle} table)")
    explanation = Explanation.of(toy_planner(_Crowd(), steps=3).run(), 1.0, scene, rule)
    assert explanation.stuck is advised
    assert ("--planner adaptive" in str(explanation).splitlines()[-1]) is advised


def test_a_solved_problem_needs_no_explanation() -> None:
    explanation = Explanation.of(toy_planner(ToyWorld(size=(2, 1))).run(), planning_time_s=1.0)
    assert str(explanation) == explanation.reason == str(StopReason.SOLVED)


def test_each_thing_that_stood_in_the_way_has_a_line() -> None:
    blocked = tuple(Blocked(str(Action("pick", (name, "table"))), Counter({NO_PATH: 1})) for name in "abcdef")
    known = Explanation(stop_reason="OUT_OF_TIME", plans=1, steps=9, blocked=blocked, planning_time_s=40.0)
    lines = list(known.lines())
    assert [line.partition(":")[0] for line in lines] == [each.action for each in blocked[:SHOWN]]
    assert all(NO_PATH.advice in line for line in lines)
    assert str(known).splitlines() == [known.reason, *(f"  {line}" for line in lines)]


def test_time_that_went_into_plans_is_an_explanation() -> None:
    slow = Explanation(stop_reason="OUT_OF_TIME", plans=1, planning_time_s=42.8, generating_time_s=26.2)
    fast = Explanation(stop_reason="OUT_OF_TIME", plans=1, planning_time_s=42.8, generating_time_s=1.0)
    assert (slow.is_generator_slow, fast.is_generator_slow) == (True, False)
    assert len(list(slow.lines())) == len(list(fast.lines())) + 1


def test_what_failed_is_told_when_nothing_is_blocked() -> None:
    mixed = Explanation(stop_reason="OUT_OF_TIME", plans=1, steps=9, failures={SLIPPED: 2, NO_PATH: 1})
    (line,) = mixed.lines()
    assert all(part in line for part in ("3 of 9", str(SLIPPED), str(NO_PATH)))


def test_no_plan_and_a_plan_that_failed_have_lines_of_their_own() -> None:
    assert len(list(Explanation(stop_reason="UNREACHABLE").lines())) == 1
    failed = Explanation(stop_reason="OUT_OF_TIME", plans=1, verified=False)
    assert len(list(failed.lines())) == len(list(Explanation(stop_reason="OUT_OF_TIME", plans=1).lines())) + 1


def test_a_reason_that_is_no_reason_of_a_search_stands_as_it_is() -> None:
    assert Explanation(stop_reason="CRASHED").reason == "CRASHED"
