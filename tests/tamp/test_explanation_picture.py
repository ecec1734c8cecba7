"""Picture of an explanation, and its content on the pages."""

from dataclasses import replace
from pathlib import Path

import pytest
from PIL import Image

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Configuration
from ictamp_drake.scenes.spec import SupportSpec
from ictamp_drake.tamp.explanation import Blocked, Explanation
from ictamp_drake.tamp.pages import write_pages
from ictamp_drake.tamp.solve import solve
from ictamp_drake.tamp.task import load
from ictamp_drake.viz.picture import HEIGHT
from tests.viz.scene import SPEC, START

BLOCKED = Blocked("pick(red_box, table)", {Failure.GOAL_IN_COLLISION: 9}, {"rack": 2, "blue_box": 7})


def explanation(start: Configuration | None = START) -> Explanation:
    return Explanation(stop_reason="OUT_OF_TIME", blocked=(BLOCKED,), plans=1, scene=SPEC, start=start)


def test_an_action_names_what_it_is_about() -> None:
    assert BLOCKED.args == ("red_box", "table")


def test_reasons_are_those_of_the_blocked_actions() -> None:
    reasons = explanation().reasons
    (refusal,) = reasons.refusals
    assert refusal.action == BLOCKED.action
    assert list(refusal.obstacles) == ["blue_box", "rack"], "the most frequent first"
    assert refusal.advice == Failure.GOAL_IN_COLLISION.advice


def test_a_plan_that_failed_when_executed_again_is_told_first() -> None:
    told = list(replace(explanation(), verified=False, planning_time_s=2.0, generating_time_s=2.0).lines())
    assert told[1].startswith(BLOCKED.action)
    assert len(told) == 3


def test_a_solved_problem_has_no_reasons() -> None:
    assert not replace(explanation(), stop_reason="SOLVED").reasons.refusals


def test_a_picture_is_drawn(tmp_path: Path) -> None:
    explanation().draw(tmp_path / "why.png")
    assert Image.open(tmp_path / "why.png").height > HEIGHT


def test_a_record_of_a_search_cannot_be_drawn(tmp_path: Path) -> None:
    with pytest.raises(ValueError, match="scene"):
        explanation(start=None).draw(tmp_path / "why.png")


def test_the_pages_of_an_unsolved_problem_say_why(tmp_path: Path) -> None:
    far = replace(SPEC, supports={**SPEC.supports, "rack": SupportSpec("rack", (0.44, -0.9, 0.16), 90.0)})
    solution = solve(load(far), max_steps=4, sweep=False)
    assert solution.plan is None
    (refusal, *_) = solution.explain().reasons.refusals
    assert refusal.args == ("red_box", "rack")
    write_pages(solution, tmp_path)
    assert refusal.refused in (tmp_path / "search.html").read_text()
    assert Image.open(tmp_path / "scene.png").height > HEIGHT
