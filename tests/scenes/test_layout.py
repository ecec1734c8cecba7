"""Stacks at rest, and spots for them."""

import itertools
import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.scenes.layout import (
    RACK_FOOTPRINT,
    Piece,
    Zone,
    build_stack,
    fits,
    is_stable,
    place_stacks,
    rack_distance,
)
from ictamp_drake.scenes.levels import SIZES, SUPPORTS


def _column(*offsets: float) -> list[Piece]:
    return [Piece(f"box_{i}", (x, 0.0), 0.0, (0.0, 0.0, 0.0), (0.05, 0.05)) for i, x in enumerate(offsets)]


@pytest.mark.parametrize(
    ("offsets", "stable"),
    [
        ((0.0, 0.0, 0.0), True),
        ((0.0, 0.012), True),
        ((0.0, 0.014), False),
        ((0.0, 0.008, 0.016), True),
        ((0.0, 0.008, 0.016, 0.024), False),  # each on the one below, but together they tip the lowest joint
        ((0.0, 0.01, 0.0), True),
        ((0.0, 0.02, 0.0), False),  # in balance on the lowest box, not on the middle one
    ],
)
def test_a_stack_is_stable_when_all_above_each_contact_weighs_inside_it(
    offsets: tuple[float, ...], stable: bool
) -> None:
    assert is_stable(_column(*offsets)) is stable


@pytest.mark.parametrize("name", sorted(SIZES))
def test_a_tipped_box_lies_on_a_long_side(name: str) -> None:
    for seed in range(8):
        (piece,) = build_stack([name], SIZES, True, generator(Stream.SCENES, seed))
        sides = [*piece.footprint, 2 * piece.z]
        assert sorted(sides) == pytest.approx(sorted(SIZES[name]))
        assert max(piece.footprint) == max(SIZES[name])


def test_the_rack_footprint_is_that_of_the_rack() -> None:
    rack = SUPPORTS["rack"]
    assert rack.yaw == 90
    for (low, high), centre, side in zip(RACK_FOOTPRINT, rack.position, (rack.size[1], rack.size[0]), strict=False):
        assert (low, high) == pytest.approx((centre - side / 2, centre + side / 2))


@pytest.mark.parametrize(
    ("spot", "distance"),
    [((0.44, -0.33), 0.0), ((0.28, -0.22), 0.0), ((0.44, -0.12), 0.1), ((0.63, -0.18), 0.05)],
)
def test_distance_from_the_rack(spot: tuple[float, float], distance: float) -> None:
    assert rack_distance(spot) == pytest.approx(distance)


@pytest.mark.parametrize(
    ("spot", "zone", "expected"),
    [
        ((0.5, 0.1), Zone.TOWER, True),
        ((0.39, 0.1), Zone.TOWER, False),
        ((0.39, 0.1), Zone.FRONT, True),
        ((0.68, 0.0), Zone.FRONT, False),
        ((0.4, 0.42), Zone.FRONT, False),
        ((0.4, -0.17), Zone.FRONT, False),
        ((0.5, 0.1), Zone.BEHIND, False),
        ((-0.2, 0.3), Zone.BEHIND, True),
        ((-0.2, 0.1), Zone.BEHIND, False),
    ],
)
def test_where_a_stack_fits(spot: tuple[float, float], zone: Zone, expected: bool) -> None:
    assert fits(spot, 0.04, zone) is expected


def test_stacked_boxes_touch_and_are_seldom_aligned() -> None:
    stack = build_stack(["cyan_box", "yellow_box", "red_box"], SIZES, False, generator(Stream.SCENES, 1))
    assert [piece.z for piece in stack] == [0.035, 0.103, 0.195]
    assert len({piece.rotation[2] for piece in stack}) == 3
    steps = np.diff([piece.offset for piece in stack], axis=0)
    assert all(0 < math.hypot(*step) <= 0.008 for step in steps)


@given(st.lists(st.floats(0.03, 0.08), min_size=1, max_size=3), st.booleans(), st.integers(0, 999))
def test_stacks_keep_apart_and_neighbours_are_near(others: list[float], near: bool, seed: int) -> None:
    radii = [0.04, *others]
    zones = [Zone.TOWER] + len(others) * [Zone.FRONT]
    spots = place_stacks(radii, zones, [False] + len(others) * [near], generator(Stream.SCENES, seed))
    for (a, spot_a), (b, spot_b) in itertools.combinations(zip(radii, spots, strict=True), 2):
        assert math.dist(spot_a, spot_b) - a - b >= 0.01
    for radius, spot, zone in zip(radii, spots, zones, strict=True):
        assert fits(spot, radius, zone)
        assert not near or math.dist(spot, spots[0]) <= 0.04 + radius + 0.0401
