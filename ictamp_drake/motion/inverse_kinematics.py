"""The arm alone: forward kinematics, inverse kinematics, straight lines of the hand."""

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.multibody.inverse_kinematics import InverseKinematics
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import FixedOffsetFrame, JacobianWrtVariable
from pydrake.solvers import SnoptSolver

from ictamp_drake.core.types import FloatArray
from ictamp_drake.models import add_package
from ictamp_drake.models.constants import ARM_LIMITS, DH_PARAMETERS, FINGER_JOINTS, FLANGE_OFFSET, GRASP_OFFSET, HOME
from ictamp_drake.world.build import PANDA_URL

LOWER: FloatArray = np.array([limits.lower for limits in ARM_LIMITS])
UPPER: FloatArray = np.array([limits.upper for limits in ARM_LIMITS])

_SHOULDER, _UPPER_ARM, _ELBOW, _FOREARM, _WRIST = DH_PARAMETERS[0], *DH_PARAMETERS[2:5], DH_PARAMETERS[6]
_REACH = float(np.hypot(_UPPER_ARM.d, _ELBOW.a) + np.hypot(_FOREARM.a, _FOREARM.d) + _WRIST.a)
"""Largest distance of link 7's frame from the shoulder [m]."""


@dataclass(frozen=True)
class KinematicsConfig:
    """How inverse kinematics is solved.

    Attributes:
        position_tolerance: of G, along each axis [m].
        angle_tolerance: of G [rad].
        joint_margin: distance kept from the joint limits [rad].
        guess_weight: cost of the distance from the guess; larger gives solutions nearer to it.
        comfort_weight: cost of the distance from the arm's comfortable configuration.
        attempts: guesses tried, the given one, the comfortable one and random ones.
        spread: of the random guesses about the comfortable configuration, as part of the joint ranges.
        line_step: longest step of the hand along a straight line [m]; turns count as `line_radius` times the angle.
        line_radius: [m].
        line_joint_step: longest change of a joint within one step; more is a jump to another posture [rad].
        line_iterations: Newton steps for one point of the line.
    """

    position_tolerance: float = 1e-4
    angle_tolerance: float = 1e-3
    joint_margin: float = 0.02
    guess_weight: float = 1.0
    comfort_weight: float = 0.1
    attempts: int = 6
    spread: float = 0.35
    line_step: float = 0.02
    line_radius: float = 0.1
    line_joint_step: float = 0.3
    line_iterations: int = 8


class ArmKinematics:
    """Kinematics of the arm on its base, nothing around it. Holds one Drake context and one program."""

    def __init__(self, X_WB: RigidTransform, config: KinematicsConfig | None = None) -> None:
        self.config = config or KinematicsConfig()
        self.plant = _arm_plant(X_WB)
        self._X_BW = X_WB.inverse()
        self._context = self.plant.CreateDefaultContext()
        self._grasp = self.plant.GetFrameByName("grasp")
        self._target = self.plant.GetFrameByName("target")
        self.lower = LOWER + self.config.joint_margin
        self.upper = UPPER - self.config.joint_margin
        self._build_program()

    def _build_program(self) -> None:
        tolerance = np.full(3, self.config.position_tolerance)
        self._program = InverseKinematics(self.plant, self._context, with_joint_limits=False)
        q = self._program.q()
        self._program.AddPositionConstraint(self._grasp, np.zeros(3), self._target, -tolerance, tolerance)
        identity = RotationMatrix()
        self._program.AddOrientationConstraint(
            self._target, identity, self._grasp, identity, self.config.angle_tolerance
        )
        self._program.prog().AddBoundingBoxConstraint(self.lower, self.upper, q)
        self._cost = self._program.prog().AddQuadraticErrorCost(np.eye(7), HOME, q).evaluator()
        self._solver = SnoptSolver()

    def forward(self, q: FloatArray) -> RigidTransform:
        """X_WG at the arm's joint positions q, shape (7,) [rad]."""
        self.plant.SetPositions(self._context, q)
        return self.plant.CalcRelativeTransform(self._context, self.plant.world_frame(), self._grasp)

    def solve(
        self,
        X_WG: RigidTransform,
        q_guess: FloatArray,
        rng: np.random.Generator,
        *,
        attempts: int | None = None,
        accept: Callable[[FloatArray], bool] | None = None,
    ) -> FloatArray | None:
        """Joint positions that bring G to X_WG, near q_guess and comfortable, shape (7,) [rad], or None.

        Args:
            X_WG: where G shall be.
            q_guess: where the search starts first, shape (7,) [rad].
            rng: draws the further starts.
            attempts: how many starts; the configuration's number by default.
            accept: what a solution must satisfy besides, e.g. to be free of collisions.
        """
        if not self.may_reach(X_WG):
            return None
        self._target.SetPoseInParentFrame(self._context, X_WG)
        comfort = self.comfortable(X_WG)
        spread = self.config.spread * (UPPER - LOWER)
        for attempt in range(attempts or self.config.attempts):
            guess = q_guess if attempt == 0 else comfort if attempt == 1 else comfort + rng.uniform(-spread, spread)
            q = self._solve_from(np.clip(guess, self.lower, self.upper), comfort)
            if q is not None and (accept is None or accept(q)):
                return q
        return None

    def comfortable(self, X_WG: RigidTransform) -> FloatArray:
        """The arm's comfortable configuration turned about its base towards G, shape (7,) [rad]."""
        x, y, _ = self._X_BW @ X_WG.translation()
        return np.clip(np.append(np.arctan2(y, x), HOME[1:]), self.lower, self.upper)

    def _solve_from(self, guess: FloatArray, comfort: FloatArray) -> FloatArray | None:
        near, ease = self.config.guess_weight, self.config.comfort_weight
        self._cost.UpdateCoefficients(2 * (near + ease) * np.eye(7), -2 * (near * guess + ease * comfort))
        result = self._solver.Solve(self._program.prog(), guess)
        return np.clip(result.get_x_val(), self.lower, self.upper) if result.is_success() else None

    def may_reach(self, X_WG: RigidTransform) -> bool:
        """False when the arm's links are too short for X_WG whatever the angles."""
        p_B7 = self._X_BW @ X_WG @ np.array([0.0, 0.0, -FLANGE_OFFSET - GRASP_OFFSET])
        return float(np.linalg.norm(p_B7 - [0.0, 0.0, _SHOULDER.d])) <= _REACH

    def line(self, q0: FloatArray, X_WG1: RigidTransform) -> FloatArray | None:
        """Joint positions along the straight line of G from where q0 holds it to X_WG1, shape (m, 7) [rad].

        The hand turns evenly when the orientations differ. None when a joint limit or a singularity is in the way.
        """
        X_WG0 = self.forward(q0)
        turn = (X_WG0.rotation().inverse() @ X_WG1.rotation()).ToAngleAxis()
        distance = float(np.linalg.norm(X_WG1.translation() - X_WG0.translation()))
        count = int(np.ceil(max(distance, self.config.line_radius * turn.angle()) / self.config.line_step)) + 2
        qs = [np.asarray(q0)]
        for s in np.linspace(0, 1, count)[1:]:
            q = self._follow(qs[-1] if len(qs) < 2 else 2 * qs[-1] - qs[-2], _between(X_WG0, X_WG1, s))
            if q is None or np.abs(q - qs[-1]).max() > self.config.line_joint_step:
                return None
            qs.append(q)
        return np.array(qs)

    def _follow(self, q: FloatArray, X_WG: RigidTransform) -> FloatArray | None:
        """Newton's method with the least change of the joints."""
        for _ in range(self.config.line_iterations):
            X_WH = self.forward(q)
            rotation = (X_WG.rotation() @ X_WH.rotation().inverse()).ToAngleAxis()
            error = np.append(rotation.angle() * rotation.axis(), X_WG.translation() - X_WH.translation())
            if np.abs(error).max() < self.config.position_tolerance:
                inside = bool(np.all(q >= self.lower) and np.all(q <= self.upper))
                return q if inside else None
            q = q + np.linalg.lstsq(self.jacobian(q), error, rcond=1e-3)[0]
        return None

    def jacobian(self, q: FloatArray) -> FloatArray:
        """Of G's spatial velocity in W, angular first, shape (6, 7)."""
        self.plant.SetPositions(self._context, q)
        world = self.plant.world_frame()
        return np.asarray(
            self.plant.CalcJacobianSpatialVelocity(
                self._context, JacobianWrtVariable.kV, self._grasp, np.zeros(3), world, world
            )
        )


def _between(X_WA: RigidTransform, X_WB: RigidTransform, s: float) -> RigidTransform:
    turn = (X_WA.rotation().inverse() @ X_WB.rotation()).ToAngleAxis()
    turn.set_angle(s * turn.angle())
    position = (1 - s) * X_WA.translation() + s * X_WB.translation()
    return RigidTransform(X_WA.rotation() @ RotationMatrix(turn), position)


def _arm_plant(X_WB: RigidTransform) -> MultibodyPlant:
    """The seven joints only: the fingers are welded, and frame `target` can be put anywhere."""
    plant = MultibodyPlant(0.0)
    parser = Parser(plant)
    add_package(parser)
    parser.AddModelsFromUrl(PANDA_URL)
    plant.WeldFrames(plant.world_frame(), plant.GetFrameByName("panda_link0"), X_WB)
    for constraint in plant.GetConstraintIds():
        plant.RemoveConstraint(constraint)
    fingers = [plant.GetJointByName(name) for name in FINGER_JOINTS]
    for index in plant.GetJointActuatorIndices():
        actuator = plant.get_joint_actuator(index)
        if actuator.joint().name() in FINGER_JOINTS:
            plant.RemoveJointActuator(actuator)
    for joint in fingers:
        parent, child = joint.frame_on_parent(), joint.frame_on_child()
        plant.RemoveJoint(joint)
        plant.WeldFrames(parent, child)
    plant.AddFrame(FixedOffsetFrame("target", plant.world_frame(), RigidTransform()))
    plant.Finalize()
    return plant
