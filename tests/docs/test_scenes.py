"""Each scene of docs/scenes.md is solved, and its plan is saved, loaded and replayed."""

import re
from pathlib import Path

import pytest

import ictamp_drake as ict

PAGE = (Path(__file__).parents[2] / "docs" / "scenes.md").read_text(encoding="utf-8")
SCENES = re.findall(r"```yaml\n(supports:\n.*?)```", PAGE, re.DOTALL)


@pytest.mark.parametrize("text", SCENES, ids=lambda text: re.findall("goal: (.*)", text)[0])
def test_the_scene_is_solved_and_its_plan_replayed(text: str, tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(text, encoding="utf-8")
    task = ict.load(tmp_path / "scene.yaml")
    assert not task.goal.holds(task.s)
    solution = ict.solve(task, time_limit=100)
    assert solution.plan is not None, solution.explain()
    solution.plan.save(tmp_path / "plan.yaml")
    plan = ict.Plan.load(tmp_path / "plan.yaml")
    assert plan.spec == task.spec
    replay = plan.replay()
    assert replay.reached
    assert task.goal.holds(task.abstraction(replay.c))
