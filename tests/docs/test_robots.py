"""docs/robots.md is followed from an empty folder: the robot file, what the check says, and a plan with it."""

import re
from pathlib import Path

import pytest
import yaml

import ictamp_drake as ict
from ictamp_drake import robot
from ictamp_drake.robots.checking.report import check_robot
from ictamp_drake.runs.command import BAD_INPUT, COMPLETE

pytest.importorskip("airo_models")

PAGE = (Path(__file__).parents[2] / "docs" / "robots.md").read_text(encoding="utf-8")
FIRST, CHANGES, SCENE = re.findall(r"```yaml\n(.*?)```", PAGE, re.DOTALL)


def printed(capsys: pytest.CaptureFixture[str], code: int) -> str:
    """What the check prints."""
    assert robot.main(["check", "my.yaml"]) == code
    return capsys.readouterr().out


def test_the_page_leads_to_a_plan(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    file = tmp_path / "my.yaml"
    file.write_text(FIRST, encoding="utf-8")
    assert f"```\n{printed(capsys, BAD_INPUT)}```" in PAGE
    for line in CHANGES.splitlines():
        name = line.partition(":")[0]
        text = file.read_text(encoding="utf-8")
        changed = re.sub(rf"(?m)^( *){name}:.*", rf"\1{line}", text)
        file.write_text(changed if changed != text else f"{line}\n{text}", encoding="utf-8")
    assert f"```\n{printed(capsys, BAD_INPUT)}```" in PAGE
    file.write_text(file.read_text(encoding="utf-8").replace("opening: 0.1", "opening: 0.085"), encoding="utf-8")
    assert printed(capsys, COMPLETE)
    (tmp_path / "scene.yaml").write_text(SCENE, encoding="utf-8")
    solution = ict.solve(ict.load("scene.yaml"), time_limit=60)
    assert solution.plan is not None, solution.explain()
    solution.plan.save(tmp_path / "plan.yaml")
    assert ict.Plan.load(tmp_path / "plan.yaml").replay().reached


def test_the_table_has_all_fields(tmp_path: Path) -> None:
    file = tmp_path / "robot.yaml"
    file.write_text(yaml.safe_dump({"x": 1}), encoding="utf-8")
    unknown = next(problem for problem in check_robot(str(file)).problems if problem.where.field == "x")
    assert all(f"`{name}`" in PAGE for name in set(unknown.choices) - {"description", "gripper"})
