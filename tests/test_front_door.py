"""The public names: from a scene to a plan, and observations before planning."""

import subprocess
import sys
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pydrake.math import RigidTransform, RollPitchYaw

import ictamp_drake as ict
from ictamp_drake import cli
from ictamp_drake.scenes.spec import save_scene
from tests.runs.programs import SCENE


@pytest.fixture(scope="module")
def scene(tmp_path_factory: pytest.TempPathFactory) -> Path:
    path = tmp_path_factory.mktemp("front_door") / "scene.yaml"
    path.write_text(SCENE)
    return path


@pytest.fixture(scope="module")
def task(scene: Path) -> ict.Task:
    return ict.load(scene)


@pytest.fixture(scope="module")
def plan(task: ict.Task) -> ict.Plan:
    plan = ict.solve(task, time_limit=250).plan
    assert plan is not None
    return plan


def test_every_public_name_is_there() -> None:
    assert {name: getattr(ict, name) for name in ict.__all__}.keys() <= set(dir(ict))
    with pytest.raises(AttributeError):
        _ = ict.nothing


def test_the_package_is_imported_without_drake_and_torch() -> None:
    code = "import sys, ictamp_drake; print({'pydrake', 'torch', 'numpy'} & set(sys.modules))"
    assert subprocess.check_output([sys.executable, "-c", code], text=True).strip() == "set()"


def test_a_plan_is_saved_read_back_and_executed_again(plan: ict.Plan, tmp_path: Path) -> None:
    plan.save(tmp_path / "plan.yaml")
    read = ict.Plan.load(tmp_path / "plan.yaml")
    assert read.actions == plan.actions
    assert len(read) == len(plan)
    replay = read.replay()
    assert replay.reached
    assert replay.c == plan.attempts[-1].successor


def test_the_trajectory_is_that_of_all_skills(plan: ict.Plan) -> None:
    trajectory = plan.trajectory()
    assert trajectory.start_time() == 0
    assert trajectory.end_time() == pytest.approx(plan.duration)
    np.testing.assert_allclose(trajectory.value(0)[:, 0], plan.c.commanded, atol=1e-9)
    start = plan.attempts[0].duration
    np.testing.assert_allclose(trajectory.value(start)[:, 0], plan.attempts[1].motion[0].control_points[0], atol=1e-9)


@pytest.mark.parametrize("read", [False, True])
def test_a_plan_shows_itself(plan: ict.Plan, tmp_path: Path, read: bool) -> None:
    if read:
        plan.save(tmp_path / "plan.yaml")
        plan = ict.Plan.load(tmp_path / "plan.yaml")
    page = plan.show(tmp_path / "page.html", browser=False)
    assert str(plan.actions[0]) in page.read_text()


def test_a_search_without_a_plan_is_explained(scene: Path) -> None:
    method = ict.Method(sampler="uniform", estimator="constant", max_steps=3, time_limit=250)
    method = replace(method, skills=replace(method.skills, draws=1))
    solution = ict.solve(ict.load(scene, method), method)
    explanation = solution.explain()
    assert solution.plan is None
    assert explanation.stop_reason == "OUT_OF_STEPS"
    assert explanation.steps == 3
    assert sum(explanation.failures.values()) == 3
    assert all(blocked.advice for blocked in explanation.blocked)
    assert str(explanation).count("\n") >= 1


def test_options_are_fields_of_the_method(task: ict.Task) -> None:
    assert ict.solve(task, max_steps=0).explain().stop_reason == "OUT_OF_STEPS"
    for options in ({"timelimit": 30}, {"sampler": "magic"}, {"time_limit": -1}):
        with pytest.raises(ict.IctampError):
            ict.solve(task, **options)


def test_a_task_is_solved_with_the_physics_that_it_was_loaded_with(task: ict.Task) -> None:
    with pytest.raises(ict.IctampError):
        ict.solve(task, physics=replace(task.physics.config, time_step=0.002))


def test_a_scene_made_in_python_is_loaded(task: ict.Task) -> None:
    again = ict.load(task.spec)
    assert again.c == task.c
    assert again.s == task.s == task.abstraction(task.c)


def test_poses_of_a_camera_are_set_down(task: ict.Task) -> None:
    name = next(iter(task.spec.boxes))
    X_WO = task.spec.boxes[name].X_WO
    seen = X_WO + [0, 0, 0, 0, 0.01, -0.02, 0.004]  # beside its place in the scene, and 4 mm above the table
    c = ict.load(task.spec, start=ict.Start(poses={name: seen})).c
    np.testing.assert_allclose(c.poses[name][4:], X_WO[4:] + [0.01, -0.02, 0.0], atol=1e-3)
    tilted = RigidTransform(RollPitchYaw(0.03, -0.02, 0.4), X_WO[4:] - [0, 0, 0.003])
    c = ict.load(task.spec, start=ict.Start(poses={name: tilted})).c
    np.testing.assert_allclose(c.poses[name][4:], X_WO[4:], atol=1e-3)


@pytest.mark.parametrize(
    "start",
    [
        ict.Start(poses={"no_box": np.zeros(7)}),
        ict.Start(poses={"red_box": np.zeros(7)}),
        ict.Start(poses={"red_box": np.array([1, 0, 0, 0, 0.5, 0.0, 0.7])}),
        ict.Start(joints=np.zeros(6)),
        ict.Start(joints=np.zeros(7)),
        ict.Start(held="no_box"),
        ict.Start(held="red_box"),
    ],
    ids=["no such box", "no quaternion", "in the air", "six joints", "beyond a limit", "nothing held", "not held"],
)
def test_a_start_that_cannot_be_is_refused(task: ict.Task, start: ict.Start) -> None:
    with pytest.raises(ict.IctampError):
        ict.load(task.spec, start=start)


def test_planning_goes_on_with_what_is_held(plan: ict.Plan, tmp_path: Path) -> None:
    """The first skill of a plan picks a box; planning again from the observed start then needs one skill less."""
    c = plan.attempts[0].successor
    assert c is not None
    assert c.held
    start = ict.Start(joints=c.q, held=c.held, poses=c.poses)
    task = ict.load(plan.spec, start=start)
    assert task.c.held == c.held
    solution = ict.solve(task, time_limit=250)
    assert solution.plan is not None
    assert solution.plan.actions == plan.actions[1:]
    # The scene itself says so, also in its file.
    save_scene(task.spec, tmp_path / "scene.yaml")
    assert ict.load(tmp_path / "scene.yaml").c == task.c


def test_the_console_command_runs_programs(plan: ict.Plan, tmp_path: Path, capfd: pytest.CaptureFixture[str]) -> None:
    plan.save(tmp_path / "plan.yaml")
    assert cli.main(["replay", str(tmp_path / "plan.yaml")]) == 0
    assert (tmp_path / "replay.html").exists()
    assert cli.main(["replay", str(tmp_path / "missing.yaml")]) == 2
    assert cli.main(["no-command"]) == 2
    assert cli.main(["--help"]) == 0
    assert "ictamp COMMAND" in capfd.readouterr().out
