"""Geometry of packing scenes: stacks of boxes at rest, and free spots for them on the table.

Everything is in the world frame, whose origin is the arm's base on the table top. Lengths are rounded to 0.1 mm and
angles to 0.1 deg before they are checked, so that a file contains exactly the values that were checked.
"""

import itertools
import math
from collections.abc import Sequence
from enum import Enum
from typing import NamedTuple

import numpy as np

from ictamp_drake.scenes.spec import Vector

REACH = 0.70
"""Maximum distance of any point of a stack from the axis of the arm's base [m]."""

MAX_OFFSET = 0.008
"""Maximum horizontal distance between the center of a box and that of the box below [m]."""

STABILITY_MARGIN = 0.012
"""Minimum distance of a stack's centers of mass from the edge of what carries them [m]."""

STACK_GAP = 0.01
"""Minimum free space between the circumscribed circles of two stacks [m]."""

RACK_GAP = 0.02
"""Minimum free space between a stack and the rack's footprint [m]."""

RACK_FOOTPRINT = ((0.28, 0.60), (-0.44, -0.22))
TABLE_FOOTPRINT = ((-0.30, 0.90), (-0.45, 0.45))
_EDGE_GAP = 0.01
_BEHIND_RADIUS = 0.27
_TRIES = 100
_TIPS = ((90.0, 0.0), (-90.0, 0.0), (0.0, 90.0), (0.0, -90.0))


class Zone(Enum):
    """Region of the table for the center of a stack: bounds in x and y [m]."""

    TOWER = ((0.40, 0.70), (-0.45, 0.45))
    FRONT = ((0.28, 0.70), (-0.45, 0.45))
    BEHIND = ((-0.28, -0.17), (-0.35, 0.35))


class Piece(NamedTuple):
    """A box in its stack.

    Attributes:
        name: Name of the box.
        offset: Offset of the box's center from the stack's center, x and y [m].
        z: Height of the box's center above the table [m].
        rotation: Roll, pitch, yaw [deg].
        footprint: Horizontal sides [m].
    """

    name: str
    offset: tuple[float, float]
    z: float
    rotation: Vector
    footprint: tuple[float, float]


Stack = tuple[Piece, ...]
Spot = tuple[float, float]


def build_stack(names: Sequence[str], sizes: dict[str, Vector], tipped: bool, rng: np.random.Generator) -> Stack:
    """Boxes on top of each other from the bottom up, faces touching, slightly off center, each with its own yaw.

    A tipped stack is one box that lies on a long side.
    """
    while True:
        stack: list[Piece] = []
        top = 0.0
        for name in names:
            tip = _TIPS[rng.integers(len(_TIPS))] if tipped else (0.0, 0.0)
            (length, width), height = _lay(sizes[name], tip)
            offset = _offset(stack[-1].offset, rng) if stack else (0.0, 0.0)
            yaw = round(rng.uniform(-180, 180), 1)
            stack.append(Piece(name, offset, round(top + height / 2, 6), (*tip, yaw), (length, width)))
            top += height
        if is_stable(stack):
            return tuple(stack)


def _lay(size: Vector, tip: tuple[float, float]) -> tuple[tuple[float, float], float]:
    """Horizontal sides and height of a box rolled or pitched by 90 deg."""
    roll, pitch = tip
    if roll:
        return (size[0], size[2]), size[1]
    if pitch:
        return (size[2], size[1]), size[0]
    return (size[0], size[1]), size[2]


def _offset(below: tuple[float, float], rng: np.random.Generator) -> tuple[float, float]:
    distance, angle = rng.uniform(0, MAX_OFFSET - 1e-4), rng.uniform(-math.pi, math.pi)
    return round(below[0] + distance * math.cos(angle), 4), round(below[1] + distance * math.sin(angle), 4)


def is_stable(stack: Sequence[Piece]) -> bool:
    """Whether all that stands above each contact has its center of mass well inside both faces (equal masses)."""
    for below, above in itertools.pairwise(range(len(stack))):
        centre = np.mean([piece.offset for piece in stack[above:]], axis=0)
        for piece in (stack[below], stack[above]):
            if math.dist(centre, piece.offset) > min(piece.footprint) / 2 - STABILITY_MARGIN:
                return False
    return True


def outline_radius(stack: Stack) -> float:
    """Radius of the circle around the stack's center that contains all its boxes, seen from above [m]."""
    return max(math.hypot(*piece.offset) + math.hypot(*piece.footprint) / 2 for piece in stack)


def place_stacks(
    radii: Sequence[float], zones: Sequence[Zone], nearby: Sequence[bool], rng: np.random.Generator
) -> list[Spot]:
    """Centers of stacks that keep clear of each other, of the rack, of the table's edge and of the arm.

    Args:
        radii: Outline radius of each stack [m]. The first is the tower's.
        zones: Zone of each stack.
        nearby: Whether each stack stands next to the tower, within a few centimeters.
    """
    while True:
        spots: list[Spot] = []
        for zone, near in zip(zones, nearby, strict=True):
            if (spot := _free_spot(spots, radii, zone, near, rng)) is None:
                break
            spots.append(spot)
        else:
            return spots


def _free_spot(
    spots: list[Spot], radii: Sequence[float], zone: Zone, near: bool, rng: np.random.Generator
) -> Spot | None:
    """A spot for the next stack, or None when many draws find none."""
    radius = radii[len(spots)]
    taken = list(zip(spots, radii, strict=False))
    for _ in range(_TRIES):
        spot = _spot_next_to(spots[0], radii[0] + radius, rng) if near else _random_spot(zone, rng)
        clear = all(math.dist(spot, other) >= radius + other_radius + STACK_GAP for other, other_radius in taken)
        if clear and fits(spot, radius, zone):
            return spot
    return None


def fits(spot: Spot, radius: float, zone: Zone) -> bool:
    """Whether the circle lies on the table, within reach and clear of the rack, with its center in the zone."""
    inside = all(low <= value <= high for value, (low, high) in zip(spot, zone.value, strict=True))
    bounds = zip(spot, TABLE_FOOTPRINT, strict=True)
    on_table = all(low + radius + _EDGE_GAP <= value <= high - radius - _EDGE_GAP for value, (low, high) in bounds)
    distance = math.hypot(*spot)
    in_reach = distance + radius <= REACH and (zone is not Zone.BEHIND or distance >= _BEHIND_RADIUS)
    return inside and on_table and in_reach and rack_distance(spot) >= radius + RACK_GAP


def rack_distance(spot: Spot) -> float:
    """Distance of a point from the rack's footprint, 0 inside [m]."""
    return math.hypot(*(max(low - v, 0.0, v - high) for v, (low, high) in zip(spot, RACK_FOOTPRINT, strict=True)))


def _random_spot(zone: Zone, rng: np.random.Generator) -> Spot:
    (x_low, x_high), (y_low, y_high) = zone.value
    return round(rng.uniform(x_low, x_high), 4), round(rng.uniform(y_low, y_high), 4)


def _spot_next_to(tower: Spot, contact: float, rng: np.random.Generator) -> Spot:
    distance, angle = contact + rng.uniform(STACK_GAP, 4 * STACK_GAP), rng.uniform(-math.pi, math.pi)
    return round(tower[0] + distance * math.cos(angle), 4), round(tower[1] + distance * math.sin(angle), 4)
