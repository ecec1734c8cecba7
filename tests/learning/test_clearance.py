"""Distances between the hand, the held box and other objects."""

import math

import numpy as np
import pytest
import torch
from hypothesis import assume, given
from hypothesis import strategies as st

from ictamp_drake.learning.clearance import FINGER, PALM, PARTS, Blocks, clearances
from tests.panda import MAX_OPENING

places = st.tuples(st.floats(-0.3, 0.3), st.floats(-0.3, 0.3))
angles = st.floats(-math.pi, math.pi)
sides = st.tuples(st.floats(0.02, 0.2), st.floats(0.02, 0.2), st.floats(0.02, 0.2))
NOWHERE = torch.tensor([[0.0], [0.0], [9.0]])
AHEAD = torch.tensor([[1.0], [0.0]])
ORIGIN = torch.zeros(3, 1)


def block(place: tuple[float, float], yaw: float, size: tuple[float, float, float], z: float = 0.0) -> Blocks:
    """One box, whose center is half its height above z."""
    return Blocks(
        torch.tensor([*place, z + size[2] / 2])[:, None],
        torch.tensor([math.cos(yaw), math.sin(yaw)])[:, None],
        torch.tensor(size)[:, None] / 2,
    )


blocks = st.builds(block, places, angles, sides)


def one_object(one: Blocks) -> Blocks:
    return Blocks(*(each[..., None] for each in one))


def of_box(box: Blocks, other: Blocks) -> float:
    """Distance between two boxes when the hand is far above."""
    found = clearances(NOWHERE, AHEAD, box, one_object(other))
    assert found.shape == (PARTS, 1, 1)
    return float(found[3])


def outline(one: Blocks) -> np.ndarray:
    """Points all over a box's footprint, shape (n, 2)."""
    centre, heading, half = (each[:, 0].numpy() for each in one)
    grid = np.stack(np.meshgrid(*[np.linspace(-1, 1, 9)] * 2), axis=-1).reshape(-1, 2) * half[:2]
    return centre[:2] + grid[:, :1] * heading + grid[:, 1:] * np.array([-heading[1], heading[0]])


@given(blocks, blocks)
def test_boxes_side_by_side_are_apart_when_no_point_of_one_is_in_the_other(box: Blocks, other: Blocks) -> None:
    gap = of_box(box, other)
    assert gap == pytest.approx(of_box(other, box), abs=1e-5) or gap < 0  # heights differ, footprints do not
    points = outline(box) - other.centre[:2, 0].numpy()
    x, y = other.heading[:, 0].numpy()
    inside = np.abs(points @ [[x, -y], [y, x]]) < other.half[:2, 0].numpy() - 1e-6
    if inside.all(axis=1).any():
        assert gap < 0
    nearest = np.linalg.norm(outline(box)[:, None] - outline(other)[None], axis=-1).min()
    assert gap <= nearest + 1e-6


@given(blocks, angles)
def test_it_makes_no_difference_where_all_of_it_stands(other: Blocks, turn: float) -> None:
    box = block((0.02, 0.01), 0.3, (0.05, 0.04, 0.1))
    cos, sin = math.cos(turn), math.sin(turn)

    def turn_blocks(one: Blocks) -> Blocks:
        R = torch.tensor([[cos, -sin], [sin, cos]])
        return Blocks(torch.cat([R @ one.centre[:2], one.centre[2:]]), R @ one.heading, one.half)

    assert of_box(turn_blocks(box), turn_blocks(other)) == pytest.approx(of_box(box, other), abs=1e-5)


def test_what_is_below_is_apart_by_its_distance() -> None:
    low, high = block((0, 0), 0.0, (0.1, 0.1, 0.05)), block((0.01, 0), 0.4, (0.1, 0.1, 0.05), z=0.08)
    assert of_box(high, low) == pytest.approx(0.03)
    assert of_box(low, high) < 0  # nothing fits in from above


@given(st.floats(0.03, 0.1))
def test_a_box_between_the_fingers_is_apart_until_it_is_too_wide(width: float) -> None:
    assume(abs(width - MAX_OPENING) > 1e-4)
    box = block((0, 0), 0.0, (0.04, width, 0.04), z=-0.02)
    found = clearances(ORIGIN, AHEAD, box, one_object(box))
    assert float(found[0]) == pytest.approx((MAX_OPENING - width) / 2, abs=1e-6)
    assert float(found[1]) == pytest.approx(PALM[2] - 0.02, abs=1e-6)
    turned = clearances(ORIGIN, AHEAD.flip(0), box, one_object(box))
    assert float(turned[0]) == pytest.approx((MAX_OPENING - 0.04) / 2, abs=1e-6)


def test_a_neighbour_is_touched_by_the_finger_beside_it() -> None:
    box = block((0, 0), 0.0, (0.04, 0.04, 0.04), z=-0.02)
    outside = MAX_OPENING / 2 + 2 * FINGER[1]
    for gap in (0.01, -0.01):
        neighbour = block((0, outside + gap + 0.03), 0.0, (0.06, 0.06, 0.05), z=-0.02)
        found = clearances(ORIGIN, AHEAD, box, one_object(neighbour))
        assert float(found[0]) == pytest.approx(gap, abs=1e-6)
