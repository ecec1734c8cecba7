"""Collision-free motions of the arm in a scene, found by the cheapest stage that works."""

from collections.abc import Iterator
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np
from pydrake.math import RigidTransform

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Configuration, FloatArray
from ictamp_drake.motion.carrying import Load, slow_down
from ictamp_drake.motion.collision import CollisionScene, Contact
from ictamp_drake.motion.config import MotionConfig
from ictamp_drake.motion.heights import obstacle_height, raised_path, reach_below_grasp
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.motion.paths import find_path
from ictamp_drake.motion.trajectory import Trajectory, sample
from ictamp_drake.motion.trajectory_optimization import HalfSpace, TrajectoryOptimizer
from ictamp_drake.robots.grip import bearable
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World

_STUCK = "the arm cannot follow the straight line"


class Refusal(NamedTuple):
    """Reason why there is no motion.

    Attributes:
        failure: Cause.
        detail: Words that add to it; may be empty.
        obstacle: Name of what the arm or the held box would have touched; empty if there is no such thing.
        unreached: Pose of G at which the arm has no posture; None if there is no such pose. Whether it is out of reach
            or a joint has a limit takes long to say, so `motion.reach` says it when it is asked.
    """

    failure: Failure
    detail: str = ""
    obstacle: str = ""
    unreached: RigidTransform | None = None

    @classmethod
    def from_contact(cls, failure: Failure, contact: Contact | None) -> "Refusal":
        """Refusal because of a contact, or without a detail when there is none."""
        return cls(failure) if contact is None else cls(failure, str(contact), contact.other)


@dataclass(frozen=True, eq=False)
class PlannedMotion:
    """A collision-free motion and the stage that found it: straight, free, raised, sampled or pushed."""

    trajectory: Trajectory
    stage: str


class MotionPlanner:
    """Plans motions in one scene, among the boxes of a configuration c. The same call gives the same motion.

    Every call takes c: where the boxes are, which of them is in the hand, and how far the fingers are open. The arm's
    own position in c matters only when it holds a box, whose place in the hand follows from both.

    Attributes:
        kinematics: Kinematics of the arm alone.
        optimizer: Optimizer of trajectories, which ignores collisions.
        scene: Collision queries for arm and held box.
    """

    def __init__(
        self, world: World, config: MotionConfig | None = None, time_step: float = PhysicsConfig.time_step
    ) -> None:
        """Prepare to plan in a scene, for physics with a time step [s]."""
        self.config = config or MotionConfig()
        self._time_step = time_step
        self.kinematics = ArmKinematics(world.robot, to_transform(world.spec.arm.X_WB), self.config.kinematics)
        self.optimizer = TrajectoryOptimizer(world.robot, self.config.trajectory)
        self.scene = CollisionScene(world, self.config.held_shrinkage, self.config.padding)
        self._world = world

    def posture(
        self,
        c: Configuration,
        X_WG: RigidTransform,
        q_guess: FloatArray,
        towards: RigidTransform | None = None,
    ) -> FloatArray | Refusal:
        """Joint positions with G at X_WG and no collision, near q_guess, shape (n,) [rad].

        Args:
            c: Configuration of what is around and in the hand.
            X_WG: Target pose of G.
            q_guess: Joint positions that the solution should be near.
            towards: Pose of G to which the arm must be able to follow a straight line. Collisions on it do not count.

        Returns:
            NO_INVERSE_KINEMATICS when the arm cannot bring G there, GOAL_IN_COLLISION when every solution collides.
        """
        colliding: list[FloatArray] = []
        stuck = False

        def accept(q: FloatArray) -> bool:
            nonlocal stuck
            if not self.scene.is_free(c, q):
                colliding.append(q)
                return False
            stuck = towards is not None and self.kinematics.line(q, towards) is None
            return not stuck

        q = self.kinematics.solve(X_WG, q_guess, accept)
        if q is not None:
            return q
        if stuck:
            return Refusal(Failure.NO_INVERSE_KINEMATICS, _STUCK)
        if colliding:
            return Refusal.from_contact(Failure.GOAL_IN_COLLISION, self.scene.first_contact(c, np.array(colliding)))
        return Refusal(Failure.NO_INVERSE_KINEMATICS, unreached=X_WG)

    def plan_straight(self, c: Configuration, q0: FloatArray, X_WG1: RigidTransform) -> PlannedMotion | Refusal:
        """Motion of the hand on a straight line from its pose at q0 to X_WG1, turning evenly.

        To reach a known q1, reverse the motion that starts there: `plan_straight(c, q1, X_WG0).trajectory.reversed()`.
        """
        path = self.kinematics.line(q0, X_WG1)
        if path is None:
            return Refusal(Failure.NO_INVERSE_KINEMATICS, _STUCK)
        points = max(self.config.trajectory.control_points, len(path) + 5)
        trajectory = self.optimizer.follow(path, points)
        if self._is_free(c, trajectory):
            return PlannedMotion(trajectory, "straight")
        failure = Failure.NO_PATH if self.scene.is_free(c, trajectory.end) else Failure.GOAL_IN_COLLISION
        return Refusal.from_contact(failure, self._first_contact(c, trajectory))

    def transfer(
        self, c: Configuration, q0: FloatArray, q1: FloatArray, rng: np.random.Generator
    ) -> PlannedMotion | Refusal:
        """Motion from q0 to q1, both of shape (n,) [rad], on any way that is free."""
        room = self.config.padding
        for q, failure in ((q0, Failure.NO_PATH), (q1, Failure.GOAL_IN_COLLISION)):
            nearest = min(self.scene.contacts(c, q, self.config.padding), default=None, key=lambda each: each.distance)
            if nearest is not None and nearest.distance <= 0:
                return Refusal.from_contact(failure, nearest)
            room = room if nearest is None else min(room, nearest.distance)
        padding = 0.9 * room  # the ends are sure to pass
        free = self.optimizer.connect(q0, q1)
        for stage, trajectory in self._candidates(c, free, padding, rng):
            if self._is_free(c, trajectory, padding):
                return PlannedMotion(trajectory, stage)
        return Refusal.from_contact(Failure.NO_PATH, self._first_contact(c, free, padding))

    def carry(self, c: Configuration, *trajectories: Trajectory) -> tuple[Trajectory, ...] | Refusal:
        """Slow trajectories down so that the box in the hand of c does not slide between the fingers.

        Returns:
            One trajectory for each, or a refusal, TOO_HEAVY, when the box would slide at any speed.
        """
        assert c.held is not None
        box = self._world.spec.boxes[c.held]
        X_GO = self.kinematics.forward(c.q).inverse() @ to_transform(c.poses[c.held])
        lever = self._world.robot.gripper.hand.lever
        load = Load(X_GO.translation(), box.mass, bearable(c.gripper.force, box.friction), lever)
        carried: list[Trajectory] = []
        for trajectory in trajectories:
            slower = slow_down(trajectory, self.kinematics.forward_all, load, self._time_step, self.config.carrying)
            if slower is None:
                return Refusal(Failure.TOO_HEAVY, f"{c.held} would turn in the fingers")
            carried.append(slower)
        return tuple(carried)

    def _candidates(
        self, c: Configuration, free: Trajectory, padding: float, rng: np.random.Generator
    ) -> Iterator[tuple[str, Trajectory]]:
        trajectory, q0, q1 = free, free.start, free.end
        yield "free", trajectory
        path = self._raise_path(c, q0, q1)
        for trajectory in self._fit_path(path):
            yield "raised", trajectory
        limits = self.kinematics.lower, self.kinematics.upper
        path = find_path(
            q0, q1, lambda q: self.scene.is_free(c, q, padding), limits=limits, rng=rng, config=self.config.path
        )
        for trajectory in self._fit_path(path):
            yield "sampled", trajectory
        for _ in range(self.config.push_rounds if path is not None else 0):
            trajectory = self._push_away(c, trajectory, padding)
            yield "pushed", trajectory

    def _raise_path(self, c: Configuration, q0: FloatArray, q1: FloatArray) -> FloatArray | None:
        """A path over what stands in between."""
        p0, p1 = (self.kinematics.forward(q).translation() for q in (q0, q1))
        height = obstacle_height(self._world, c, p0, p1, self.config.hand_width) + self.config.rise
        height += reach_below_grasp(self._world, c, self.kinematics.forward(c.q))
        return raised_path(self.kinematics, q0, q1, height)

    def _fit_path(self, path: FloatArray | None) -> Iterator[Trajectory]:
        if path is None:
            return
        for radius, points in self.config.corridors:
            trajectory = self.optimizer.follow_corridor(path, radius, points)
            yield trajectory

    def _push_away(self, c: Configuration, trajectory: Trajectory, padding: float) -> Trajectory:
        """The trajectory moved away from what is too near, as if distances were linear in the joints."""
        demands = []
        for share in np.linspace(0.0, 1.0, self.config.push_samples)[1:-1]:
            q = trajectory.positions(np.array([share * trajectory.duration]))[0]
            margin = self.config.push_margin * min(1.0, 5 * share, 5 * (1 - share))  # none at the ends, which are fixed
            for distance, gradient in self.scene.clearance_gradients(c, q, padding + margin + self.config.push_margin):
                offset = padding + margin - distance + gradient @ q
                demands.append(HalfSpace(float(share), gradient, float(offset)))
        return self.optimizer.adjust(trajectory, self.config.push_radius, demands)

    def _is_free(self, c: Configuration, trajectory: Trajectory, padding: float = 0.0) -> bool:
        return self.scene.are_free(c, self._samples(trajectory), padding)

    def _first_contact(self, c: Configuration, trajectory: Trajectory, padding: float = 0.0) -> Contact | None:
        return self.scene.first_contact(c, self._samples(trajectory), padding)

    def _samples(self, trajectory: Trajectory) -> FloatArray:
        return sample(trajectory, self.kinematics.forward_all, self.config.step, self.config.turn)
