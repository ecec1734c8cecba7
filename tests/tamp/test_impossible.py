"""What no plan can do is said before the search, with its cause, and nothing else is."""

from dataclasses import replace
from pathlib import Path

import pytest

from ictamp_drake.core.failures import Failure
from ictamp_drake.planning.result import StopReason
from ictamp_drake.runs.records import record_of
from ictamp_drake.scenes.regions import PoseSpec
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, SupportSpec, load_scene
from ictamp_drake.skills.config import PickConfig, SkillsConfig
from ictamp_drake.tamp.method import SCENE_METHOD, Method
from ictamp_drake.tamp.pages import write_pages
from ictamp_drake.tamp.solve import Solution, solve
from ictamp_drake.tamp.task import load

CASES = Path(__file__).parents[1] / "scenes" / "cases"
SHELF, TOWER = (load_scene(CASES / f"{name}.yaml") for name in ("07-wholly-under-a-shelf", "tower-too-high"))
TABLE = SupportSpec("table", (0.3, 0.0, 0.0))


def said(spec: SceneSpec, method: Method = SCENE_METHOD) -> Solution:
    """What is said without a search."""
    return solve(load(spec), method, max_steps=0)


def named(spec: SceneSpec) -> set[str]:
    """The impossible actions."""
    solution = said(spec)
    is_impossible = solution.result.stop_reason is StopReason.IMPOSSIBLE
    return {blocked.action for blocked in solution.explain().blocked} if is_impossible else set()


def test_a_box_under_a_board_is_named_with_the_board() -> None:
    solution = said(SHELF)
    assert not solution.result.solved
    assert solution.plan is None
    assert solution.cpu_time_s < 5.0
    explanation = solution.explain()
    assert explanation.stop_reason == "IMPOSSIBLE"
    (blocked,) = explanation.blocked
    assert blocked.action == "pick(jar, table)"
    assert set(blocked.refusals) == {Failure.GOAL_IN_COLLISION}
    assert set(blocked.obstacles) == {"board"}
    assert blocked.swept
    assert "no grasp on a grid of 5 mm and 10 deg" in str(explanation)
    assert "--no-sweep" in str(explanation)


def test_a_tower_that_is_too_high_is_named_with_its_top() -> None:
    solution = said(TOWER)
    assert solution.cpu_time_s < 5.0
    blocked, *_ = solution.explain().blocked
    assert blocked.action == "place(f, e)"
    assert set(blocked.refusals) == {Failure.NO_INVERSE_KINEMATICS}
    assert "no placement on a grid of 5 mm and 10 deg" in str(blocked)
    assert "out of reach" in str(blocked)


def test_a_goal_with_dozens_of_alternatives_is_swept_as_well() -> None:
    box = BoxSpec((0.05, 0.05, 0.06), (0.0, 0.0, 0.03))
    spots = [(0.35 + 0.1 * column, 0.15 + 0.1 * row) for column in range(4) for row in range(2)]
    spec = replace(
        SHELF,
        supports={"table": TABLE, "board": replace(SHELF.supports["board"], position=(0.6, -0.25, 0.2))},
        boxes={f"box_{n}": replace(box, position=(*spot, 0.03)) for n, spot in enumerate(spots)},
        poses={name: PoseSpec("table", (x, -0.25)) for name, x in (("left", 0.3), ("right", 0.36))},
        goal="(forall (?p - pose) (exists (?x - box) (at ?x ?p)))",
    )
    assert len(load(spec).goal.alternatives) == 8 * 7
    assert {action.partition("(")[0] for action in named(spec)} == {"place"}


def test_a_lower_tower_and_a_higher_board_are_possible() -> None:
    assert not named(replace(TOWER, goal="(and (on a tray) (on b a) (on c b))"))
    board = replace(SHELF.supports["board"], position=(0.6, 0.05, 0.55))
    assert not named(replace(SHELF, supports={**SHELF.supports, "board": board}))


def test_what_need_not_move_may_be_out_of_reach() -> None:
    assert not named(replace(SHELF, goal="(on jar table)"))
    other = BoxSpec((0.05, 0.05, 0.05), (0.3, 0.3, 0.025))
    assert not named(replace(SHELF, boxes={**SHELF.boxes, "other": other}, goal="(on other tray)"))


def test_what_stands_on_a_box_that_must_move_must_move() -> None:
    lid = BoxSpec((0.05, 0.05, 0.03), (0.57, 0.05, 0.115))
    assert named(replace(SHELF, boxes={**SHELF.boxes, "lid": lid})) == {"pick(jar, table)", "pick(lid, jar)"}


def test_a_box_that_cannot_be_fetched_is_no_place_when_it_is_out_of_reach() -> None:
    supports = {"table": TABLE, "stand": SupportSpec("table", (1.1, 0.0, 0.04), size=(0.2, 0.2, 0.02))}
    cup = BoxSpec((0.05, 0.05, 0.05), (0.45, 0.2, 0.025))
    far, near = (BoxSpec((0.05, 0.05, 0.05), (x, 0.0, 0.065)) for x in (1.1, 1.1 - 0.6))
    scene = SceneSpec(supports=supports, boxes={"cup": cup, "base": far}, goal="(on cup base)")
    assert named(scene) == {"place(cup, base)"}
    supports = {**supports, "stand": replace(supports["stand"], position=(0.5, 0.0, 0.04))}
    assert not named(replace(scene, supports=supports, boxes={"cup": cup, "base": near}))


def test_a_tower_without_a_place_may_stand_anywhere() -> None:
    goal = "(and (on b a) (on c b) (on d c) (on e d) (on f e))"
    assert named(replace(TOWER, goal=goal)) >= {"place(f, e)"}
    spare = BoxSpec((0.05, 0.05, 0.05), (0.6, -0.2, 0.025))
    assert not named(replace(TOWER, goal=goal, boxes={**TOWER.boxes, "spare": spare})), "it is not known what is below"


def test_the_search_goes_on_when_it_is_told_to() -> None:
    assert said(SHELF, Method()).result.stop_reason is StopReason.OUT_OF_STEPS
    assert said(SHELF, SCENE_METHOD.with_options(sweep=False)).result.stop_reason is StopReason.OUT_OF_STEPS


class OwnPick(PickConfig):
    """A skill of someone's own, which may do anything."""


def test_nothing_is_known_of_skills_of_ones_own() -> None:
    method = SCENE_METHOD.with_options(skills=SkillsConfig(pick=OwnPick()))
    assert said(SHELF, method).result.stop_reason is StopReason.OUT_OF_STEPS


def test_records_and_pages_tell_it(tmp_path: Path) -> None:
    solution = said(SHELF)
    record = record_of("shelf", "", None, 0, solution)
    assert record.is_final
    assert not record.solved
    assert list(record.explanation.lines()) == list(solution.explain().lines())
    write_pages(solution, tmp_path)
    assert "on a grid of 5 mm" in (tmp_path / "search.html").read_text()
    assert (tmp_path / "scene.png").exists()


@pytest.mark.parametrize("name", ["f3-many-bystanders", "neighbours-8-mm", "neighbours-on-two-sides", "f1-overhang"])
def test_nothing_possible_is_refused(name: str) -> None:
    assert not named(load_scene(CASES / f"{name}.yaml"))
