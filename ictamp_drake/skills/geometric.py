"""k from geometry alone: grasps and placements from above for which hand, ground and surroundings leave room.

The hand points down and comes from above, so only the outline and the height of the top of each thing count. The hand
and the held box count as disks, below which nothing may be.
"""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ictamp_drake.core.types import Action, Configuration, FloatArray, Parameter
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.robots.gripper import Gripper
from ictamp_drake.skills.config import CLEARANCES, HEIGHTS
from ictamp_drake.skills.geometry import hand_poses, held_bottom, needed_opening
from ictamp_drake.skills.neighbours import Neighbour, neighbours
from ictamp_drake.world.world import World

LEAST_COVER = 0.003
"""Minimum height over which the pads cover the box [m]."""
SPARE = 0.0025
"""Distance of the hand in a grasp from what is below it [m]."""
PLAY = 0.001
"""Range of heights of grasps of a box that does not cover the whole pads [m]."""
TURN = 0.02
"""Standard deviation of yaw from the directions of the faces [rad]."""
SPACING = 0.02
"""Maximum distance between the disks of a row [m]."""
ROOM = 0.004
"""Distance of a placed box from the things around [m]."""
CANDIDATES = 64
"""Number of candidates drawn at once."""
COMPARED = 8
"""Maximum number of fitting candidates in one round; on boxes, the one nearest to the middle comes first."""


class _Disk(NamedTuple):
    """Horizontal disk of the hand or of the held box, which nothing may be below.

    Attributes:
        center: Center in G, shape (3,) [m].
        radius: Radius [m].
    """

    center: FloatArray
    radius: float


class GeometricSampler:
    """Pick: pads on opposite faces, anywhere along them. Place: wherever there is room. Middles of boxes come first."""

    def __init__(self, world: World, arm: ArmKinematics) -> None:
        self._world = world
        self._arm = arm
        self._gripper = world.robot.gripper

    def draws(self, c: Configuration, action: Action, rng: np.random.Generator) -> Iterator[Parameter]:
        """k that fit and are within reach, as long as some of the latest candidates are."""
        around = neighbours(self._world, c, {action.args[0]}, -np.inf)
        draw = self._draw_grasps if action.name == "pick" else self._draw_placements
        while len(k := draw(c, action, around, rng)):
            times = self._arm.travel_times(self._hand_poses(c, action, k), c.q)
            k = k[np.isfinite(times)][:COMPARED]
            if not len(k):
                return
            on_box = action.name == "pick" or action.args[1] in self._world.spec.boxes
            yield from k[np.argsort(np.linalg.norm(k[:, :2], axis=1), kind="stable")] if on_box else k

    def _hand_poses(self, c: Configuration, action: Action, k: FloatArray) -> FloatArray:
        return hand_poses(self._world, c, action, k, self._arm.forward(c.q))

    def _draw_grasps(
        self, c: Configuration, action: Action, around: Sequence[Neighbour], rng: np.random.Generator
    ) -> FloatArray:
        """Grasps as low as the things below the hand allow, or higher while the box covers the pads, shape (n, 4)."""
        lying = self._world.upright_frame(c, action.args[0])
        center, half = lying.X_WU.translation()[2], lying.size / 2
        top = center + half[2]
        hand, widest = self._gripper.hand, self._gripper.max_side
        quarters = rng.choice([m for m in range(4) if lying.size[1 - m % 2] <= widest], CANDIDATES)
        k = np.zeros((CANDIDATES, 4))
        k[range(CANDIDATES), quarters % 2] = rng.uniform(-1, 1, CANDIDATES) * half[quarters % 2]
        k[:, 3] = quarters * np.pi / 2 + rng.normal(0.0, TURN, CANDIDATES)
        X_WG = self._hand_poses(c, action, k)
        lowest = np.full(CANDIDATES, top - hand.palm)
        for side in (0, 1):
            chosen = quarters % 2 == side
            disks = _list_hand_disks(self._gripper, 2 * half[1 - side])
            lowest[chosen] = np.maximum(lowest[chosen], _find_lowest(X_WG[chosen], disks, around))
        lowest += SPARE
        highest = np.maximum(top - hand.pad_half_height, lowest + PLAY)
        k[:, 2] = rng.uniform(lowest, highest) - center
        return k[k[:, 2] <= half[2] + hand.pad_half_height - LEAST_COVER]

    def _draw_placements(
        self, c: Configuration, action: Action, around: Sequence[Neighbour], rng: np.random.Generator
    ) -> FloatArray:
        """Placements with room for the box and for the hand that lets go of it, shape (n, 4)."""
        box, place = action.args
        X_WG = self._arm.forward(c.q)
        half, top = self._world.upright_frame(c, box).size / 2, self._world.top_size(c, place) / 2
        k = np.zeros((CANDIDATES, 4))
        k[:, 2] = rng.uniform(*HEIGHTS, CANDIDATES)
        if place in self._world.spec.boxes:
            k[:, :2] = rng.uniform(-1, 1, (CANDIDATES, 2)) * top / 2
            k[:, 3] = rng.integers(4, size=CANDIDATES) * np.pi / 2 + rng.normal(0.0, TURN, CANDIDATES)
        else:
            k[:, 3] = rng.uniform(-np.pi, np.pi, CANDIDATES)
            cos, sin = np.abs(np.cos(k[:, 3])), np.abs(np.sin(k[:, 3]))
            extent = np.column_stack([cos * half[0] + sin * half[1], sin * half[0] + cos * half[1]])
            room = top - extent if place in self._world.spec.supports else top  # in a region, the center is enough
            k[:, :2] = rng.uniform(-1, 1, (CANDIDATES, 2)) * np.maximum(room, 0.0)
        X_GB = held_bottom(self._world, c, box, X_WG).GetAsMatrix4()
        placed = self._hand_poses(c, action, k)
        beside = neighbours(self._world, c, {box, place}, -np.inf)
        opening = needed_opening(self._world, c, box, X_WG)
        hand = _find_lowest(placed, _list_hand_disks(self._gripper, opening), around)
        height = placed[:, 2, 3]
        has_room = height >= _find_lowest(placed, _list_box_disks(X_GB, half), beside)
        return k[has_room & (height - self._gripper.rise(opening) >= hand)]


def _list_hand_disks(gripper: Gripper, width: float) -> list[_Disk]:
    """List disks that cover a hand whose fingers just miss something of that width [m]."""
    finger = gripper.hand.finger
    side = min(width / 2 + CLEARANCES[-1], gripper.opening / 2) + finger.half_width
    radius = max(finger.half_length, finger.half_width)
    fingers = [_Disk(np.array([0.0, y, -finger.bottom]), radius) for y in (-side, side)]
    upper = [
        _Disk(np.array([0.0, y, -row.bottom]), row.radius)
        for row in gripper.hand.upper
        for y in np.linspace(row.first, row.last, int(np.ceil((row.last - row.first) / SPACING)) + 1)
    ]
    return fingers + upper


def _list_box_disks(X_GB: FloatArray, half: FloatArray) -> list[_Disk]:
    """List disks along a held box with its bottom frame at X_GB, shape (4, 4), and half sides of shape (3,) [m]."""
    long, radius = int(half[1] > half[0]), float(min(half[:2]))
    reach = half[long] - radius
    shifts = np.linspace(-reach, reach, int(np.ceil(2 * reach / radius)) + 1)
    return [_Disk(X_GB[:3, 3] + shift * X_GB[:3, long], radius + ROOM) for shift in shifts]


def _find_lowest(X_WG: FloatArray, disks: Sequence[_Disk], around: Sequence[Neighbour]) -> FloatArray:
    """Find the lowest heights of G in W at which all disks are above what is below them, (n, 4, 4) -> (n,) [m]."""
    lowest = np.full(len(X_WG), -np.inf)
    for center, radius in disks:
        offset = X_WG[:, :3, :3] @ center
        p_W = X_WG[:, :3, 3] + offset
        for each in around:
            needed = np.where(each.distance(p_W) < radius, each.top - offset[:, 2], -np.inf)
            lowest = np.maximum(lowest, needed)
    return lowest
