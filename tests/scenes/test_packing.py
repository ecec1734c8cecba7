"""Laws of generated packing problems, for any level, number and seed. Distances are Drake's, between the solids."""

import itertools
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.core.seeding import Stream
from ictamp_drake.scenes.levels import LEVELS, PAPER_LEVELS
from ictamp_drake.scenes.packing import make_problem, write_problems
from ictamp_drake.scenes.spec import SceneSpec, load_scene
from tests.scenes.solids import carriers, check_clearances, height

problems = st.builds(make_problem, st.sampled_from(sorted(PAPER_LEVELS)), st.integers(0, 999), st.integers(0, 999))


@given(problems)
def test_boxes_touch_what_carries_them_and_keep_clear_of_all_else(spec: SceneSpec) -> None:
    assert "rack" not in carriers(spec).values()
    check_clearances(spec)


@given(problems)
def test_boxes_are_on_the_table_and_within_reach(spec: SceneSpec) -> None:
    for box in spec.boxes.values():
        x, y, _ = box.position
        assert np.hypot(x, y) < 0.7
        assert -0.3 < x < 0.9
        assert abs(y) < 0.45
        assert x >= 0.28 - 0.04 or -0.32 <= x <= -0.13


@given(problems)
def test_the_tower_stands_upright_in_the_order_of_the_goal(spec: SceneSpec) -> None:
    carried_by = carriers(spec)
    level = next(level for level in PAPER_LEVELS.values() if len(level.tower) == spec.goal.count("(on "))
    for below, above in itertools.pairwise(("table", *level.tower)):
        assert carried_by[above] == below
        assert f"(on {above} {'rack' if below == 'table' else below})" in spec.goal
        assert spec.boxes[above].rotation[:2] == (0, 0)
    assert spec.boxes[level.tower[0]].position[0] >= 0.40


@given(problems)
def test_the_kinds_are_those_declared(spec: SceneSpec) -> None:
    carried_by = carriers(spec)
    others = {name: box for name, box in spec.boxes.items() if f"(on {name} " not in spec.goal}
    kinds = set()
    for name, box in others.items():
        assert (box.rotation[:2] == (0, 0)) == (height(box) == pytest.approx(box.size[2]))
        kinds |= {"stacked"} if carried_by[name] != "table" else set()
        kinds |= {"behind"} if box.position[0] < 0 else set()
        kinds |= {"tipped"} if box.rotation[:2] != (0, 0) else set()
    assert kinds == set(spec.interference)


@given(st.sampled_from(sorted(PAPER_LEVELS)), st.integers(0, 999), st.integers(0, 999))
def test_every_third_problem_is_plain(level: str, number: int, seed: int) -> None:
    spec = make_problem(level, number, seed)
    assert (spec.interference == ()) == (number % 3 == 0)
    others = len(spec.boxes) - len(PAPER_LEVELS[level].tower)
    assert others in {"easy": {2}, "medium": {1}, "hard": {0} if number % 3 == 0 else {1, 2}}[level]


def test_a_problem_depends_on_all_its_arguments_and_on_nothing_else() -> None:
    problem = make_problem("easy", 1)
    assert make_problem("easy", 1) == problem
    for other in (
        make_problem("easy", 8),
        make_problem("easy", 1, seed=1),
        make_problem("easy", 1, stream=Stream.DATA),
    ):
        assert other.boxes != problem.boxes


@pytest.mark.parametrize("level", LEVELS)
def test_files_are_written(level: str, tmp_path: Path) -> None:
    write_problems(level, tmp_path / "new", count=2, seed=5)
    paths = sorted((tmp_path / "new").iterdir())
    assert [path.name for path in paths] == ["000.yaml", "001.yaml"]
    assert [load_scene(path) for path in paths] == [make_problem(level, number, 5) for number in range(2)]


def test_the_program_names_an_unknown_level(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "ictamp_drake.scenes.packing", "--level", "heavy", "--out", str(tmp_path)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 2
    assert result.stderr.startswith("level: ")
    assert result.stderr.count("\n") == 1
