"""H of boxes in regions and at poses."""

from dataclasses import replace

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.core.types import Atom, Configuration, State
from ictamp_drake.scenes.regions import PoseSpec, RegionSpec
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.world import World
from tests.world.scenes import SIZES, arrange, far_boxes, pose, scene

SPEC = replace(
    scene(far_boxes()),
    regions={"near": RegionSpec("table", (0.2, 0.1), (0.0, 0.1), yaw=90.0)},
    poses={"spot": PoseSpec("table", (0.1, -0.1), yaw=30.0, tolerance=(0.01, 5.0))},
)
"""The center of the table's top is at x = 0.3 m."""
WORLD = World(SPEC)
H = SceneAbstraction(WORLD)


def at(x: float, y: float, yaw: float = 0.0, box: str = "red_box", **turn: float) -> Configuration:
    """The box on the table at x, y [m] with a yaw [deg]."""
    height = SIZES[box][1] if turn else SIZES[box][2]
    return arrange(WORLD, {box: pose(x, y, height / 2, yaw=yaw, **turn)})


def place(state: State, box: str = "red_box") -> str:
    (found,) = [atom.args[1] for atom in state if atom.predicate in ("on", "lying") and atom.args[0] == box]
    return found


@pytest.mark.parametrize(
    ("x", "y", "where"),
    [(0.3, 0.1, "near"), (0.349, 0.1, "near"), (0.351, 0.1, "table"), (0.3, 0.199, "near"), (0.3, 0.201, "table")],
)
def test_a_box_is_in_a_region_when_its_center_is(x: float, y: float, where: str) -> None:
    assert place(H(at(x, y))) == where


@pytest.mark.parametrize(
    ("x", "yaw", "where"),
    [
        (0.4, 30, "spot"),
        (0.409, 30, "spot"),
        (0.411, 30, "table"),
        (0.4, 34.9, "spot"),
        (0.4, 35.1, "table"),
        (0.4, 24.9, "table"),
        (0.4, 210, "spot"),
        (0.4, -60, "spot"),
    ],
)
def test_a_box_is_at_a_pose_within_the_tolerance(x: float, yaw: float, where: str) -> None:
    """The footprint is square, so quarter turns make no difference."""
    assert SIZES["red_box"][0] == SIZES["red_box"][1]
    assert place(H(at(x, -0.1, yaw))) == where


def test_a_quarter_turn_counts_when_the_footprint_is_not_square() -> None:
    """A tipped box lies on a long side. A half turn makes no difference to it."""
    states = [H(at(0.4, -0.1, 30 + turn, roll=90.0)) for turn in (0, 90, 180, 270)]
    assert all(Atom("tipped", ("red_box",)) in state for state in states)
    places = list(map(place, states))
    assert places[:2] == places[2:]
    assert sorted(places[:2]) == ["spot", "table"]


@given(st.floats(-0.1, 0.6), st.floats(-0.3, 0.4), st.floats(-180, 180))
def test_a_box_is_in_one_place(x: float, y: float, yaw: float) -> None:
    c = arrange(WORLD, {"red_box": pose(0.3, 0.1, 0.059), "cyan_box": pose(x, y, 1.0, yaw=yaw)})
    assert place(H(c)) == "near"
    place(H(at(x, y, yaw)))


def test_a_box_on_a_box_in_a_region_is_on_the_box() -> None:
    height = SIZES["red_box"][2]
    c = arrange(WORLD, {"red_box": pose(0.3, 0.1, height / 2), "cyan_box": pose(0.3, 0.1, height + 0.035)})
    assert place(H(c), "cyan_box") == "red_box"


def test_the_frame_of_a_region_is_in_its_center() -> None:
    c = WORLD.initial_configuration()
    assert WORLD.X_WT(c, "near").translation() == pytest.approx([0.3, 0.1, 0.0])
    assert WORLD.X_WT(c, "near").rotation().matrix()[:, 0] == pytest.approx([0, 1, 0])
    assert tuple(WORLD.top_size(c, "near")) == (0.2, 0.1)
