"""Kinematics of the arm alone: forward, inverse, and straight lines of the hand."""

from collections.abc import Callable, Sequence
from functools import lru_cache

import numpy as np
from numpy.typing import NDArray
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import FixedOffsetFrame, JacobianWrtVariable

from ictamp_drake.core.types import FloatArray
from ictamp_drake.motion.config import KinematicsConfig
from ictamp_drake.robots.bodies import RobotBodies
from ictamp_drake.robots.chain import ROUNDING, turn_into, turn_near
from ictamp_drake.robots.choice import free_angles
from ictamp_drake.robots.robot import Robot
from ictamp_drake.world.matrices import grasps

_ROUNDS = 4
"""Number of rounds in which angles of the free joint are checked for travel times, the nearest first."""

_SPARE = 0.5
"""Distance that a joint keeps from its limits where it can be turned the other way round instead [rad]."""

_LINES = 15
"""Number of lines kept in memory: whether a line exists is often asked before it is used."""


class ArmKinematics:
    """Kinematics of the arm on its base with nothing around it. Holds one Drake context.

    Attributes:
        robot: Robot.
        config: Constants of inverse kinematics.
        plant: Plant in which only the arm's joints move.
        grasp: Frame G in this plant.
        lower, upper: Limits of the joints less a margin, shape (n,) [rad].
    """

    def __init__(self, robot: Robot, X_WB: RigidTransform, config: KinematicsConfig | None = None) -> None:
        self.robot = robot
        self.config = config or KinematicsConfig()
        bodies = _arm_plant(robot, tuple(X_WB.GetAsMatrix34().ravel()))
        self.plant, self.grasp = bodies.plant, bodies.grasp
        self._X_BW, self._X_WB = X_WB.inverse(), X_WB.GetAsMatrix4()
        self._context = self.plant.CreateDefaultContext()
        self.lower = robot.lower + self.config.joint_margin
        self.upper = robot.upper - self.config.joint_margin
        self._limits = np.array([self.lower, self.upper])
        self._lines: dict[tuple[bytes, bytes], FloatArray | None] = {}
        self._inverse = robot.inverse(self.config.kind, self.config.starts)
        self._angles = self._grid(self._limits, self.config.last_step)
        self._turns = bool(np.any(self.upper - self.lower > 2 * np.pi))

    @property
    def is_sure(self) -> bool:
        """Whether a pose without a posture is out of reach, so that nothing was missed."""
        return self._inverse.finds_all

    def forward(self, q: FloatArray) -> RigidTransform:
        """X_WG at the arm's joint positions q, shape (n,) [rad]."""
        self.plant.SetPositions(self._context, q)
        return self.plant.CalcRelativeTransform(self._context, self.plant.world_frame(), self.grasp)

    def forward_all(self, q: FloatArray) -> FloatArray:
        """X_WG at many joint positions, shape (m, n) [rad] -> (m, 4, 4)."""
        X_WG: FloatArray = self._X_WB @ self.robot.forward(q)
        return X_WG

    def solve(
        self, X_WG: RigidTransform, q_guess: FloatArray, accept: Callable[[FloatArray], bool] | None = None
    ) -> FloatArray | None:
        """Joint positions that bring G to X_WG, near q_guess and comfortable, shape (n,) [rad], or None.

        Joints that can turn more than once are turned to where they are nearest to both.

        Args:
            X_WG: Target pose of G.
            q_guess: Joint positions that the solution should be near, shape (n,) [rad].
            accept: Further condition that a solution must satisfy, e.g. freedom from collisions.
        """
        found = self._postures(X_WG, self._angles, self._limits)
        guess_weight, comfort_weight = self.config.guess_weight, self.config.comfort_weight
        comfort = self.comfortable_posture(X_WG)
        if self._turns and guess_weight + comfort_weight > 0:
            aim = (guess_weight * q_guess + comfort_weight * comfort) / (guess_weight + comfort_weight)
            found = turn_near(found, aim, self._limits, _SPARE)
        near, ease = ((found - q) ** 2 for q in (q_guess, comfort))
        cost = (guess_weight * near + comfort_weight * ease).sum(axis=1)
        found = found[np.argsort(cost, kind="stable")]
        for _ in range(self.config.attempts):
            if not len(found):
                return None
            q = found[0].clip(self.lower, self.upper)  # a limit is kept up to rounding
            if accept is None or accept(q):
                return q
            found = found[np.abs(found - q).max(axis=1) >= self.config.apart]
        return None

    def travel_times(self, X_WG: FloatArray, q: FloatArray) -> FloatArray:
        """Minimum time in which the arm could bring G to each pose, without regard to acceleration and obstacles.

        Args:
            X_WG: Target poses of G, shape (m, 4, 4).
            q: Joint positions of the arm, shape (n,) [rad].

        Returns:
            Shape (m,) [s], infinite where the arm has no posture.
        """
        free, angles = self._inverse.free, self._grid(self._limits, self.config.travel_step)
        velocity = self.robot.velocity
        turns = np.zeros(1) if free is None else self._distances(angles[:, None], q, [free])[:, 0] / velocity[free]
        order = np.argsort(turns, kind="stable")
        least = np.full(len(X_WG), np.inf)
        X_BG = self._X_BW.GetAsMatrix4() @ X_WG
        for some in np.array_split(order, min(_ROUNDS, len(order))):
            open_ = np.flatnonzero(least > turns[some[0]])  # the free joint alone takes longer from here on
            found, pose = self._inverse.postures(X_BG[open_], angles[some], self._limits)
            np.minimum.at(least, open_[pose], (self._distances(found, q) / velocity).max(axis=1))
        return least

    def _distances(self, found: FloatArray, q: FloatArray, joints: Sequence[int] | slice = slice(None)) -> FloatArray:
        """Distances of some joints of postures from those of q, the shorter way round where there is one [rad]."""
        if self._turns:
            found = turn_near(found, q[joints], self._limits[:, joints])
        distances: FloatArray = np.abs(found - q[joints])
        return distances

    def turning_postures(self, X_WG: RigidTransform) -> FloatArray:
        """Joint positions with G at X_WG, where the limits of the last joint do not count.

        Turning the last joint turns the hand about its own axis and leaves all other links where they are. So these
        postures, with another angle of the last joint, are those of every turn of the hand.

        Returns:
            Shape (m, n) [rad]; all joints but the last are within their limits.
        """
        limits = self._limits_without(-1)
        return self._postures(X_WG, self._grid(limits, self.config.last_step), limits)

    def joints_beyond_limits(self, X_WG: RigidTransform) -> NDArray[np.bool_]:
        """Find the joints beyond their limits, in each posture with G at X_WG that is known when no joint has limits.

        Returns:
            Shape (m, n).
        """
        none = np.tile([[-np.inf], [np.inf]], len(self.lower))
        found = turn_into(self._postures(X_WG, self._grid(none, self.config.last_step), none), self._limits)
        return (found < self.lower - ROUNDING) | (found > self.upper + ROUNDING)

    def is_within_reach(self, radius: FloatArray, height: float) -> NDArray[np.bool_]:
        """Whether the arm, if its first and last joint had no limits, could bring G there with the hand pointing down.

        Args:
            radius: Horizontal distances of G from the axis of the first joint, shape (n,) [m].
            height: Height of G above the arm's base [m].

        Returns:
            Shape (n,).
        """
        zeros = np.zeros(len(radius))
        X_BG = grasps(np.column_stack([radius, zeros, zeros + height, zeros]))
        limits = self._limits_without(0, -1)
        _, pose = self._inverse.postures(X_BG, self._grid(limits, self.config.last_step), limits)
        return np.bincount(pose, minlength=len(radius)) > 0

    def _postures(self, X_WG: RigidTransform, angles: FloatArray, limits: FloatArray) -> FloatArray:
        """Known postures with G at X_WG, shape (m, n) [rad]."""
        return self._inverse.postures((self._X_BW @ X_WG).GetAsMatrix4()[None], angles, limits)[0]

    def _limits_without(self, *joints: int) -> FloatArray:
        """Limits of the joints, infinite for those given, shape (2, n) [rad]."""
        limits = self._limits.copy()
        limits[:, joints] = [[-np.inf], [np.inf]]
        return limits

    def _grid(self, limits: FloatArray, step: float) -> FloatArray:
        return free_angles(self._inverse.free, limits, step)

    def comfortable_posture(self, X_WG: RigidTransform) -> FloatArray:
        """The arm's comfortable posture, turned about its base towards G, shape (n,) [rad]."""
        x, y, _ = self._X_BW @ X_WG.translation()
        return np.clip(self.robot.face(x, y), self.lower, self.upper)

    def line(self, q0: FloatArray, X_WG1: RigidTransform) -> FloatArray | None:
        """Joint positions along the straight line of G from its pose at q0 to X_WG1, shape (m, n) [rad].

        The hand turns evenly when the orientations differ. None when a joint limit or a singularity is in the way.
        """
        key = q0.tobytes(), X_WG1.GetAsMatrix34().tobytes()
        if key not in self._lines:
            self._lines = dict([*self._lines.items()][-_LINES:])
            self._lines[key] = self._line(q0, X_WG1)
        return self._lines[key]

    def _line(self, q0: FloatArray, X_WG1: RigidTransform) -> FloatArray | None:
        X_WG0 = self.forward(q0)
        turn = (X_WG0.rotation().inverse() @ X_WG1.rotation()).ToAngleAxis()
        distance = float(np.linalg.norm(X_WG1.translation() - X_WG0.translation()))
        count = int(np.ceil(max(distance, self.config.line_radius * turn.angle()) / self.config.line_step)) + 2
        qs = [np.asarray(q0)]
        for s in np.linspace(0, 1, count)[1:]:
            q = self._follow(qs[-1] if len(qs) < 2 else 2 * qs[-1] - qs[-2], _interpolate_pose(X_WG0, X_WG1, s))
            if q is None or np.abs(q - qs[-1]).max() > self.config.line_joint_step:
                return None
            qs.append(q)
        path = np.array(qs)
        path.setflags(write=False)
        return path

    def _follow(self, q: FloatArray, X_WG: RigidTransform) -> FloatArray | None:
        """Joint positions near q with G at X_WG, by Newton's method with the least change of the joints, or None."""
        for _ in range(self.config.line_iterations):
            X_WH = self.forward(q)
            rotation = (X_WG.rotation() @ X_WH.rotation().inverse()).ToAngleAxis()
            error = np.append(rotation.angle() * rotation.axis(), X_WG.translation() - X_WH.translation())
            if np.abs(error).max() < self.config.line_tolerance:
                inside = bool(np.all(q >= self.lower) and np.all(q <= self.upper))
                return q if inside else None
            q = q + np.linalg.lstsq(self.jacobian(q), error, rcond=1e-3)[0]
        return None

    def jacobian(self, q: FloatArray) -> FloatArray:
        """Jacobian of G's spatial velocity in W, angular first, shape (6, n)."""
        self.plant.SetPositions(self._context, q)
        world = self.plant.world_frame()
        return np.asarray(
            self.plant.CalcJacobianSpatialVelocity(
                self._context, JacobianWrtVariable.kV, self.grasp, np.zeros(3), world, world
            )
        )


def _interpolate_pose(X_WA: RigidTransform, X_WB: RigidTransform, s: float) -> RigidTransform:
    turn = (X_WA.rotation().inverse() @ X_WB.rotation()).ToAngleAxis()
    turn.set_angle(s * turn.angle())
    position = (1 - s) * X_WA.translation() + s * X_WB.translation()
    return RigidTransform(X_WA.rotation() @ RotationMatrix(turn), position)


@lru_cache(maxsize=16)
def _arm_plant(robot: Robot, base: tuple[float, ...]) -> RobotBodies:
    """Robot in a plant in which only the arm's joints move; frame `target` can be put anywhere.

    Args:
        robot: Robot.
        base: The 12 numbers of X_WB's upper three rows. Arms with the same base share a plant, which never changes.
    """
    plant = MultibodyPlant(0.0)
    X_WB = np.reshape(base, (3, 4))
    bodies = robot.add_to(plant, RigidTransform(RotationMatrix(X_WB[:, :3]), X_WB[:, 3]))
    for actuator in bodies.actuators[len(bodies.arm_joints) :]:
        plant.RemoveJointActuator(actuator)
    for joint in bodies.finger_joints:
        parent, child = joint.frame_on_parent(), joint.frame_on_child()
        plant.RemoveJoint(joint)
        plant.WeldFrames(parent, child)
    plant.AddFrame(FixedOffsetFrame("target", plant.world_frame(), RigidTransform()))
    plant.Finalize()
    return bodies
