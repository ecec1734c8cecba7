"""Another robot than the scene's, and what serves with it in place of parts trained with the Panda."""

from dataclasses import replace
from pathlib import Path

import pytest

import ictamp_drake as ict
from ictamp_drake.core.errors import Code
from ictamp_drake.core.types import Action
from ictamp_drake.experiments.runner import Runner
from ictamp_drake.experiments.runner import work as runner_work
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.robots.spec import DEFAULT, find_file
from ictamp_drake.runs.command import BAD_INPUT, COMPLETE
from ictamp_drake.runs.records import Record, read_records
from ictamp_drake.scenes.spec import load_scene, to_dict
from ictamp_drake.skills.chain import ChainSampler
from ictamp_drake.skills.config import GeometricConfig, PolicyConfig, UniformConfig
from ictamp_drake.skills.context import SamplerContext
from ictamp_drake.tamp.method import SCENE_METHOD, Method
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World
from tests.learning.synthetic import write_untrained
from tests.refusals import refusal
from tests.runs.programs import SCENE, run, run_code

LIMIT = ("--time-limit", "250", "--artefacts", "plan")


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with a scene, and a Panda under another name."""
    folder = tmp_path_factory.mktemp("other")
    (folder / "scene.yaml").write_text(SCENE)
    (folder / "other.yaml").write_text(find_file(DEFAULT).read_text())
    return folder


@pytest.fixture(scope="module")
def other(folder: Path) -> str:
    return str(folder / "other.yaml")


def record(folder: Path) -> Record:
    (record,) = read_records(folder / "results.jsonl").values()
    return record


def test_a_robot_replaces_that_of_the_scene(folder: Path, other: str) -> None:
    task = ict.load(folder / "scene.yaml", robot=other)
    assert task.world.robot.name == task.spec.robot == other
    assert to_dict(task.spec)["robot"] == other
    assert replace(task.spec, robot=DEFAULT) == load_scene(folder / "scene.yaml")


@pytest.mark.parametrize(("robot", "code"), [("pandas", Code.UNKNOWN_CHOICE), ("none.yaml", Code.NOT_READABLE)])
def test_a_robot_that_does_not_exist_is_refused(folder: Path, robot: str, code: Code) -> None:
    with refusal(code):
        ict.load(folder / "scene.yaml", robot=robot)


def test_the_panda_keeps_the_parts_that_were_chosen() -> None:
    assert SCENE_METHOD.suited_to(DEFAULT) == SCENE_METHOD
    assert SCENE_METHOD.list_stand_ins(DEFAULT) == {}
    assert SCENE_METHOD.tell_stand_ins(DEFAULT) == ""


@pytest.mark.parametrize("estimator", ["p-score", "q-value"])
def test_geometry_and_a_constant_serve_where_nothing_was_trained(other: str, estimator: str) -> None:
    method = Method(estimator=estimator)
    assert method.list_stand_ins(other) == {"sampler": "geometric", "estimator": "constant"}
    suited = method.suited_to(other)
    assert not suited.learned
    assert suited.suited_to(other) == suited
    assert all(name in method.tell_stand_ins(other) for name in ("policy", "geometric", estimator, "constant"))


def test_parts_without_training_serve_every_robot(other: str) -> None:
    method = Method(sampler="optimization", estimator="monte-carlo")
    assert method.suited_to(other) == method


def test_a_rule_that_needs_trained_critics_is_refused(folder: Path, other: str) -> None:
    with refusal(Code.CONFLICT, "planner", value="stap"):
        ict.solve(ict.load(folder / "scene.yaml", robot=other), planner="stap")


def test_a_solution_says_what_served(folder: Path, other: str) -> None:
    solution = ict.solve(ict.load(folder / "scene.yaml", robot=other), time_limit=250)
    assert solution.plan is not None
    assert solution.stand_ins == {"sampler": "geometric", "estimator": "constant"}
    assert (solution.method.sampler, solution.method.estimator) == ("geometric", "constant")
    assert solution.plan.origin is not None
    assert solution.plan.origin.options["sampler"] == "geometric"


def test_no_network_is_loaded_for_another_robot(folder: Path, other: str) -> None:
    load = f"ict.load({str(folder / 'scene.yaml')!r}, robot={other!r})"
    code = f"import sys, ictamp_drake as ict; ict.solve({load}, max_steps=1); print('torch' in sys.modules)"
    assert run_code(code, 0).strip() == "False"


def test_the_policy_does_not_apply_to_another_robot(tmp_path: Path, folder: Path, other: str) -> None:
    checkpoints, action = write_untrained(tmp_path), Action("pick", ("red_box", "table"))
    for robot in (DEFAULT, other):
        world = World(replace(load_scene(folder / "scene.yaml"), robot=robot))
        arm = ArmKinematics(world.robot, to_transform(world.spec.arm.X_WB))
        context, c = SamplerContext(world, arm), world.initial_configuration()
        policy = PolicyConfig(checkpoints).create(context)
        assert policy.applies(c, action) == (robot == DEFAULT)
        assert isinstance(GeometricConfig().create(context), ChainSampler)
        assert len(ChainSampler([policy, UniformConfig().create(context)], 1).serving(c, action)) == 1 + policy.applies(
            c, action
        )


def test_plan_replaces_the_robot_and_says_so(folder: Path, other: str) -> None:
    done = run("plan", "scene.yaml", "--robot", "other.yaml", "--out", "plan", *LIMIT, folder=folder)
    assert done.returncode == COMPLETE, done.stderr
    assert done.stdout.count("other.yaml, in place of") == done.stdout.count("geometric") == 1
    found = record(folder / "plan")
    assert (found.robot, found.stand_ins) == (other, {"sampler": "geometric", "estimator": "constant"})
    again = run("plan", "scene.yaml", "--out", "plan", *LIMIT, folder=folder)
    assert again.returncode == BAD_INPUT
    assert "robot" in again.stderr


def test_packing_with_another_robot_is_continued_with_it_alone(folder: Path) -> None:
    options = ("--problems", "0", "--out", "packing", "--max-steps", "1", *LIMIT)
    done = run("experiments.packing", *options, "--robot", "other.yaml", folder=folder)
    assert done.returncode == 1, done.stderr
    assert record(folder / "packing").robot == str(folder / "other.yaml")
    for robot in ((), ("--robot", "panda")):
        refused = run("experiments.packing", *options, *robot, folder=folder)
        assert refused.returncode == BAD_INPUT
        assert "robot" in refused.stderr


def test_the_runner_takes_levels_and_scenes_with_another_robot(folder: Path, other: str) -> None:
    options = Runner(
        levels=("easy",), problems="0", scenes=(folder / "scene.yaml",), strategies=("p-score",), robot=other
    )
    found = runner_work(options)
    assert [job.problem.spec.robot for job in found.jobs] == [other, other]
    assert found.about["robot"] == found.about["scenes"]["scene"]["robot"] == other
    assert "robot" not in runner_work(replace(options, robot=None)).about


@pytest.mark.parametrize(
    ("program", "arguments"),
    [
        ("plan", ("scene.yaml", "--robot", "pandas")),
        ("experiments.packing", ("--robot", "pandas")),
        ("experiments.runner", ("--robot", "none.yaml")),
        ("plan", ("scene.yaml", "--robot", "other.yaml", "--planner", "stap")),
        ("experiments.runner", ("--strategies", "stap", "--robot", "other.yaml", "--problems", "0")),
    ],
)
def test_what_cannot_serve_is_refused_before_anything_is_written(
    folder: Path, program: str, arguments: tuple[str, ...]
) -> None:
    refused = run(program, *arguments, "--out", "refused", folder=folder)
    assert refused.returncode == BAD_INPUT
    assert refused.stderr.count("\n") == 1
    assert not (folder / "refused").exists()
