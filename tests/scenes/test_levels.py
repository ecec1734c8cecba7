"""The committed problem files, and how to select them."""

from collections import Counter
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.robots.spec import DEFAULT, SHIPPED, find_file
from ictamp_drake.scenes.levels import ARM_OFFSETS, LEVELS, PAPER_LEVELS, load_problem, parse_selection, problem_files
from ictamp_drake.scenes.packing import make_problem
from ictamp_drake.scenes.spec import load_scene, to_yaml
from tests.refusals import refusal


@pytest.mark.parametrize(
    ("level", "count"), [("easy", 55), ("medium", 37), ("hard", 17), ("extreme", 30), ("varied", 40)]
)
def test_the_generator_gives_the_committed_files_byte_for_byte(level: str, count: int) -> None:
    files = problem_files(level)
    assert len(files) == count
    assert sorted(files[0].parent.iterdir()) == files
    for number, path in enumerate(files):
        assert to_yaml(make_problem(level, number)).encode() == path.read_bytes()


@pytest.mark.parametrize("level", LEVELS)
def test_the_committed_files_are_distinct_scenes(level: str) -> None:
    specs = [load_scene(path) for path in problem_files(level)]
    places = {tuple(sorted((name, box.position) for name, box in spec.boxes.items())) for spec in specs}
    assert len(places) == len(specs)


@pytest.mark.parametrize("level", PAPER_LEVELS)
def test_the_committed_files_have_all_kinds(level: str) -> None:
    specs = [load_scene(path) for path in problem_files(level)]
    plain = sum(not spec.interference for spec in specs)
    assert plain == -(-len(specs) // 3)
    mixes = Counter(spec.interference for spec in specs if spec.interference)
    assert len(mixes) == (4 if level == "medium" else 7)
    assert max(mixes.values()) - min(mixes.values()) <= 1


@pytest.mark.parametrize(
    ("selection", "numbers"),
    [("3", [3]), ("0:5", [0, 1, 2, 3, 4]), (":", list(range(17))), ("15:", [15, 16]), (":2", [0, 1]), ("16:99", [16])],
)
def test_selections(selection: str, numbers: list[int]) -> None:
    assert list(parse_selection(selection, 17)) == numbers
    assert [path.name for path in problem_files("hard", selection)] == [f"{number:03d}.yaml" for number in numbers]


@pytest.mark.parametrize("selection", ["", "a", "1,2", "-1", "1:2:3", "1.5", "0-5", 5000 * "1", "٣"])
def test_a_selection_that_is_not_understood(selection: str) -> None:
    with refusal(Code.WRONG_TYPE, "problems", value=selection):
        parse_selection(selection, 17)


@pytest.mark.parametrize("selection", ["17", "5:5", "5:3", "17:"])
def test_a_selection_of_nothing(selection: str) -> None:
    with refusal(Code.OUT_OF_RANGE, "problems", value=selection):
        parse_selection(selection, 17)


def test_an_unknown_level() -> None:
    with refusal(Code.UNKNOWN_CHOICE, "level", value="heavy", choices=LEVELS):
        problem_files("heavy")
    with refusal(Code.UNKNOWN_CHOICE, "level", value="heavy", choices=LEVELS):
        make_problem("heavy", 0)


def test_a_robot_of_ones_own_stands_where_the_panda_does(tmp_path: Path) -> None:
    (tmp_path / "own.yaml").write_text(find_file(DEFAULT).read_text())
    (path,) = problem_files("varied", "1")
    spec = load_scene(path)
    own = str(tmp_path / "own.yaml")
    assert load_problem(path) == load_problem(path, DEFAULT) == spec
    assert load_problem(path, own) == replace(spec, robot=own)


@pytest.mark.parametrize("robot", ["iiwa14_wsg50"])
@pytest.mark.parametrize("level", ["easy", "varied"])
def test_some_robots_stand_elsewhere_and_all_else_stays(robot: str, level: str) -> None:
    assert ARM_OFFSETS.keys() <= set(SHIPPED)
    (path,) = problem_files(level, "1")
    spec, moved = load_scene(path), load_problem(path, robot)
    yaw = np.deg2rad(spec.arm.yaw)
    offset = np.subtract(moved.arm.position, spec.arm.position)
    turned = np.array([[np.cos(yaw), np.sin(yaw), 0], [-np.sin(yaw), np.cos(yaw), 0], [0, 0, 1]]) @ offset
    np.testing.assert_allclose(turned, ARM_OFFSETS[robot], atol=1e-12)
    assert replace(moved, robot=DEFAULT, arm=spec.arm) == spec
