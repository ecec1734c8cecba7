"""Laws of generated packing problems, for any level, number and seed; distances are Drake's, between the solids."""

import itertools
import subprocess
import sys
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.common.eigen_geometry import Quaternion
from pydrake.geometry import Box, Cylinder, GeometryInstance, ProximityProperties, SceneGraph, Shape
from pydrake.math import RigidTransform

from ictamp_drake.core.seeding import Stream
from ictamp_drake.scenes.levels import LEVELS
from ictamp_drake.scenes.packing import make_problem, write_problems
from ictamp_drake.scenes.spec import SUPPORT_SIZES, BoxSpec, SceneSpec, load_scene

TOUCHING = 1e-5
ARM_RADIUS = 0.16

problems = st.builds(make_problem, st.sampled_from(sorted(LEVELS)), st.integers(0, 999), st.integers(0, 999))


def _height(box: BoxSpec) -> float:
    """Vertical extent of a box [m]."""
    return float(np.abs(_transform(box.X_WO).rotation().matrix()[2]) @ box.size)


def _transform(pose: Any) -> RigidTransform:
    return RigidTransform(Quaternion(pose[:4]), pose[4:])


def _distances(spec: SceneSpec) -> dict[frozenset[str], float]:
    """Signed distances between boxes, rack (as a solid) and the arm's base (as a column), by pairs of names [m]."""
    graph = SceneGraph()
    source = graph.RegisterSource("scene")
    upright: tuple[float, ...] = (1, 0, 0, 0)
    x, y, z = SUPPORT_SIZES["rack"]
    solids: dict[str, tuple[Shape, RigidTransform]] = {
        "rack": (Box(y, x, z), _transform(np.array([*upright, 0.44, -0.33, z / 2]))),
        "arm": (Cylinder(ARM_RADIUS, 2.0), _transform(np.array([*upright, 0, 0, 1]))),
        **{name: (Box(*box.size), _transform(box.X_WO)) for name, box in spec.boxes.items()},
    }
    names = {}
    for name, (shape, X_WG) in solids.items():
        instance = GeometryInstance(X_WG, shape, name)
        instance.set_proximity_properties(ProximityProperties())
        names[graph.RegisterAnchoredGeometry(source, instance)] = name
    context = graph.CreateDefaultContext()
    query: Any = graph.get_query_output_port().Eval(context)
    return {
        frozenset((names[a], names[b])): query.ComputeSignedDistancePairClosestPoints(a, b).distance
        for a, b in itertools.combinations(names, 2)
    }


def _carriers(spec: SceneSpec) -> dict[str, str]:
    """What each box stands on: the box whose top face is at its bottom face and below its centre, or the table."""
    carriers = {}
    for name, box in spec.boxes.items():
        bottom = box.position[2] - _height(box) / 2
        if abs(bottom) < 1e-9:
            carriers[name] = "table"
            continue
        below = [
            other
            for other, it in spec.boxes.items()
            if abs(it.position[2] + _height(it) / 2 - bottom) < 1e-9
            and np.hypot(*np.subtract(it.position, box.position)[:2]) < 0.01
        ]
        assert len(below) == 1, f"{name} floats"
        carriers[name] = below[0]
    return carriers


def _foot(name: str, carriers: dict[str, str]) -> str:
    return name if carriers[name] == "table" else _foot(carriers[name], carriers)


@given(problems)
def test_boxes_touch_what_carries_them_and_keep_clear_of_all_else(spec: SceneSpec) -> None:
    carriers = _carriers(spec)
    for pair, distance in _distances(spec).items():
        boxes = sorted(pair - {"rack", "arm"})
        if "rack" in pair and boxes:
            assert distance >= 0.02 - TOUCHING
        elif "arm" in pair and boxes:
            assert distance > 0
        elif len(boxes) == 2:
            first, second = boxes
            if carriers[first] == second or carriers[second] == first:
                assert distance == pytest.approx(0, abs=TOUCHING)
            elif _foot(first, carriers) == _foot(second, carriers):
                assert distance > 0
            else:
                assert distance >= 0.01 - TOUCHING


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
    carriers = _carriers(spec)
    level = next(level for level in LEVELS.values() if len(level.tower) == spec.goal.count("(on "))
    for below, above in itertools.pairwise(("table", *level.tower)):
        assert carriers[above] == below
        assert f"(on {above} {'rack' if below == 'table' else below})" in spec.goal
        assert spec.boxes[above].rotation[:2] == (0, 0)
    assert spec.boxes[level.tower[0]].position[0] >= 0.40


@given(problems)
def test_the_kinds_are_those_declared(spec: SceneSpec) -> None:
    carriers = _carriers(spec)
    others = {name: box for name, box in spec.boxes.items() if f"(on {name} " not in spec.goal}
    kinds = set()
    for name, box in others.items():
        assert (box.rotation[:2] == (0, 0)) == (_height(box) == pytest.approx(box.size[2]))
        kinds |= {"stacked"} if carriers[name] != "table" else set()
        kinds |= {"behind"} if box.position[0] < 0 else set()
        kinds |= {"tipped"} if box.rotation[:2] != (0, 0) else set()
    assert kinds == set(spec.interference)


@given(st.sampled_from(sorted(LEVELS)), st.integers(0, 999), st.integers(0, 999))
def test_every_third_problem_is_plain(level: str, number: int, seed: int) -> None:
    spec = make_problem(level, number, seed)
    assert (spec.interference == ()) == (number % 3 == 0)
    others = len(spec.boxes) - len(LEVELS[level].tower)
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


def test_files_are_written(tmp_path: Path) -> None:
    write_problems("hard", tmp_path / "new", count=2, seed=5)
    paths = sorted((tmp_path / "new").iterdir())
    assert [path.name for path in paths] == ["000.yaml", "001.yaml"]
    assert [load_scene(path) for path in paths] == [make_problem("hard", number, 5) for number in range(2)]


def test_the_program_names_an_unknown_level(tmp_path: Path) -> None:
    command = [sys.executable, "-m", "ictamp_drake.scenes.packing", "--level", "extreme", "--out", str(tmp_path)]
    result = subprocess.run(command, capture_output=True, text=True, check=False)
    assert result.returncode == 2
    assert result.stderr == "level is 'extreme', but must be one of: easy, medium, hard\n"
