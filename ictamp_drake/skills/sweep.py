"""Sweeps over a grid, to find out whether an action has any grasp or placement at all.

Other boxes can be moved, so a sweep looks at the arm and the supports alone. It does not look for transfers of the arm.
"""

from collections import Counter
from collections.abc import Iterable, Iterator, Sequence
from dataclasses import replace

import numpy as np
from pydrake.math import RigidTransform

from ictamp_drake.core.types import Configuration, FloatArray
from ictamp_drake.motion.collision import CollisionScene
from ictamp_drake.motion.columns import OUT_OF_REACH, Columns
from ictamp_drake.motion.config import MotionConfig
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.skills.config import PickConfig, PlaceConfig
from ictamp_drake.skills.grid import YAWS, Face, GraspGrid, Grid, GridPose, Lines, PlacementGrid, hand_pose
from ictamp_drake.world.poses import to_pose, to_transform
from ictamp_drake.world.world import World

_MAX_EFFORT = 50_000
"""Maximum effort spent on one scene, in units of about 0.1 ms. One action takes at most half of what is left."""
_COLUMN, _POSE, _POSTURE = 20, 1, 10
"""Effort for a column, a hand pose and a posture."""
_FIRST = 40
"""Number of columns that are tested before reach and obstacles of all others are computed at once."""
_MAX_TILT = 0.01
"""Maximum tilt of a box whose grasps are swept [rad]."""
_ATTEMPTS = 1000
"""Maximum number of postures tried for one hand pose: in effect all of them."""
_MISSED = 60
"""Number of poses without a posture that are kept, about."""
_BLAMED = 10
"""Number of postures for each one that is looked at to name an obstacle."""


class Sweep:
    """Sweeps over the grasps and placements in a scene.

    They take for granted that the first joint turns the arm about the vertical, that the last one turns the hand about
    its own axis, and that no posture is missed. For other arms, and with numeric inverse kinematics, a sweep says
    nothing: it returns None.

    Attributes:
        unreached: Some poses of G, shape (7,) each, at which the arm has no posture, by the swept action and its box.
    """

    def __init__(self, world: World, motion: MotionConfig, pick: PickConfig, place: PlaceConfig) -> None:
        kinematics, robot = replace(motion.kinematics, attempts=_ATTEMPTS), world.robot
        self._world, self._pick, self._place = world, pick, place
        self._arm = ArmKinematics(robot, to_transform(world.spec.arm.X_WB), kinematics)
        self._knows = self._arm.is_sure and bool(robot.waist and robot.wrist)
        self._scene = CollisionScene(world, motion.held_shrinkage, 0.0)
        self._lines = Lines(self._arm, self._scene)
        self._columns = Columns(world, self._arm)
        self._left = _MAX_EFFORT
        self._allowed = 0
        self.unreached: dict[tuple[str, str], list[FloatArray]] = {}
        self._missed: list[RigidTransform] = []
        self._latest: tuple[object, tuple[float, ...], FloatArray] = (None, (), np.empty(0))

    def refuse_grasps(self, c: Configuration, box: str) -> Counter[str] | None:
        """Count the refused grasps of a box where it is in c, by obstacle.

        Returns:
            Number of grasps by the support in their way; OUT_OF_REACH for those out of reach. None if a grasp is
            free, if there are too many to test, if the box is tilted, or if the arm is not one that can be swept.
        """
        is_level = self._world.upright_frame(c, box).X_WU.rotation().matrix()[2, 2] > np.cos(_MAX_TILT)
        if not is_level:
            return None
        return self._refuse(("pick", box), GraspGrid(self._world, self._lines, self._pick, c, box))

    def refuse_placements(self, c: Configuration, box: str, face: Face) -> Counter[str] | None:
        """Count the refused placements of a box on a face, held in any grasp; see `refuse_grasps`."""
        grid = PlacementGrid(self._world, self._lines, self._place, c=c, box=box, face=face)
        return self._refuse(("place", box), grid)

    def _refuse(self, action: tuple[str, str], grid: Grid) -> Counter[str] | None:
        if not self._knows:
            return None
        self._allowed = self._left // 2
        before, self._missed = self._allowed, []
        try:
            refused = self._count_refused(grid)
            step = len(self._missed) // _MISSED + 1
            self.unreached.setdefault(action, []).extend(map(to_pose, self._missed[::step]))
            return refused
        except _UndecidedError:
            return None
        finally:
            self._left -= before - self._allowed

    def _spend(self, effort: int) -> None:
        self._allowed -= effort
        if self._allowed <= 0:
            raise _UndecidedError

    def _count_refused(self, grid: Grid) -> Counter[str] | None:
        refused, causes = Counter[str](), dict[tuple[float, ...], str]()
        poses: Iterable[tuple[FloatArray, float]] = self._open_columns(grid, refused)  # drawn on with the first variant
        for variant in grid.variants:
            seen = []
            for p_FG, yaw in poses:
                known = causes.get(p := tuple(p_FG), OUT_OF_REACH)
                cause = self._refuse_pose(grid, GridPose(p_FG, yaw, variant), known)
                if cause is None:
                    return None
                causes[p] = cause
                seen.append((p_FG, yaw))
            poses = seen
        for p, cause in causes.items():
            refused[cause] += len(grid.yaws(np.array(p)))
        return +refused

    def _open_columns(self, grid: Grid, refused: Counter[str]) -> Iterator[tuple[FloatArray, float]]:
        """Yield p_FG, shape (2,) [m], and yaw [rad] of columns with a free upper end, and count those refused."""
        for p_FG in self._near_spots(grid, refused):
            self._spend(_COLUMN)
            yaws, found = grid.yaws(p_FG), False
            postures = self._arm.turning_postures(hand_pose(grid.X_WF, p_FG, grid.top, 0.0))
            if not len(postures):
                refused[OUT_OF_REACH] += len(yaws)
                self._missed.append(hand_pose(grid.X_WF, p_FG, grid.top, 0.0))
            elif not any(self._columns.links.is_free(grid.c, q) for q in postures):
                refused[self._columns.blame(self._columns.links, grid.c, postures)] += len(yaws)
            else:
                q = postures[0].copy()
                for yaw in yaws:
                    q[-1] = postures[0, -1] - self._arm.robot.wrist * yaw
                    if self._is_hand_free(grid.opened(p_FG, yaw), q):
                        found = True
                        yield p_FG, float(yaw)
                if not found:
                    last = grid.opened(p_FG, yaws[-1])[-1]
                    refused[self._columns.blame(self._columns.hand, last, q[None])] += len(yaws)

    def _is_hand_free(self, around: Sequence[Configuration], q: FloatArray) -> bool:
        """Whether the hand is free in one of these configurations when the arm is at q; the palm is tested first."""
        return self._columns.palm.is_free(around[0], q) and any(self._columns.hand.is_free(c, q) for c in around)

    def _near_spots(self, grid: Grid, refused: Counter[str]) -> Iterator[FloatArray]:
        """Yield all spots but those that are far out of reach or inside a support, which are counted as refused."""
        yield from grid.spots[:_FIRST]
        spots = grid.spots[_FIRST:]
        if len(spots):
            p_WG = (grid.X_WF @ np.column_stack([spots, np.full(len(spots), grid.top)]).T).T
            near = self._columns.is_within_reach(p_WG)
            far = spots[~near]
            refused[OUT_OF_REACH] += len(YAWS) * len(far)
            self._missed += [hand_pose(grid.X_WF, p, grid.top, 0.0) for p in far[:: len(far) // _MISSED + 1]]
            for p_FG, obstacle in zip(spots[near], self._columns.find_obstacles(p_WG[near]), strict=True):
                if obstacle:
                    refused[obstacle] += len(grid.yaws(p_FG))
                else:
                    yield p_FG

    def _refuse_pose(self, grid: Grid, pose: GridPose, known: str) -> str | None:
        """Name the obstacle of a hand pose, or `known`, the obstacle of its column; None if the pose is free."""
        self._spend(_POSE)
        X_WG = grid.X_WG(pose)
        if X_WG is None:
            return known
        postures = self._turning_postures(grid.X_WF, pose)
        if not len(postures):
            self._missed.append(X_WG)
            return known
        around = grid.around(pose, postures[0])
        if not self._is_hand_free(around, postures[0]):
            return known or self._columns.blame(self._columns.hand, around[0], postures[:1])

        def accept(q: FloatArray) -> bool:
            self._spend(_POSTURE)
            return grid.can_follow(pose, q, [c for c in around if self._scene.is_free(c, q)])

        if self._arm.solve(X_WG, self._arm.robot.home, accept) is not None:
            return None
        cause = known or self._columns.blame(self._scene, around[-1], postures[::_BLAMED])
        if cause == OUT_OF_REACH:
            self._missed.append(X_WG)
        return cause

    def _turning_postures(self, X_WF: RigidTransform, pose: GridPose) -> FloatArray:
        """`ArmKinematics.turning_postures` of a pose, shape (m, n) [rad]; those of yaw 0 are kept for the next yaw."""
        p_FG = *pose.p_FG, pose.variant[0]
        if self._latest[:2] != (X_WF, p_FG):
            self._latest = X_WF, p_FG, self._arm.turning_postures(hand_pose(X_WF, pose.p_FG, pose.variant[0], 0.0))
        postures = self._latest[2].copy()
        postures[:, -1] -= self._arm.robot.wrist * pose.yaw  # a hand that points down turns the other way
        return postures


class _UndecidedError(Exception):
    """The sweep takes more effort than is allowed."""
