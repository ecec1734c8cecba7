"""Constants of physics and of the predicates. Knows no Drake, so that the help of a program comes at once."""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING, Literal

import numpy as np

from ictamp_drake.core.checks import check_fields, check_range, check_vector
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import FloatArray

if TYPE_CHECKING:
    from ictamp_drake.robots.robot import Robot
    from ictamp_drake.world.simulate import Physics
    from ictamp_drake.world.world import World


@dataclass(frozen=True)
class PredicateConfig:
    """Tolerances of the predicates.

    Attributes:
        contact: Largest distance between touching surfaces [m]. A finger deeper than this in a box does not grip it.
        tilt: Largest tilt of a level box [rad].
        slope: Largest angle between the normal of a carrying contact and the vertical [rad].
    """

    contact: float = 0.0015
    tilt: float = 0.15
    slope: float = 0.3

    def __post_init__(self) -> None:
        check_fields(self, "predicates", contact=(1e-4, 0.02), tilt=(1e-3, 1), slope=(1e-3, 1.5))


@dataclass(frozen=True)
class PhysicsConfig:
    """Settings of the simulation.

    Attributes:
        time_step: Time step of the discrete plant [s].
        contact_approximation: Approximation of contact that Drake's discrete solver uses.
        arm_stiffness: Stiffness of the controller of each joint [Nm/rad]. A stiffer arm follows the motion more
            closely. If empty, the stiffness in the robot's file.
        arm_damping: Damping of the controller of each joint [Nm s/rad]. If empty, the damping in the robot's file.
        finger_stiffness: Stiffness of the controller of each finger [N/m]. By default that in the robot's file.
        finger_damping: Damping of the controller of each finger [N s/m]. By default that in the robot's file.
        rest_speed: Largest speed of a box at rest [m/s].
        rest_turn: Largest angular speed of a box at rest [rad/s].
        settle_time: Longest wait for rest after a motion [s].
        settle_check: Time between two checks for rest [s].
        min_pad_force: Smallest force of each finger on a held object, normal and friction together [N].
        record_period: Time between two recorded states, and between two checks for contact with sleeping boxes [s].
        sleep: Whether boxes at rest are simulated only where the arm may touch them, or touch what they rest or lean
            on. Otherwise the whole scene is simulated all the time.
    """

    time_step: float = 0.004
    contact_approximation: Literal["lagged", "sap", "similar", "tamsi"] = "sap"
    arm_stiffness: tuple[float, ...] = ()
    arm_damping: tuple[float, ...] = ()
    finger_stiffness: float | None = None
    finger_damping: float | None = None
    rest_speed: float = 2e-3
    rest_turn: float = 2e-2
    settle_time: float = 2.0
    settle_check: float = 0.05
    min_pad_force: float = 1.0
    record_period: float = 1 / 30
    sleep: bool = True

    def __post_init__(self) -> None:
        check_fields(
            self,
            "physics",
            time_step=(1e-5, 0.1),
            rest_speed=(1e-6, 10),
            rest_turn=(1e-6, 100),
            settle_time=(1e-3, 1e3),
            settle_check=(1e-3, 10),
            min_pad_force=(1e-3, 1e3),
            record_period=(1e-3, 1e3),
        )
        check_vector("physics.arm-stiffness", self.arm_stiffness, 1e-3, 1e9, count=None)
        check_vector("physics.arm-damping", self.arm_damping, 0, 1e9, count=None)
        if self.finger_stiffness is not None:
            check_range("physics.finger-stiffness", self.finger_stiffness, 1e-3, 1e9)
        if self.finger_damping is not None:
            check_range("physics.finger-damping", self.finger_damping, 0, 1e9)

    def create(self, world: "World") -> "Physics":
        """A simulator of the scene.

        Raises:
            IctampError: The number of gains is not that of the arm's joints, or joints of the hand follow others, which
                Drake's solver tamsi does not know.
        """
        from ictamp_drake.world.simulate import Physics

        gripper = world.robot.gripper
        if self.contact_approximation == "tamsi" and len(gripper.driven) < len(gripper.joints):
            problem = f"{{value}} does not work with the hand of {world.robot.name}, some of whose joints follow others"
            field, advice = "physics.contact-approximation", "choose sap, similar or lagged"
            raise IctampError(Code.CONFLICT, problem, field=field, value="tamsi", advice=advice)
        return Physics(world, self)

    def gains(self, robot: "Robot") -> tuple[FloatArray, FloatArray]:
        """Stiffness and damping of the controllers, each of shape (commanded,) [N m/rad or N/m, N m s/rad or N s/m].

        Those of the arm's joints come first, then those of the driven joints of the fingers.

        Raises:
            IctampError: The number of values is not that of the arm's joints.
        """
        fingers = robot.gripper.gains(self.finger_stiffness, self.finger_damping)
        arm = (self.arm_stiffness or robot.spec.stiffness, self.arm_damping or robot.spec.damping)
        for name, values in zip(("stiffness", "damping"), arm, strict=True):
            if len(values) != len(robot.joints):
                problem = f"expected {len(robot.joints)} numbers for the joints of {robot.name}, got {{value}}"
                raise IctampError(Code.WRONG_LENGTH, problem, field=f"physics.arm-{name}", value=values)
        return np.concatenate([arm[0], fingers[0]]), np.concatenate([arm[1], fingers[1]])

    def steps(self, seconds: float) -> int:
        """Number of time steps that last at least so long; what sums of durations are rounded by adds none."""
        return math.ceil(seconds / self.time_step - 1e-6)
