"""Allocation of effort, computed from the tree of a search."""

import pickle
from collections import Counter
from dataclasses import replace

import pytest

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action
from ictamp_drake.planning.result import ActionReport
from tests.toy_world import RIGHT, UP, TickingClock, ToyWorld, toy_planner

WALLED = ToyWorld(size=(1, 1), walls=((1, 1),), max_plans=1)


def test_the_blocked_action_says_how_often_and_why() -> None:
    result = toy_planner(WALLED, steps=30).run()
    (report,) = result.blocked
    assert report.action == UP
    assert report.failures == Counter({Failure.NO_PATH: report.attempts})
    assert report.rejections == Counter({Failure.NO_INVERSE_KINEMATICS: 2 * report.attempts})
    assert report.attempts + result.reports[RIGHT].attempts == 30
    assert not result.reports[RIGHT].is_blocked
    assert result.failures == Counter({Failure.NO_PATH: report.attempts})


@pytest.mark.parametrize(
    ("failures", "rejections", "line"),
    [
        (Counter(), Counter(), "pick(red_box, rack): 0 of 30"),
        (
            Counter({Failure.NO_INVERSE_KINEMATICS: 30}),
            Counter(),
            "pick(red_box, rack): 30 of 30: no inverse-kinematics solution",
        ),
        (
            Counter({Failure.SLIPPED: 2, Failure.NO_PATH: 21}),
            Counter({Failure.NO_INVERSE_KINEMATICS: 70}),
            "pick(red_box, rack): 23 of 30: 21 no collision-free path, 2 object slipped "
            "(before the last k of an attempt, 70 more: no inverse-kinematics solution)",
        ),
    ],
    ids=["none failed", "one cause", "several causes and rejections"],
)
def test_a_report_is_one_line(failures: Counter[Failure], rejections: Counter[Failure], line: str) -> None:
    assert str(ActionReport(Action("pick", ("red_box", "rack")), 30, failures, rejections)) == line


def test_the_seconds_are_those_of_the_skills_and_of_the_planners_own_stages() -> None:
    result = toy_planner(replace(WALLED, walls=(), seconds=0.25), clock=TickingClock(0.001)).run()
    assert set(result.seconds_by_stage) == {"physics", "plan_generator", "selection", "verification"}
    assert result.seconds_by_stage["physics"] == pytest.approx(0.25 * result.low_level_steps)
    assert result.seconds_by_stage["plan_generator"] == pytest.approx(0.001)
    assert result.seconds_by_stage["selection"] == pytest.approx(0.001 * len(result.tree.log))
    assert result.seconds_by_stage["verification"] == pytest.approx(0.001)


def test_steps_are_counted_by_the_depth_that_they_started_from() -> None:
    assert toy_planner(ToyWorld(size=(2, 2))).run().steps_by_depth == (1, 1, 1, 1)
    blocked = toy_planner(replace(WALLED, walls=((0, 1), (1, 0))), steps=9).run()
    assert blocked.steps_by_depth == (9,)
    assert toy_planner(WALLED, steps=0).run().steps_by_depth == ()


def test_counts_agree_with_the_tree() -> None:
    result = toy_planner(ToyWorld(size=(2, 2), success=0.4)).run()
    summary = result.tree.summary()
    assert result.high_level_plans == summary["high_level_plans"]
    assert result.low_level_steps == summary["low_level_steps"]
    assert sum(result.steps_by_depth) == summary["low_level_steps"]
    assert result.failures.total() == summary["low_level_failures"]


def test_a_result_travels_between_processes() -> None:
    result = toy_planner(ToyWorld(size=(2, 2), success=0.4)).run()
    copy = pickle.loads(pickle.dumps(result))
    assert copy.actions == result.actions
    assert copy.tree.to_dict() == result.tree.to_dict()
