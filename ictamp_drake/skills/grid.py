"""Whether an action has any grasp or placement at all, on a grid, among what never moves: the supports and the arm.

Where a box is grasped or put down, the hand rises straight up until its tips are above the box. This height is the same
for all heights of the grasp, so a whole column of hand poses is refused when its upper end is. Transfers of the arm are
not looked for.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace
from typing import NamedTuple, Protocol

import numpy as np
from pydrake.math import RigidTransform

from ictamp_drake.core.types import Configuration, FloatArray
from ictamp_drake.models.constants import HOME
from ictamp_drake.models.hand import MAX_OPENING, MAX_SIDE, PAD_HALF_HEIGHT, TIP
from ictamp_drake.motion.collision import CollisionScene
from ictamp_drake.motion.columns import OUT_OF_REACH, Columns
from ictamp_drake.motion.config import MotionConfig
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.skills.base import imagine, openings
from ictamp_drake.skills.config import GRID_STEP, GRID_TURN, PickConfig, PlaceConfig
from ictamp_drake.skills.geometry import grasp_in_box, level_pose, raise_pose
from ictamp_drake.world.poses import to_pose, to_transform
from ictamp_drake.world.world import World

_YAWS: FloatArray = np.deg2rad(np.arange(0, 360, GRID_TURN))
_MOST = 50_000
"""Effort that is spent on one scene, at most half of what is left on each action, about 0.1 ms each."""
_COLUMN, _POSE, _POSTURE = 20, 1, 10
"""Effort for a column, a hand pose and a posture."""
_FIRST = 40
"""Number of columns that are looked at before reach and obstacles of all of them are computed."""
_EASY_REACH = 0.5
"""Horizontal distance from the base at which most things are easy [m]."""
_OVERHANG = 10.0
"""Distance from the easiest reach that counts like the same distance beyond the edge of a face."""
_EASY_DEPTH = 0.02
"""Distance of G below a box's top at which most things are easy [m]."""
_LEVEL = 0.01
"""Largest tilt of a box whose columns are vertical [rad]."""
_SLACK = 1e-4
"""Length by which fingers may overlap a box that just fits between them [m]."""
_AWAY: FloatArray = to_pose(RigidTransform([0.0, 0.0, -100.0]))


class Face(NamedTuple):
    """Places for the center of a box's lower face.

    Attributes:
        X_WT: Frame in the middle of these places, z up.
        half: Half sides of their area along T's x and y, shape (2,) [m].
    """

    X_WT: RigidTransform
    half: FloatArray


class _Pose(NamedTuple):
    """A pose of the hand on the grid.

    Attributes:
        p_FG: Position of G in the frame F of the columns, x and y, shape (2,) [m].
        yaw: Yaw of the hand in F [rad].
        variant: Anything else, such as the height of G.
    """

    p_FG: FloatArray
    yaw: float
    variant: tuple[float, ...]


class _Grid(Protocol):
    """Hand poses of one action.

    Attributes:
        c: Configuration without the other boxes.
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
        """Yaws of the hand at which the box fits between the fingers, shape (m,) [rad]."""

    def opened(self, p_FG: FloatArray, yaw: float) -> Sequence[Configuration]:
        """Configurations in which the hand is as far open as it may be at the upper end of a column."""

    def X_WG(self, pose: _Pose) -> RigidTransform | None:
        """Pose of G; None if the box is not in one of its places."""

    def around(self, pose: _Pose, q: FloatArray) -> Sequence[Configuration]:
        """Configurations, at least one of which must be free when the arm is at q, with G at the pose."""

    def can_follow(self, pose: _Pose, q: FloatArray, free: Sequence[Configuration]) -> bool:
        """Whether the straight lines of the skill are free from q on, if these configurations are free."""


class Sweep:
    """Sweeps over the grasps and placements in a scene."""

    def __init__(self, world: World, motion: MotionConfig, pick: PickConfig, place: PlaceConfig) -> None:
        kinematics = replace(motion.kinematics, attempts=1000)
        self._world, self._pick, self._place = world, pick, place
        self._arm = ArmKinematics(to_transform(world.spec.arm.X_WB), kinematics)
        self._scene = CollisionScene(world, motion.held_shrinkage, 0.0)
        self._lines = _Lines(self._arm, self._scene)
        self._columns = Columns(world, self._arm)
        self._left = _MOST
        self._allowed = 0
        self._latest: tuple[object, tuple[float, ...], FloatArray] = (None, (), np.empty(0))

    def refuse_grasps(self, c: Configuration, box: str) -> Counter[str] | None:
        """Count the refused grasps of a box where it is in c, by obstacle.

        Returns:
            Number of grasps by the support in their way; those out of reach have an empty name. None if one of them is
            free, if they are too many to tell, or if the box leans.
        """
        is_level = self._world.upright_frame(c, box).X_WU.rotation().matrix()[2, 2] > np.cos(_LEVEL)
        return self._refuse(_Grasps(self._world, self._lines, self._pick, c, box)) if is_level else None

    def refuse_placements(self, c: Configuration, box: str, face: Face) -> Counter[str] | None:
        """Count the refused placements of a box on a face, held in any grasp; see `refuse_grasps`."""
        return self._refuse(_Placements(self._world, self._lines, self._place, c=c, box=box, face=face))

    def _refuse(self, grid: _Grid) -> Counter[str] | None:
        self._allowed = self._left // 2
        before = self._allowed
        try:
            return self._count_refused(grid)
        except _UndecidedError:
            return None
        finally:
            self._left -= before - self._allowed

    def _spend(self, effort: int) -> None:
        self._allowed -= effort
        if self._allowed <= 0:
            raise _UndecidedError

    def _count_refused(self, grid: _Grid) -> Counter[str] | None:
        refused, causes = Counter[str](), dict[tuple[float, float], Counter[str]]()
        poses: Iterable[tuple[FloatArray, float]] = self._open_columns(grid, refused)
        for variant in grid.variants:
            seen = []
            for p_FG, yaw in poses:
                cause = self._refuse_pose(grid, _Pose(p_FG, yaw, variant))
                if cause is None:
                    return None
                causes.setdefault(tuple(p_FG), Counter())[cause] += 1
                seen.append((p_FG, yaw))
            poses = seen
        for p, counts in causes.items():
            known = [cause for cause, _ in counts.most_common() if cause != OUT_OF_REACH]
            refused[known[0] if known else OUT_OF_REACH] += len(grid.yaws(np.array(p)))
        return +refused

    def _open_columns(self, grid: _Grid, refused: Counter[str]) -> Iterator[tuple[FloatArray, float]]:
        """Yield position and yaw of the columns whose upper end is free, and count those that are refused."""
        for p_FG in self._near_spots(grid, refused):
            self._spend(_COLUMN)
            yaws, found = grid.yaws(p_FG), False
            postures = self._arm.turning_postures(_hand_pose(grid.X_WF, p_FG, grid.top, 0.0))
            if not len(postures):
                refused[OUT_OF_REACH] += len(yaws)
            elif not any(self._columns.links.is_free(grid.c, q) for q in postures):
                refused[self._columns.blame(self._columns.links, grid.c, postures)] += len(yaws)
            else:
                q = postures[0].copy()
                for yaw in yaws:
                    q[6] = postures[0, 6] - yaw
                    if self._is_hand_free(grid.opened(p_FG, yaw), q):
                        found = True
                        yield p_FG, float(yaw)
                if not found:
                    last = grid.opened(p_FG, yaws[-1])[-1]
                    refused[self._columns.blame(self._columns.hand, last, q[None])] += len(yaws)

    def _is_hand_free(self, around: Sequence[Configuration], q: FloatArray) -> bool:
        """Whether the hand is free in one of these configurations when the arm is at q; the palm is tested first."""
        return self._columns.palm.is_free(around[0], q) and any(self._columns.hand.is_free(c, q) for c in around)

    def _near_spots(self, grid: _Grid, refused: Counter[str]) -> Iterator[FloatArray]:
        """Yield all spots but those that are far out of reach or inside a support, and count the latter."""
        yield from grid.spots[:_FIRST]
        spots = grid.spots[_FIRST:]
        if len(spots):
            p_WG = (grid.X_WF @ np.column_stack([spots, np.full(len(spots), grid.top)]).T).T
            near = self._columns.is_near_enough(p_WG)
            refused[OUT_OF_REACH] += len(_YAWS) * int(np.count_nonzero(~near))
            for p_FG, obstacle in zip(spots[near], self._columns.obstacles(p_WG[near]), strict=True):
                if obstacle:
                    refused[obstacle] += len(grid.yaws(p_FG))
                else:
                    yield p_FG

    def _refuse_pose(self, grid: _Grid, pose: _Pose) -> str | None:
        """Name the obstacle of a hand pose, which may be `OUT_OF_REACH`; None if the pose is free."""
        self._spend(_POSE)
        X_WG = grid.X_WG(pose)
        if X_WG is None:
            return OUT_OF_REACH
        postures = self._turning_postures(grid.X_WF, pose)
        if not len(postures):
            return OUT_OF_REACH
        around = grid.around(pose, postures[0])
        if not self._is_hand_free(around, postures[0]):
            return self._columns.blame(self._columns.hand, around[0], postures[:1])

        def accept(q: FloatArray) -> bool:
            self._spend(_POSTURE)
            return grid.can_follow(pose, q, [c for c in around if self._scene.is_free(c, q)])

        if self._arm.solve(X_WG, HOME, accept) is not None:
            return None
        return self._columns.blame(self._scene, around[-1], postures[::10])

    def _turning_postures(self, X_WF: RigidTransform, pose: _Pose) -> FloatArray:
        """`ArmKinematics.turning_postures` of a hand pose, from those of yaw 0, which are kept for the next yaw."""
        p_FG = *pose.p_FG, pose.variant[0]
        if self._latest[:2] != (X_WF, p_FG):
            self._latest = X_WF, p_FG, self._arm.turning_postures(_hand_pose(X_WF, pose.p_FG, pose.variant[0], 0.0))
        postures = self._latest[2].copy()
        postures[:, 6] -= pose.yaw  # a hand that points down turns the other way
        return postures


class _UndecidedError(Exception):
    """There is more than can be looked at."""


class _Lines:
    """Straight lines of the hand."""

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


class _Grasps:
    """Grasps of a box. Variants are the height of G in the box's upright frame, which is F."""

    def __init__(self, world: World, lines: _Lines, config: PickConfig, c: Configuration, box: str) -> None:
        self.c = _alone(c, box)
        self._lines, self._config, self._box = lines, config, box
        lying = world.upright_frame(c, box)
        self.X_WF = lying.X_WU
        self._half = lying.size / 2
        self.top = float(self._half[2]) + TIP + config.margin
        spots = _spots(self._half[:2])
        self.spots = spots[[len(self.yaws(p)) > 0 for p in spots]]
        self.variants = [(float(self._half[2]) - depth,) for depth in _depths(lying.size[2])]

    def _needed(self, p_FG: FloatArray, yaw: FloatArray | float) -> FloatArray:
        """Opening of the fingers that just miss the box, see `geometry.needed_opening`."""
        (x, y), (cos, sin) = self._half[:2], (np.cos(yaw), np.sin(yaw))
        return 2 * (np.abs(sin) * x + np.abs(cos) * y + np.abs(p_FG[0] * sin - p_FG[1] * cos))

    def yaws(self, p_FG: FloatArray) -> FloatArray:
        return _YAWS[self._needed(p_FG, _YAWS) <= MAX_OPENING + _SLACK]

    def X_WG(self, pose: _Pose) -> RigidTransform:
        return _hand_pose(self.X_WF, pose.p_FG, pose.variant[0], pose.yaw)

    def opened(self, p_FG: FloatArray, yaw: float) -> list[Configuration]:
        fitting = openings(float(self._needed(p_FG, yaw)), self._config.clearances)
        return [imagine(self.c, q=HOME, width=each.width, held=None) for each in fitting]

    def around(self, pose: _Pose, _: FloatArray) -> list[Configuration]:
        return self.opened(pose.p_FG, pose.yaw)

    def can_follow(self, pose: _Pose, q: FloatArray, free: Sequence[Configuration]) -> bool:
        X_WG, rise = self.X_WG(pose), self.top - pose.variant[0]
        grasped = imagine(self.c, q=q, width=float(self._needed(pose.p_FG, pose.yaw)), held=self._box)
        return any(self._lines.is_free(c, q, X_WG, rise) for c in free) and self._lines.is_free(
            grasped, q, X_WG, self._config.lift
        )


class _Placements:
    """Placements of a box on a face. F is T, and the variants are the grasps.

    A variant has the height of G above the face [m], the number of quarter turns from the hand to the box, and the
    distance of G from the box's center along G's x [m].
    """

    def __init__(
        self, world: World, lines: _Lines, config: PlaceConfig, *, c: Configuration, box: str, face: Face
    ) -> None:
        self.c = _alone(c, box)
        self._lines, self._config, self._box, self._face = lines, config, box, face
        lying = world.upright_frame(c, box)
        self._size, self._X_UO = lying.size, lying.X_WU.inverse() @ to_transform(c.poses[box])
        self.X_WF = face.X_WT
        self.top = float(self._size[2]) + TIP + config.margin
        turns = [turn for turn in (0, 1) if self._size[1 - turn] <= MAX_SIDE]
        fitting = (openings(float(self._size[1 - turn]), config.clearances) for turn in turns)
        self._opened = [imagine(self.c, q=HOME, width=each.width, held=None) for some in fitting for each in some]
        spots = _spots(face.half + max(self._size[turn] for turn in turns) / 2)
        p_WG = (self.X_WF @ np.insert(spots, 2, 0.0, axis=1).T).T
        away = np.linalg.norm(p_WG[:, :2] - world.spec.arm.position[:2], axis=1)
        over = np.maximum(np.abs(spots) - face.half, 0.0).max(axis=1)
        order = np.argsort(np.abs(away - _EASY_REACH) + _OVERHANG * over, kind="stable")
        self.spots = spots[order]
        self.variants = [
            (float(self._size[2]) - depth, turn, x)
            for depth in _depths(self._size[2])
            for turn in turns
            for x in _steps(self._size[turn] / 2)
        ]
        easiest = self.variants[0][0]
        self.variants.sort(key=lambda each: abs(each[0] - easiest) + abs(each[2]))

    def yaws(self, _: FloatArray) -> FloatArray:
        return _YAWS

    def opened(self, *_: object) -> list[Configuration]:
        return self._opened

    def X_WG(self, pose: _Pose) -> RigidTransform | None:
        inside = np.all(np.abs(self._middle(pose)) <= self._face.half + _SLACK)
        return _hand_pose(self.X_WF, pose.p_FG, pose.variant[0], pose.yaw) if inside else None

    def _middle(self, pose: _Pose) -> FloatArray:
        """x and y of the box in T, shape (2,) [m]."""
        return pose.p_FG - pose.variant[2] * np.array([np.cos(pose.yaw), np.sin(pose.yaw)])

    def around(self, pose: _Pose, q: FloatArray) -> list[Configuration]:
        yaw = pose.yaw + pose.variant[1] * np.pi / 2
        X_TU = level_pose(np.array([*self._middle(pose), self._size[2] / 2, yaw]))
        X_WO = to_pose(self.X_WF @ X_TU @ self._X_UO)
        return [imagine(self.c, q=q, width=self._width(pose), held=self._box, moved={self._box: X_WO})]

    def _width(self, pose: _Pose) -> float:
        return float(self._size[1 - int(pose.variant[1])])

    def can_follow(self, pose: _Pose, q: FloatArray, free: Sequence[Configuration]) -> bool:
        X_WG, above = _hand_pose(self.X_WF, pose.p_FG, pose.variant[0], pose.yaw), self.top - pose.variant[0]
        fitting = openings(self._width(pose), self._config.clearances)
        return any(
            self._lines.exists(q, X_WG, max(above, self._config.drop))
            and self._lines.is_free(c, q, X_WG, self._config.drop)
            and any(
                self._lines.is_free(imagine(c, q=q, width=each.width, held=None), q, X_WG, above) for each in fitting
            )
            for c in free
        )


def _hand_pose(X_WF: RigidTransform, p_FG: FloatArray, height: float, yaw: float) -> RigidTransform:
    """X_WG of a hand that points down, at a height [m] and a yaw [rad] in a level frame."""
    return X_WF @ grasp_in_box(np.array([*p_FG, height, yaw]))


def _alone(c: Configuration, box: str) -> Configuration:
    """c with the box alone and the hand empty: the others, which can be moved, are far away."""
    return replace(c, poses={name: pose if name == box else _AWAY for name, pose in c.poses.items()}, held=None, x=None)


def _steps(half: float) -> FloatArray:
    """Positions of the grid from -half to half, 0 among them, the middle first [m]."""
    count = int(half / GRID_STEP + 1e-6)
    return GRID_STEP * np.array(sorted(range(-count, count + 1), key=abs))


def _spots(half: FloatArray) -> FloatArray:
    """Positions of the grid in a rectangle, the middle first, shape (n, 2) [m]."""
    spots = np.array(np.meshgrid(*map(_steps, half))).reshape(2, -1).T
    return spots[np.argsort(np.linalg.norm(spots, axis=1), kind="stable")]


def _depths(height: float) -> list[float]:
    """Distances of G below the top of a box at which the pads touch it, the easiest first [m]."""
    depths = np.arange(-PAD_HALF_HEIGHT + GRID_STEP / 2, height, GRID_STEP)
    easy = min(_EASY_DEPTH, height - TIP)  # which keeps the tips off what the box rests on
    return sorted(depths.tolist(), key=lambda depth: abs(depth - easy))
