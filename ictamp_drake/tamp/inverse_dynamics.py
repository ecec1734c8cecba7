"""Torques of the arm's joints along a plan, by inverse dynamics of the arm, its gripper and the box in it."""

from collections.abc import Iterator, Sequence
from functools import lru_cache

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import MultibodyForces, SpatialInertia, UnitInertia

from ictamp_drake.core.types import Attempt, Configuration, FloatArray, Segment
from ictamp_drake.motion.trajectory import Trajectory
from ictamp_drake.robots.bodies import RobotBodies
from ictamp_drake.robots.robot import Robot, find_robot
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.world.poses import to_transform

_STEP = 0.04
"""Longest time between two moments at which torques are computed [s]."""


def torque_shares(spec: SceneSpec, c: Configuration, attempts: Sequence[Attempt[Configuration]]) -> FloatArray:
    """Largest share of each joint's torque limit that each step of a plan uses, shape (steps, n).

    The torques are those that move the arm, the gripper and the held box along the commanded splines, gravity
    included, and the friction of the joints that the model has. Contact with other things does not count.

    Args:
        spec: Scene.
        c: Configuration before the first step.
        attempts: Steps of the plan.
    """
    robot = find_robot(spec.robot)
    dynamics = _Dynamics(robot, to_transform(spec.arm.X_WB))
    shares = np.zeros((len(attempts), len(robot.joints)))
    for number, attempt in enumerate(attempts):
        for segment in attempt.motion:
            dynamics.load(*_held(spec, robot, (c, attempt.successor), attempt, segment))
            torques = np.array([np.abs(each) for each in dynamics.torques(segment)])
            shares[number] = np.maximum(shares[number], (torques / robot.effort).max(axis=0))
        c = attempt.successor or c
    return shares


def _held(
    spec: SceneSpec,
    robot: Robot,
    ends: tuple[Configuration, Configuration | None],
    attempt: Attempt[Configuration],
    segment: Segment,
) -> tuple[float, FloatArray, RigidTransform]:
    """Mass [kg], sides [m] and pose X_GO of the box in the hand; no mass if there is none.

    A hand that presses holds the box that it holds before or after the step. If neither is known, the box's center is
    at G.
    """
    held = next((each for each in ends if each is not None and each.held is not None), None)
    name = attempt.action.args[0] if held is None else held.held
    if segment.gripper.force == 0 or name not in spec.boxes:
        return 0.0, np.ones(3), RigidTransform()
    box, X_GO = spec.boxes[name], RigidTransform()
    if held is not None:
        X_WG = to_transform(spec.arm.X_WB) @ RigidTransform(robot.forward(held.q[None])[0])
        X_GO = X_WG.inverse() @ to_transform(held.poses[name])
    return box.mass, np.array(box.size), X_GO


class _Dynamics:
    """Inverse dynamics of a robot with a load in its hand. Holds one Drake context."""

    def __init__(self, robot: Robot, X_WB: RigidTransform) -> None:
        self._robot = robot
        self._bodies = _loaded_plant(robot, tuple(X_WB.GetAsMatrix34().ravel()))
        self._plant = self._bodies.plant
        self._context = self._plant.CreateDefaultContext()
        self._q, self._v, self._a = (np.zeros(self._plant.num_velocities()) for _ in range(3))

    def load(self, mass: float, size: FloatArray, X_GO: RigidTransform) -> None:
        """Put a box with its mass [kg] and sides [m] at X_GO in the hand."""
        inertia = SpatialInertia(mass, np.zeros(3), UnitInertia.SolidBox(*size))
        inertia = inertia.ReExpress(X_GO.rotation()).Shift(-X_GO.translation())
        self._plant.GetBodyByName(_LOAD).SetSpatialInertiaInBodyFrame(self._context, inertia)

    def torques(self, segment: Segment) -> Iterator[FloatArray]:
        """Torques of the arm's joints along a segment, each of shape (n,) [N m]."""
        arm, plant = self._bodies.arm, self._plant
        self._q[self._bodies.gripper] = self._robot.gripper.positions(segment.gripper.width)
        forces = MultibodyForces(plant)
        for q, v, a in zip(*_moments(segment), strict=True):
            self._q[arm], self._v[arm], self._a[arm] = q, v, a
            plant.SetPositions(self._context, self._q)
            plant.SetVelocities(self._context, self._v)
            plant.CalcForceElementsContribution(self._context, forces)
            torques: FloatArray = plant.CalcInverseDynamics(self._context, self._a, forces)[arm]
            yield torques


_LOAD = "load"
"""Name of the body that stands for the held box."""


def _moments(segment: Segment) -> tuple[FloatArray, FloatArray, FloatArray]:
    """Positions, velocities and accelerations along a segment, each of shape (m, n) [rad, rad/s, rad/s^2]."""
    if len(segment.control_points) == 1:
        return segment.control_points, np.zeros_like(segment.control_points), np.zeros_like(segment.control_points)
    times = np.linspace(0.0, segment.duration, int(np.ceil(segment.duration / _STEP)) + 1)
    return Trajectory(segment.order, segment.knots, segment.control_points).derivatives(times)


@lru_cache(maxsize=4)
def _loaded_plant(robot: Robot, base: tuple[float, ...]) -> RobotBodies:
    """Robot in a plant whose joints move freely, with a body without mass in its hand, whose frame is G.

    Args:
        robot: Robot.
        base: The 12 numbers of X_WB's upper three rows.
    """
    plant = MultibodyPlant(0.0)
    X_WB = np.reshape(base, (3, 4))
    bodies = robot.add_to(plant, RigidTransform(RotationMatrix(X_WB[:, :3]), X_WB[:, 3]))
    load = plant.AddRigidBody(_LOAD, plant.AddModelInstance(_LOAD), SpatialInertia.Zero())
    plant.WeldFrames(bodies.grasp, load.body_frame())
    plant.Finalize()
    return bodies
