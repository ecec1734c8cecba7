"""Generator of the level `varied`: scenes of all sorts, as somebody else might write them.

Up to ten boxes of random sizes, masses and frictions stand, lie or are stacked around the arm, on a table and up to two
racks or blocks. The goal puts up to five of them in one or two towers on any supports. In half of the problems the arm
and everything around it are somewhere else in the world. The start is at rest, but the goal is not guaranteed to be
reachable.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import replace
from itertools import pairwise

import numpy as np
from scipy.spatial.transform import Rotation

from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.models.things import WIDEST
from ictamp_drake.scenes.clutter import random_boxes, random_supports
from ictamp_drake.scenes.levels import goal_of
from ictamp_drake.scenes.spec import ArmSpec, BoxSpec, SceneSpec, Vector

LEAST_BOXES, MOST_BOXES = 3, 10
LARGEST_GOAL = 5
"""Maximum number of boxes in the goal."""

_STREAM = 9
"""Key of the level's random numbers. Smaller keys belong to the other levels and to training scenes."""
_HIGHEST_TOWER = 3
_HAND = (0.31, 0.0, 0.48)
"""Tips of the fingers at the start, in the arm's base frame [m]."""
_HAND_ROOM = 0.2
"""Minimum distance from the hand, seen from above, of what reaches as high at the start [m]."""


def make_varied(number: int, seed: int, stream: Stream) -> SceneSpec:
    """Create the problem of that number. The same arguments always give the same problem."""
    rng = generator(stream, seed, _STREAM, number)
    boxes = dict[str, BoxSpec]()
    while len(boxes) < LEAST_BOXES or any(map(_is_near_hand, boxes.values())):
        supports = random_supports(rng)
        sizes = {f"box_{name}": _size(rng) for name in range(rng.integers(LEAST_BOXES, MOST_BOXES + 1))}
        boxes, carriers = random_boxes(supports, sizes, rng)
    towers = _towers(sorted(supports), carriers, rng)
    arm = ArmSpec() if rng.random() < 0.5 else _random_place(rng)
    return SceneSpec(
        arm=arm,
        supports={
            name: replace(
                support, position=_to_world_position(support.position, arm), yaw=_to_world_yaw(support.yaw, arm)
            )
            for name, support in supports.items()
        },
        boxes={name: _moved_box(_material(box, rng), arm) for name, box in boxes.items()},
        goal=goal_of(*towers, tipped=[name for name, box in boxes.items() if box.is_tipped]),
        seed=number,
        description=f"Varied: {len(boxes)} boxes on {', '.join(supports)}; "
        f"build {' and '.join(map(_describe_tower, towers))}.",
    )


def _size(rng: np.random.Generator) -> Vector:
    """Random sides of a box that the hand can grip, whichever way it lies [m]."""
    width, depth, height = (round(rng.uniform(0.03, most), 3) for most in (0.07, 0.09, 0.14))
    return width, depth, height if depth <= WIDEST else min(height, WIDEST)


def _is_near_hand(box: BoxSpec) -> bool:
    top = box.position[2] + max(box.size) / 2
    return math.dist(box.position[:2], _HAND[:2]) < _HAND_ROOM and top > _HAND[2]


def _towers(supports: Sequence[str], carriers: Mapping[str, str], rng: np.random.Generator) -> list[list[str]]:
    """Random towers to build, each from its support up, not all of which exist already."""
    while True:
        count = int(rng.integers(1, min(LARGEST_GOAL, len(carriers)) + 1))
        wanted = rng.permutation(sorted(carriers))[:count].tolist()
        cut = rng.integers(max(1, count - _HIGHEST_TOWER), min(count, _HIGHEST_TOWER) + 1)
        towers = [[str(rng.choice(supports)), *names] for names in (wanted[:cut], wanted[cut:]) if names]
        if any(carriers[above] != below for tower in towers for below, above in pairwise(tower)):
            return towers


def _describe_tower(tower: Sequence[str]) -> str:
    return f"{', '.join(tower[1:])} on {tower[0]}"


def _material(box: BoxSpec, rng: np.random.Generator) -> BoxSpec:
    return replace(box, mass=round(rng.uniform(0.02, 0.3), 3), friction=round(rng.uniform(0.4, 1), 2))


def _random_place(rng: np.random.Generator) -> ArmSpec:
    x, y, z = rng.uniform((-1, -1, 0), (1, 1, 0.8)).round(2).tolist()
    return ArmSpec((x, y, z), round(rng.uniform(-180, 180), 1))


def _moved_box(box: BoxSpec, arm: ArmSpec) -> BoxSpec:
    roll, pitch, yaw = box.rotation
    return replace(box, position=_to_world_position(box.position, arm), rotation=(roll, pitch, _to_world_yaw(yaw, arm)))


def _to_world_position(p_BA: Vector, arm: ArmSpec) -> Vector:
    """Position in the world of a position in the arm's base frame [m]."""
    x, y, z = (Rotation.from_euler("z", arm.yaw, degrees=True).apply(p_BA) + arm.position).round(6).tolist()
    return x, y, z


def _to_world_yaw(yaw: float, arm: ArmSpec) -> float:
    """Yaw in the world of a yaw in the arm's base frame, in [-180, 180) [deg]."""
    return round((yaw + arm.yaw + 180) % 360 - 180, 1)
