"""Laws of the problems of the level `extreme`, for any number and seed. Distances are Drake's, between the solids."""

import itertools
import math
import re
from collections import Counter

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from ictamp_drake.core.seeding import Stream
from ictamp_drake.scenes.extreme import RACK_ROOM
from ictamp_drake.scenes.levels import SIZES, problem_files
from ictamp_drake.scenes.packing import make_problem
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, load_scene
from tests.scenes.solids import carriers, check_clearances, foot, height

streams = st.sampled_from([Stream.SCENES, Stream.DATA])
problems = st.builds(make_problem, st.just("extreme"), st.integers(0, 999), st.integers(0, 999), streams)


def atoms(spec: SceneSpec) -> dict[str, tuple[str, str]]:
    """Predicate and support of each box of the goal, from the bottom of each tower up."""
    found = re.findall(r"\((on|lying) (\w+) (\w+)\)", spec.goal)
    return {box: (predicate, below) for predicate, box, below in found}


def is_tipped(box: BoxSpec) -> bool:
    return box.rotation[:2] != (0, 0)


def bystanders(spec: SceneSpec) -> list[str]:
    return [name for name in spec.boxes if name not in atoms(spec)]


@given(problems)
def test_boxes_touch_what_carries_them_and_keep_clear_of_all_else(spec: SceneSpec) -> None:
    check_clearances(spec)


@given(problems)
def test_all_boxes_take_part_and_are_within_reach(spec: SceneSpec) -> None:
    assert set(spec.boxes) == set(SIZES)
    for box in spec.boxes.values():
        assert math.hypot(*box.position[:2]) < 0.75


@given(problems)
def test_the_goal_is_two_towers_on_the_rack_with_tipped_boxes_at_the_foot_or_on_top(spec: SceneSpec) -> None:
    goal = atoms(spec)
    below = [support for _, support in goal.values()]
    assert below.count("rack") == 2
    assert len(set(below)) == len(below) - 1
    assert len(goal) == (4 if len(bystanders(spec)) == 2 else 5)
    for name, (predicate, support) in goal.items():
        assert (predicate == "lying") == is_tipped(spec.boxes[name])
        if predicate == "lying":
            assert support == "rack" or name not in below


@given(problems)
def test_boxes_of_the_goal_start_in_towers_on_the_table_save_a_foot_to_be_cleared(spec: SceneSpec) -> None:
    carried_by, goal = carriers(spec), atoms(spec)
    feet = {name: foot(name, carried_by) for name in goal}
    on_table = [each for each in feet.values() if carried_by[each] == "table"]
    assert len(set(on_table)) < len(on_table)
    for name in set(goal) - {name for name, each in feet.items() if carried_by[each] == "table"}:
        assert goal[name] == ("on", carried_by[name]) == ("on", "rack")
        assert "stacked" in spec.interference
        assert name in {carried_by[other] for other in bystanders(spec)}


@given(problems)
def test_the_hand_reaches_for_a_lone_tipped_box_in_the_direction_of_the_other_tower(spec: SceneSpec) -> None:
    goal, carried_by = atoms(spec), carriers(spec)
    lying = [name for name, (predicate, _) in goal.items() if predicate == "lying"]
    assume(len(lying) == 1 and "rack" not in {carried_by[name] for name in goal})
    box, own = spec.boxes[lying[0]], _base(lying[0], _below(spec))
    feet = {foot(name, carried_by) for name in goal if _base(name, _below(spec)) != own}
    assert len(feet) == 1
    towards = np.subtract(spec.boxes[feet.pop()].position, box.position)[:2]
    axes = Rotation.from_euler("xyz", box.rotation, degrees=True).as_matrix().T
    sides = sorted((side, tuple(axis)) for side, axis in zip(box.size, axes, strict=True) if abs(axis[2]) < 0.5)
    narrow = np.array(sides[0][1][:2])
    assert abs(narrow @ towards) == pytest.approx(np.linalg.norm(towards), rel=1e-3)
    assert np.linalg.norm(towards) < 0.2


@given(problems)
def test_bystanders_crowd_the_rack_and_show_the_kinds_declared(spec: SceneSpec) -> None:
    carried_by, boxes, kinds = carriers(spec), spec.boxes, set()
    outside = bystanders(spec)
    for name in outside:
        kinds |= {"stacked"} if carried_by[name] in boxes else set()
        kinds |= {"behind"} if boxes[name].position[0] < 0 else set()
        kinds |= {"tipped"} if is_tipped(boxes[name]) else set()
    assert kinds == set(spec.interference)
    assert "rack" in {carried_by[name] for name in outside}


@given(problems)
def test_there_is_room_on_the_rack_for_circles_about_both_towers(spec: SceneSpec) -> None:
    radii, carried_by = _tower_radii(spec), carriers(spec)
    on_rack = [name for name in spec.boxes if carried_by[name] == "rack"]
    circles = [(spec.boxes[name].position[:2], radii.pop(name, _radius(spec.boxes[name]))) for name in on_rack]
    assert _fit(circles, [*radii.values()])


def _tower_radii(spec: SceneSpec) -> dict[str, float]:
    """Radius of a circle that contains all boxes of a tower of the goal, by the tower's lowest box [m]."""
    below = _below(spec)
    feet = [name for name, support in below.items() if support == "rack"]
    towers = {each: [name for name in below if _base(name, below) == each] for each in feet}
    return {each: max(_radius(spec.boxes[name]) for name in tower) for each, tower in towers.items()}


def _below(spec: SceneSpec) -> dict[str, str]:
    return {name: support for name, (_, support) in atoms(spec).items()}


def _base(name: str, below: dict[str, str]) -> str:
    return name if below[name] == "rack" else _base(below[name], below)


def _radius(box: BoxSpec) -> float:
    """Half the diagonal of the outline of a box, seen from above [m]."""
    return math.sqrt(sum(side**2 for side in box.size) - height(box) ** 2) / 2


def _fit(circles: list[tuple[tuple[float, ...], float]], radii: list[float]) -> bool:
    """Whether the remaining circles find places on the rack, on a grid of 5 mm."""
    if not radii:
        return True
    radius, *others = radii
    xs = _grid(0.28 + radius, 0.60 - radius)
    ys = _grid(-0.44 + radius, -0.22 - radius)
    for spot in itertools.product(xs, ys):
        apart = radius + RACK_ROOM - 0.005
        if all(math.dist(spot, other) >= apart + other_radius for other, other_radius in circles) and _fit(
            [*circles, (spot, radius)], others
        ):
            return True
    return False


def _grid(low: float, high: float) -> list[float]:
    return [low + 0.005 * step for step in range(int((high - low) / 0.005) + 1)]


def test_a_third_of_the_committed_problems_is_plain_and_the_others_take_turns() -> None:
    mixes = Counter(load_scene(path).interference for path in problem_files("extreme"))
    assert mixes.pop(()) == 10
    assert mixes == {
        ("tipped",): 7,
        ("stacked",): 4,
        ("behind",): 3,
        ("stacked", "tipped"): 3,
        ("behind", "tipped"): 3,
    }
