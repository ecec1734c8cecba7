"""Grids of hand poses for a grasp or a placement, and what a skill needs to be free at each of them.

Where a box is grasped or put down, the hand rises straight up until its tips are above the box. It rises to the same
height from all heights of the grasp, so hand poses come in columns, each with one upper end.
"""

from collections.abc import Sequence
from dataclasses import replace
from typing import NamedTuple, Protocol

import numpy as np
from pydrake.math import RigidTransform

from ictamp_drake.core.types import Configuration, FloatArray
from ictamp_drake.motion.collision import CollisionScene
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.robots.gripper import Gripper
from ictamp_drake.skills.base import imagine, openings
from ictamp_drake.skills.config import GRID_STEP, GRID_TURN, PickConfig, PlaceConfig
from ictamp_drake.skills.geometry import grasp_in_box, level_pose, raise_pose
from ictamp_drake.world.poses import to_pose, to_transform
from ictamp_drake.world.world import World

YAWS: FloatArray = np.deg2rad(np.arange(0, 360, GRID_TURN))
"""All yaws of the grid [rad]."""
_EASY_REACH = 0.5
"""Horizontal distance of G from the base at which most placements are possible [m]."""
_OVERHANG = 10.0
"""Weight of a distance beyond the edge of a face, relative to one from the easiest reach."""
_EASY_DEPTH = 0.02
"""Distance of G below a box's top at which most grasps are possible [m]."""
_SLACK = 1e-4
"""Length by which fingers may overlap a box that just fits between them [m]."""
_AWAY: FloatArray = to_pose(RigidTransform([0.0, 0.0, -100.0]))
"""Pose X_WO of boxes that are left out."""


class Face(NamedTuple):
    """Level rectangle in which the center of a placed box's lower face may be.

    Attributes:
        X_WT: Frame in its middle, z up.
        half: Half sides along T's x and y, shape (2,) [m].
    """

    X_WT: RigidTransform
    half: FloatArray


class GridPose(NamedTuple):
    """Pose of the hand on a grid.

    Attributes:
        p_FG: Position of G in the frame F of the columns, x and y, shape (2,) [m].
        yaw: Yaw of the hand in F [rad].
        variant: Further numbers of the grid, first the height of G in F [m].
    """

    p_FG: FloatArray
    yaw: float
    variant: tuple[float, ...]


class Grid(Protocol):
    """Hand poses of one action, and the configurations of arm, fingers and box that it needs there.

    Attributes:
        c: Configuration with the other boxes far away.
        X_WF: Level frame F of the columns.
        top: Height of G in F at the upper end of each column [m].
        spots: Position of each column in F, x and y, the most promising first, shape (n, 2) [m].
        variants: Variants of each hand pose, the most promising first.
    """

    c: Configuration
    X_WF: RigidTransform
    top: float
    spots: FloatArray
    variants: list[tuple[float, ...]]

    def yaws(self, p_FG: FloatArray) -> FloatArray:
        """Yaws of the hand at which the box fits between the open fingers, shape (m,) [rad]."""

    def opened(self, p_FG: FloatArray, yaw: float) -> Sequence[Configuration]:
        """Configurations with the openings of the hand that the skill may choose, the widest first."""

    def X_WG(self, pose: GridPose) -> RigidTransform | None:
        """Pose of G; None if the box is not in one of its places."""

    def around(self, pose: GridPose, q: FloatArray) -> Sequence[Configuration]:
        """Configurations, at least one of which must be free when the arm is at q, which brings G to the pose."""

    def can_follow(self, pose: GridPose, q: FloatArray, free: Sequence[Configuration]) -> bool:
        """Whether the straight lines of the skill are free from q on, given the configurations free at q."""


class Lines:
    """Straight lines of the hand upwards, and their collisions."""

    def __init__(self, arm: ArmKinematics, scene: CollisionScene) -> None:
        self._arm = arm
        self._scene = scene

    def exists(self, q: FloatArray, X_WG: RigidTransform, rise: float) -> bool:
        """Whether the arm can follow when the hand rises from X_WG, where q brings it."""
        return self._arm.line(q, raise_pose(X_WG, rise)) is not None

    def is_free(self, c: Configuration, q: FloatArray, X_WG: RigidTransform, rise: float) -> bool:
        """Whether the arm can follow without a collision."""
        path = self._arm.line(q, raise_pose(X_WG, rise))
        return path is not None and self._scene.are_free(c, path)


class GraspGrid:
    """Grasps of a box. F is the box's upright frame, and a variant is the height of G alone."""

    def __init__(self, world: World, lines: Lines, config: PickConfig, c: Configuration, box: str) -> None:
        self.c = _alone(c, box)
        self._lines, self._config, self._box = lines, config, box
        self._robot, self._gripper = world.robot, world.robot.gripper
        lying = world.upright_frame(c, box)
        self.X_WF = lying.X_WU
        self._half = lying.size / 2
        self.top = float(self._half[2]) + self._gripper.hand.tip + config.margin
        spots = _list_spots(self._half[:2])
        self.spots = spots[[len(self.yaws(p)) > 0 for p in spots]]
        self.variants: list[tuple[float, ...]] = [
            (float(self._half[2]) - depth,) for depth in _list_depths(self._gripper, lying.size[2])
        ]

    def _needed(self, p_FG: FloatArray, yaw: FloatArray | float) -> FloatArray:
        """Openings at which the fingers just miss the box, see `geometry.needed_opening`: yaws [rad] -> [m]."""
        (x, y), (cos, sin) = self._half[:2], (np.cos(yaw), np.sin(yaw))
        return 2 * (np.abs(sin) * x + np.abs(cos) * y + np.abs(p_FG[0] * sin - p_FG[1] * cos))

    def yaws(self, p_FG: FloatArray) -> FloatArray:
        return YAWS[self._needed(p_FG, YAWS) <= self._gripper.opening + _SLACK]

    def X_WG(self, pose: GridPose) -> RigidTransform:
        return hand_pose(self.X_WF, pose.p_FG, pose.variant[0], pose.yaw)

    def opened(self, p_FG: FloatArray, yaw: float) -> list[Configuration]:
        fitting = openings(self._gripper, float(self._needed(p_FG, yaw)), self._config.clearances)
        return [imagine(self._gripper, self.c, q=self._robot.home, width=each.width, held=None) for each in fitting]

    def around(self, pose: GridPose, _: FloatArray) -> list[Configuration]:
        return self.opened(pose.p_FG, pose.yaw)

    def can_follow(self, pose: GridPose, q: FloatArray, free: Sequence[Configuration]) -> bool:
        X_WG, rise = self.X_WG(pose), self.top - pose.variant[0]
        width = float(self._needed(pose.p_FG, pose.yaw))
        grasped = imagine(self._gripper, self.c, q=q, width=width, held=self._box)
        return any(self._lines.is_free(c, q, X_WG, rise) for c in free) and self._lines.is_free(
            grasped, q, X_WG, self._config.lift
        )


class PlacementGrid:
    """Placements of a box on a face, held in any grasp. F is T, and the variants are the grasps.

    A variant has the height of G above the face [m], the number of quarter turns from the hand to the box, and the
    distance of G from the box's center along G's x [m].
    """

    def __init__(
        self, world: World, lines: Lines, config: PlaceConfig, *, c: Configuration, box: str, face: Face
    ) -> None:
        self.c = _alone(c, box)
        self._lines, self._config, self._box, self._face = lines, config, box, face
        gripper = self._gripper = world.robot.gripper
        lying = world.upright_frame(c, box)
        self._size, self._X_UO = lying.size, lying.X_WU.inverse() @ to_transform(c.poses[box])
        self.X_WF = face.X_WT
        self.top = float(self._size[2]) + gripper.hand.tip + config.margin
        turns = [turn for turn in (0, 1) if self._size[1 - turn] <= gripper.max_side]
        fitting = (openings(gripper, float(self._size[1 - turn]), config.clearances) for turn in turns)
        widths = [each.width for some in fitting for each in some]
        self._opened = [imagine(gripper, self.c, q=world.robot.home, width=width, held=None) for width in widths]
        spots = _list_spots(face.half + max(self._size[turn] for turn in turns) / 2)
        p_WG = (self.X_WF @ np.insert(spots, 2, 0.0, axis=1).T).T
        away = np.linalg.norm(p_WG[:, :2] - world.spec.arm.position[:2], axis=1)
        over = np.maximum(np.abs(spots) - face.half, 0.0).max(axis=1)
        order = np.argsort(np.abs(away - _EASY_REACH) + _OVERHANG * over, kind="stable")
        self.spots = spots[order]
        self.variants: list[tuple[float, ...]] = [
            (float(self._size[2]) - depth, turn, float(x))
            for depth in _list_depths(gripper, self._size[2])
            for turn in turns
            for x in _list_steps(self._size[turn] / 2)
        ]
        easiest = self.variants[0][0]
        self.variants.sort(key=lambda each: abs(each[0] - easiest) + abs(each[2]))

    def yaws(self, _: FloatArray) -> FloatArray:
        return YAWS

    def opened(self, *_: object) -> list[Configuration]:
        return self._opened

    def X_WG(self, pose: GridPose) -> RigidTransform | None:
        inside = np.all(np.abs(self._middle(pose)) <= self._face.half + _SLACK)
        return hand_pose(self.X_WF, pose.p_FG, pose.variant[0], pose.yaw) if inside else None

    def _middle(self, pose: GridPose) -> FloatArray:
        """Position of the box's center in T, x and y, shape (2,) [m]."""
        return pose.p_FG - pose.variant[2] * np.array([np.cos(pose.yaw), np.sin(pose.yaw)])

    def around(self, pose: GridPose, q: FloatArray) -> list[Configuration]:
        yaw = pose.yaw + pose.variant[1] * np.pi / 2
        X_TU = level_pose(np.array([*self._middle(pose), self._size[2] / 2, yaw]))
        X_WO = to_pose(self.X_WF @ X_TU @ self._X_UO)
        return [imagine(self._gripper, self.c, q=q, width=self._width(pose), held=self._box, moved={self._box: X_WO})]

    def _width(self, pose: GridPose) -> float:
        return float(self._size[1 - int(pose.variant[1])])

    def can_follow(self, pose: GridPose, q: FloatArray, free: Sequence[Configuration]) -> bool:
        X_WG, above = hand_pose(self.X_WF, pose.p_FG, pose.variant[0], pose.yaw), self.top - pose.variant[0]
        fitting = openings(self._gripper, self._width(pose), self._config.clearances)
        return any(
            self._lines.exists(q, X_WG, max(above, self._config.drop))
            and self._lines.is_free(c, q, X_WG, self._config.drop)
            and any(
                self._lines.is_free(imagine(self._gripper, c, q=q, width=each.width, held=None), q, X_WG, above)
                for each in fitting
            )
            for c in free
        )


def hand_pose(X_WF: RigidTransform, p_FG: FloatArray, height: float, yaw: float) -> RigidTransform:
    """X_WG of a hand that points down, at p_FG, shape (2,) [m], a height [m] and a yaw [rad] in the level frame F."""
    return X_WF @ grasp_in_box(np.array([*p_FG, height, yaw]))


def _alone(c: Configuration, box: str) -> Configuration:
    """c with an empty hand and no other box: the others can be moved, so they count as far away."""
    return replace(c, poses={name: pose if name == box else _AWAY for name, pose in c.poses.items()}, held=None, x=None)


def _list_steps(half: float) -> FloatArray:
    """List positions of the grid from -half to half [m], 0 among them, the middle first; shape (n,) [m]."""
    count = int(half / GRID_STEP + 1e-6)
    return GRID_STEP * np.array(sorted(range(-count, count + 1), key=abs))


def _list_spots(half: FloatArray) -> FloatArray:
    """List positions of the grid in a rectangle with half sides of shape (2,) [m], the middle first; shape (n, 2)."""
    spots = np.array(np.meshgrid(*map(_list_steps, half))).reshape(2, -1).T
    return spots[np.argsort(np.linalg.norm(spots, axis=1), kind="stable")]


def _list_depths(gripper: Gripper, height: float) -> list[float]:
    """List distances of G below the top of a box of some height [m] at which the pads may touch it, the easiest first.

    The pads of a linkage are above or below G, depending on the width.
    """
    hand, lowest, highest = gripper.hand, float(gripper.rises.max()), float(gripper.rises.min())
    depths = np.arange(-hand.pad_half_height - lowest + GRID_STEP / 2, height - highest, GRID_STEP)
    easy = min(_EASY_DEPTH, height - hand.tip)  # which keeps the tips off what the box rests on
    return sorted(depths.tolist(), key=lambda depth: abs(depth - easy))
