"""The comparison of strategies as users run it."""

import json
from collections import Counter
from pathlib import Path

import pytest
import yaml

from ictamp_drake.core.errors import Code
from ictamp_drake.experiments.runner import Runner, work
from ictamp_drake.runs import program
from ictamp_drake.runs.command import BAD_INPUT, COMPLETE
from ictamp_drake.runs.records import read_records
from ictamp_drake.scenes.levels import PAPER_LEVELS, problem_files
from tests.refusals import refusal
from tests.runs.programs import run

QUICK = "--planner round-robin --estimator constant --max-steps 1 --time-limit 200"


def compare(folder: Path, *arguments: str) -> str:
    done = run("experiments.runner", "--out", "out", *arguments, folder=folder)
    assert done.returncode == COMPLETE, done.stderr
    return done.stdout


def test_a_comparison_can_be_widened_and_repeats_nothing(tmp_path: Path) -> None:
    first = ("--strategies", f"one={QUICK}", "--levels", "easy", "--problems", "0:2")
    assert "2 problems to solve, 0 done before" in compare(tmp_path, *first)
    wider = ("--strategies", f"one={QUICK}", f"two={QUICK} --sampler uniform", "--levels", "easy", "hard")
    output = compare(tmp_path, *wider, "--problems", "0:2", "--seeds", "0", "7")
    assert "14 problems to solve, 2 done before" in output
    assert "easy  one" in output
    assert "hard  two" in output
    lines = [json.loads(line) for line in (tmp_path / "out" / "results.jsonl").read_text().splitlines()]
    assert len(lines) == 16
    counts = Counter((line["strategy"], line["seed"], line["level"]) for line in lines)
    assert set(counts.values()) == {2}
    assert len(read_records(tmp_path / "out" / "results.jsonl")) == 16
    config = yaml.safe_load((tmp_path / "out" / "config.yaml").read_text())
    assert list(config["strategies"]) == ["one", "two"]
    assert config["strategies"]["two"]["sampler"] == "uniform"


def test_problems_take_turns_with_all_strategies() -> None:
    jobs = work(Runner(strategies=("adaptive", "stap"), levels=("easy",), problems="0:2", seeds=(0, 1))).jobs
    assert [job.name for job in jobs[:5]] == [
        "adaptive/0/easy-000",
        "adaptive/1/easy-000",
        "stap/0/easy-000",
        "stap/1/easy-000",
        "adaptive/0/easy-001",
    ]


def test_scenes_of_ones_own_take_the_place_of_the_levels_or_come_after_them(tmp_path: Path) -> None:
    files = problem_files("easy", "3:5")
    scenes = (tmp_path / "kitchen.yaml", tmp_path / "desk.yaml")
    for file, scene in zip(files, scenes, strict=True):
        scene.write_bytes(file.read_bytes())
    alone = work(Runner(strategies=("adaptive",), scenes=scenes)).jobs
    assert [(job.name, job.problem.level) for job in alone] == [("adaptive/0/kitchen", None), ("adaptive/0/desk", None)]
    together = work(Runner(strategies=("adaptive",), levels=("hard",), problems="3", scenes=scenes)).jobs
    assert [job.problem.name for job in together] == ["hard-003", "kitchen", "desk"]
    assert {job.problem.level for job in work(Runner()).jobs} == set(PAPER_LEVELS)


@pytest.mark.parametrize(
    ("scenes", "code", "field"),
    [
        (("a/desk.yaml", "a/shelf.yaml"), Code.NOT_READABLE, ""),
        (("a/desk.yaml", "b/desk.yaml"), Code.REPEATED, "scenes"),
        (("a/.yaml",), Code.BAD_NAME, "name"),
        (("a/goal.yaml",), Code.UNKNOWN_CHOICE, "goal"),
    ],
)
def test_scenes_that_are_not_fit_or_share_a_name_are_refused(
    tmp_path: Path, scenes: tuple[str, ...], code: Code, field: str
) -> None:
    for folder in ("a", "b"):
        (tmp_path / folder).mkdir()
        for name in ("desk.yaml", ".yaml"):
            (tmp_path / folder / name).write_bytes(problem_files("easy", "0")[0].read_bytes())
    desk = (tmp_path / "a" / "desk.yaml").read_text()
    (tmp_path / "a" / "goal.yaml").write_text(desk.replace("(on cyan_box rack)", "(on cyan_box sofa)"))
    with refusal(code, field):
        work(Runner(scenes=tuple(tmp_path / scene for scene in scenes)))


def test_all_bad_scenes_are_named_at_once_and_can_be_left_out(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    good = problem_files("easy", "0")[0].read_text()
    bad = good.replace("(on cyan_box rack)", "(on cyan_box sofa)")
    contents = {"first": bad, "good": good, "second": bad, "results.jsonl": good, "third": "boxes: ["}
    scenes = tuple(tmp_path / f"{name}.yaml" for name in contents)
    for scene, content in zip(scenes, contents.values(), strict=True):
        scene.write_text(content)
    arguments = ["--strategies", "adaptive", "--out", str(tmp_path / "out"), "--scenes", *map(str, scenes)]
    assert program.main("ictamp_drake.experiments.runner", Runner, work, arguments) == BAD_INPUT
    refused = capsys.readouterr().err
    for name in ("first.yaml", "second.yaml", "third.yaml", "'results.jsonl'"):
        assert refused.count(name) == 1, refused
    assert "4 of 5 scenes" in refused
    assert not (tmp_path / "out").exists()
    options = Runner(strategies=("adaptive",), scenes=scenes, skip_bad_scenes=True)
    assert [job.problem.name for job in work(options).jobs] == ["good"]
    assert capsys.readouterr().err.count("left out: ") == 4
    with refusal(Code.UNKNOWN_CHOICE, "goal"):
        work(Runner(strategies=("adaptive",), scenes=scenes[:1], skip_bad_scenes=True))


def test_a_scene_with_the_name_of_a_problem_is_refused(tmp_path: Path) -> None:
    scene = tmp_path / "easy-000.yaml"
    scene.write_bytes(problem_files("easy", "0")[0].read_bytes())
    with refusal(Code.REPEATED, "scenes", value=str(scene)):
        work(Runner(levels=("hard",), scenes=(scene,)))


def test_a_comparison_does_not_go_on_with_another_scene_of_the_same_name(tmp_path: Path) -> None:
    for folder, file in zip("ab", problem_files("easy", "0:2"), strict=True):
        (tmp_path / folder).mkdir()
        (tmp_path / folder / "desk.yaml").write_bytes(file.read_bytes())
    own = ("--strategies", f"one={QUICK}", "--scenes")
    assert "own scenes  one" in compare(tmp_path, *own, "a/desk.yaml")
    done = run("experiments.runner", "--out", "out", *own, "b/desk.yaml", folder=tmp_path)
    assert done.returncode == BAD_INPUT
    assert done.stderr.startswith("out: scenes.desk.")
    assert len(read_records(tmp_path / "out" / "results.jsonl")) == 1


@pytest.mark.parametrize(
    ("arguments", "place"),
    [
        (("--strategies", "best"), "strategies: "),
        (("--regime", "product"), "regime: "),
        (("--levels", "heavy"), "level: "),
        (("--seeds", "-1"), "seeds: "),
        (("--seeds", "3", "3"), "seeds: "),
        (("--levels", "easy", "easy"), "levels: "),
        (("--levels", "easy", "hard", "--problems", "40:"), "problems: "),
        (("--seeds",), "seeds: "),
    ],
)
def test_bad_options_are_refused_in_one_sentence(
    arguments: tuple[str, ...], place: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = ["--out", str(tmp_path / "out"), *arguments]
    assert program.main("ictamp_drake.experiments.runner", Runner, work, options) == BAD_INPUT
    assert capsys.readouterr().err.startswith(place)
    assert not (tmp_path / "out").exists()
