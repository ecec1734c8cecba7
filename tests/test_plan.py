"""The program for your own scenes, as a subprocess: its files, its repeatability, and what it refuses."""

import json
import re
import signal
import subprocess
import time
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import tyro
import yaml

from ictamp_drake import replay
from ictamp_drake.core.types import Configuration
from ictamp_drake.experiments.packing import Packing
from ictamp_drake.plan import PlanOptions, work
from ictamp_drake.runs import program
from ictamp_drake.runs.command import BAD_INPUT, COMPLETE, UNSOLVED
from ictamp_drake.runs.records import Record, read_records
from ictamp_drake.scenes.spec import load_scene
from ictamp_drake.symbolic.context import GeneratorContext
from ictamp_drake.tamp.method import SCENE_METHOD
from ictamp_drake.tamp.plan import read_plan, write_plan
from ictamp_drake.tamp.solve import solve
from ictamp_drake.tamp.task import load
from ictamp_drake.world.config import PhysicsConfig
from tests.runs.programs import SCENE, command, environment, run, timeless

LIMIT = ("--time-limit", "250")  # far more than needed, so that the machine's speed does not matter

CASES = Path(__file__).parent / "scenes" / "cases"
CROWD = CASES / "f3-many-bystanders.yaml"


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a scene in it."""
    folder = tmp_path_factory.mktemp("plan")
    (folder / "scene.yaml").write_text(SCENE)
    return folder


@pytest.fixture(scope="module")
def done(folder: Path) -> subprocess.CompletedProcess[str]:
    return run("plan", "scene.yaml", "--out", "first", *LIMIT, folder=folder, hash_seed=1)


@pytest.fixture(scope="module")
def record(folder: Path, done: subprocess.CompletedProcess[str]) -> Record:
    assert done.returncode == COMPLETE, done.stderr
    (record,) = read_records(folder / "first" / "results.jsonl").values()
    return record


def test_the_record_tells_of_a_verified_plan(record: Record) -> None:
    assert record.solved
    assert record.verified
    assert record.stop_reason == "SOLVED"
    assert record.problem == "scene"
    assert record.level is None
    assert record.error is None
    assert record.plan_length is not None
    assert 2 <= record.plan_length <= record.low_level_steps
    assert record.replay_time_s is not None
    assert 0 < record.replay_time_s < record.planning_time_s
    assert record.replay_time_s <= record.seconds_by_stage["physics"]
    assert record.cpu_time_s is not None
    assert 0 < sum(record.seconds_by_stage.values()) <= record.cpu_time_s  # in total, with late imports


def test_the_output_names_result_and_replay(done: subprocess.CompletedProcess[str], record: Record) -> None:
    assert f"scene  solved with {record.plan_length} skills after {record.planning_time_s:.1f} s" in done.stdout
    assert "1 of 1" in done.stdout
    assert "Replays: first/scene/replay.html" in done.stdout
    assert "Searches: first/scene/search.html" in done.stdout
    assert re.search(r"^\d+:\d\d for \d+ s of planning, \d+\.\d % of the time of 1 worker$", done.stdout, re.MULTILINE)
    assert done.stderr == ""


def test_the_folder_holds_everything(folder: Path, record: Record) -> None:
    problem = folder / "first" / record.problem
    files = {path.name for path in problem.iterdir()}
    pictures = {"tree.svg", "growth.svg", "scene.png", "replay.html", "search.html"}
    assert files == {"scene.yaml", "plan.yaml", "tree.json", *pictures}
    assert load_scene(problem / "scene.yaml") == load_scene(folder / "scene.yaml")
    assert json.loads((problem / "tree.json").read_text())["solution"] is not None
    assert (problem / "scene.png").read_bytes().startswith(b"\x89PNG")
    page = (problem / "replay.html").read_text()
    assert "pick(red_box, table)" in page
    assert "place(red_box, rack)" in page


def test_the_configuration_says_how_the_plan_was_found(folder: Path, record: Record) -> None:
    config = yaml.safe_load((folder / "first" / "config.yaml").read_text())
    assert config["program"] == "plan"
    assert config["scene"]["boxes"].keys() == {"red_box", "blue_box"}
    assert config["options"]["time_limit"] == 250.0
    assert config["options"]["seed"] == record.seed
    (session,) = config["sessions"]
    assert session["versions"]["drake"]
    assert session["host"]["cores"] >= 1


@pytest.mark.parametrize("time_step", [PhysicsConfig().time_step, 0.001])
def test_the_plan_file_replays_to_the_goal(folder: Path, record: Record, time_step: float) -> None:
    plan = read_plan(folder / "first" / record.problem / "plan.yaml")
    replay = plan.replay(PhysicsConfig(time_step=time_step))
    assert replay.reached
    durations = [segment.duration for attempt in plan.attempts for segment in attempt.motion]
    assert record.plan_duration_s == pytest.approx(sum(durations), abs=1e-3)
    executed = sum(segment.duration for outcome in replay.outcomes for segment in outcome.motion)
    assert executed == pytest.approx(record.plan_duration_s, abs=1.0), "and comes to rest at once"
    steps = np.array([attempt.duration for attempt in plan.attempts]) / PhysicsConfig().time_step
    np.testing.assert_allclose(steps, np.round(steps), atol=1e-6)
    X_WO = replay.c.poses["red_box"]
    assert X_WO[6] == pytest.approx(0.16 + 0.05, abs=0.002)  # on the rack's plate


def test_a_plan_without_its_last_skill_does_not_reach_the_goal(folder: Path, record: Record) -> None:
    plan = read_plan(folder / "first" / record.problem / "plan.yaml")
    assert not replace(plan, attempts=plan.attempts[:-1]).replay().reached


def test_the_plan_file_is_plain_yaml_in_si_units(folder: Path, record: Record) -> None:
    content = yaml.safe_load((folder / "first" / record.problem / "plan.yaml").read_text())
    assert content["skeleton"][-1] == "place(red_box, rack)"
    assert content["skeleton"] == [step["action"] for step in content["steps"]]
    segments = [segment for step in content["steps"] for segment in step["segments"]]
    clock = 0.0
    q = content["initial"]["commanded"]
    for segment in segments:
        assert segment["control_points"][0] == pytest.approx(q, rel=0, abs=1e-9)  # continues from its commanded place
        q = segment["control_points"][-1]
        assert segment["start"] == pytest.approx(clock)
        clock += segment["duration"]
        assert len(segment["knots"]) == len(segment["control_points"]) + segment["order"]
        assert segment["knots"][-1] == pytest.approx(segment["duration"])
        assert np.shape(segment["control_points"])[1:] == (7,)
    forces = [segment["gripper"]["force"] for segment in segments]
    assert forces[0] == forces[-1] == 0.0 < max(forces)


def test_a_plan_is_read_back_as_it_was_written(folder: Path, record: Record, tmp_path: Path) -> None:
    path = folder / "first" / record.problem / "plan.yaml"
    plan = read_plan(path)
    assert isinstance(plan.c, Configuration)
    write_plan(plan, tmp_path / "plan.yaml")
    assert (tmp_path / "plan.yaml").read_text() == path.read_text()


def test_the_same_seed_gives_the_same_record_and_plan(folder: Path, record: Record) -> None:
    again = run("plan", "scene.yaml", "--out", "second", *LIMIT, folder=folder, hash_seed=2)
    assert again.returncode == COMPLETE, again.stderr
    (other,) = read_records(folder / "second" / "results.jsonl").values()
    assert timeless(other) == timeless(record)
    for file in ("plan.yaml", "tree.json"):
        first, second = ((folder / out / "scene" / file).read_bytes() for out in ("first", "second"))
        assert first == second


def test_a_finished_run_has_nothing_left_to_do(
    folder: Path, record: Record, capsys: pytest.CaptureFixture[str]
) -> None:
    before = (folder / "first" / "results.jsonl").read_bytes()
    arguments = [str(folder / "scene.yaml"), "--out", str(folder / "first"), "--resume", *LIMIT]
    assert program.main("ictamp_drake.plan", PlanOptions, work, arguments) == COMPLETE
    assert "0 problems to solve, 1 done before" in capsys.readouterr().out
    assert (folder / "first" / "results.jsonl").read_bytes() == before
    assert record.is_final


def refuse(capsys: pytest.CaptureFixture[str], *arguments: str) -> str:
    """Sentence with which the program refuses the arguments."""
    assert program.main("ictamp_drake.plan", PlanOptions, work, arguments) == BAD_INPUT
    output = capsys.readouterr()
    assert output.out == ""
    assert output.err.count("\n") == 1
    return output.err.strip()


@pytest.mark.parametrize(
    ("change", "field"),
    [
        (("(on red_box rack)", "(on green_box rack)"), "goal"),
        (("(on red_box rack)", "(and (on red_box rack) (on red_box table))"), "goal"),
        (("goal:", "gaol:"), "gaol"),
        (("[0.5, 0.3, 0.04]", "[0.46, 0.11, 0.04]"), "boxes"),
        (("[0.5, 0.3, 0.04]", "[0.5, 0.3, 0.14]"), "boxes.blue_box.position"),
        (("[0.05, 0.05, 0.08]", "[0.09, 0.09, 0.08]"), "boxes.blue_box.size"),
    ],
)
def test_a_bad_scene_is_refused_in_one_sentence(
    change: tuple[str, str], field: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE.replace(*change))
    message = refuse(capsys, str(path), "--out", str(tmp_path / "out"))
    assert re.match(rf"{re.escape(str(path))}, line \d+: {re.escape(field)}: ", message)
    assert not (tmp_path / "out").exists()


def test_the_generator_and_its_W_are_chosen_together() -> None:
    own = tyro.cli(PlanOptions, args=["scene.yaml", "--planner", "completion-tree"])
    chosen = [own.method.decisive, tyro.cli(Packing, args=[]).method.decisive]
    assert [tuple(options["generators"]) for options in chosen] == [("best_first",), ("breadth_first",)]
    assert [options["planners"]["completion_tree"]["W"] for options in chosen] == [3.0, 30.0]


def test_a_crowd_of_bystanders_makes_the_first_plan_no_harder_to_find() -> None:
    method = PlanOptions(CROWD).method
    task = load(CROWD, method)
    assert len(task.domain.boxes) == 21
    stream = method.generator_config.create(GeneratorContext(task.domain, task.abstraction(task.c), task.goal))
    plan = stream.next_plan(method.max_expansions)
    assert plan is not None
    assert len(plan) == 10
    assert stream.expanded <= 20


@pytest.mark.parametrize("case", ["f3-many-bystanders", "files/f10-thirty-boxes"])
def test_crowds_are_planned_in_by_default(case: str) -> None:
    solution = solve(load(CASES / f"{case}.yaml"), time_limit=250, max_steps=100)
    assert solution.plan is not None, solution.result.stop_reason


@pytest.mark.parametrize("seed", [0, 1, 2])
@pytest.mark.parametrize("case", ["neighbours-8-mm", "neighbours-on-two-sides"])
def test_a_box_is_taken_from_between_its_neighbours_and_what_no_skill_moves_stays(case: str, seed: int) -> None:
    method = replace(SCENE_METHOD, seed=seed, time_limit=250, max_steps=200)
    solution = solve(load(CASES / f"{case}.yaml", method), method)
    assert solution.result.plan is not None, solution.result.stop_reason
    assert sum(bool(step.attempt.motion) for step in solution.result.tree.steps) <= 10
    end = solution.result.plan[-1].successor
    assert end is not None
    for name in set(solution.task.spec.boxes) - {attempt.action.args[0] for attempt in solution.result.plan}:
        np.testing.assert_allclose(end.poses[name], solution.task.c.poses[name], atol=1e-4)


@pytest.mark.parametrize(("case", "skills"), [("02-pick-between-neighbours", 2), ("13-two-mixed-towers", 16)])
def test_the_default_moves_what_it_must_and_no_more(case: str, skills: int) -> None:
    method = replace(SCENE_METHOD, time_limit=250)
    plan = solve(load(CASES / f"{case}.yaml", method), method).plan
    assert plan is not None
    assert len(plan) <= skills


def test_the_search_goes_on_and_the_best_plan_is_kept(
    folder: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    arguments = [str(folder / "scene.yaml"), "--out", str(tmp_path), "--artefacts", "plan", "--improve", "4", *LIMIT]
    assert program.main("ictamp_drake.plan", PlanOptions, work, arguments) == COMPLETE
    (record,) = read_records(tmp_path / "results.jsonl").values()
    assert len(record.found) > 1
    assert list(record.found) == sorted(record.found, key=lambda plan: (-plan[0], -plan[1], plan[2]))
    assert record.found[0][2] == record.planning_time_s
    assert (record.plan_length, record.plan_duration_s) == record.found[-1][:2]
    plan = read_plan(tmp_path / "scene" / "plan.yaml")
    assert (len(plan), round(plan.duration, 4)) == record.found[-1][:2]
    assert plan.replay().reached
    assert capsys.readouterr().out.count("found after") == len(record.found)


def test_ctrl_c_while_a_plan_is_improved_keeps_it_and_leaves_nothing_to_do(folder: Path, tmp_path: Path) -> None:
    options = [folder / "scene.yaml", "--out", tmp_path, "--artefacts", "plan", "--improve", "600", *LIMIT]
    with subprocess.Popen(command("plan", *options), cwd=folder, env=environment()) as process:
        while not (tmp_path / "scene" / "plan.yaml").exists():
            assert process.poll() is None
            time.sleep(0.1)
        process.send_signal(signal.SIGINT)
        assert process.wait(60) == COMPLETE
    (record,) = read_records(tmp_path / "results.jsonl").values()
    assert record.is_final
    assert len(read_plan(tmp_path / "scene" / "plan.yaml")) == record.plan_length


def test_a_goal_that_holds_already_is_solved_by_an_empty_plan(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    scene, out = CASES / "16-nothing-to-do.yaml", tmp_path / "out"
    assert program.main("ictamp_drake.plan", PlanOptions, work, [str(scene), "--out", str(out)]) == COMPLETE
    assert "nothing to do: the goal holds" in capsys.readouterr().out
    (record,) = read_records(out / "results.jsonl").values()
    assert (record.solved, record.plan_length, record.low_level_steps, record.error) == (True, 0, 0, None)
    problem = out / "16-nothing-to-do"
    assert {"plan.yaml", "replay.html", "search.html", "tree.svg", "growth.svg"} <= {p.name for p in problem.iterdir()}
    plan = read_plan(problem / "plan.yaml")
    assert len(plan) == 0
    assert plan.duration == 0.0
    assert plan.replay().reached
    page = tmp_path / "replay.html"
    assert replay.main([str(problem / "plan.yaml"), "--out", str(page)]) == COMPLETE
    assert page.exists()


def test_a_problem_that_is_not_solved_exits_with_1(folder: Path, tmp_path: Path) -> None:
    arguments = [str(folder / "scene.yaml"), "--out", str(tmp_path / "out"), "--max-steps", "1", *LIMIT]
    assert program.main("ictamp_drake.plan", PlanOptions, work, arguments) == UNSOLVED


def test_a_missing_scene_is_named(folder: Path) -> None:
    missing = run("plan", "nowhere.yaml", folder=folder)
    assert missing.returncode == BAD_INPUT
    assert missing.stderr.startswith("nowhere.yaml: ")
    assert missing.stderr.count("\n") == 1
    assert missing.stdout == ""


def test_a_changed_scene_does_not_go_on_in_the_folder_of_the_old_one(
    folder: Path, record: Record, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    assert record.solved
    path = tmp_path / "scene.yaml"
    path.write_text(SCENE.replace("[0.5, 0.3, 0.04]", "[0.5, 0.31, 0.04]"))
    message = refuse(capsys, str(path), "--out", str(folder / "first"), *LIMIT)
    assert message.startswith(f"{folder / 'first'}: scene.boxes.blue_box.position: ")


def test_what_is_impossible_is_said_without_a_search(tmp_path: Path) -> None:
    scene = CASES / "07-wholly-under-a-shelf.yaml"
    done = run("plan", str(scene), "--out", "out", "--artefacts", "plan", folder=tmp_path)
    assert done.returncode == UNSOLVED
    (record,) = read_records(tmp_path / "out" / "results.jsonl").values()
    assert record.stop_reason == "IMPOSSIBLE"
    assert record.low_level_steps == 0
    assert set(record.obstacles["pick(jar, table)"]) == {"board"}
    assert "no grasp on a grid" in " ".join(done.stdout.split())
    assert "no grasp on a grid" in (tmp_path / "out" / "index.html").read_text()
