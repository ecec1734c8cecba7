"""Published numbers of a Franka Emika Panda with its hand, from which its model is written.

Limits and Denavit-Hartenberg parameters are those of Franka's control interface documentation ("Robot and interface
specifications"). Masses and inertias of the arm are the parameters identified by Gaz, Cognetti, Oliva, Robuffo Giordano
and De Luca, "Dynamic Identification of the Franka Emika Panda Robot With Retrieval of Feasible Parameters Using
Penalty-Based Optimization", IEEE RA-L 4(4), 2019; those of the hand are Franka's default load data.
"""

import math
from typing import NamedTuple

from ictamp_drake.models.sdf_text import Inertial


class JointLimits(NamedTuple):
    """Limits of one joint: position [rad], velocity [rad/s], acceleration [rad/s^2], jerk [rad/s^3], torque [Nm]."""

    lower: float
    upper: float
    velocity: float
    acceleration: float
    jerk: float
    effort: float


class JointFrame(NamedTuple):
    """Craig's Denavit-Hartenberg parameters of one joint: a_{i-1} [m], d_i [m], alpha_{i-1} [rad]."""

    a: float
    d: float
    alpha: float


ARM_JOINTS = tuple(f"panda_joint{i}" for i in range(1, 8))
FINGER_JOINTS = ("panda_finger_joint1", "panda_finger_joint2")

ARM_LIMITS = (
    JointLimits(-2.8973, 2.8973, 2.1750, 15.0, 7500.0, 87.0),
    JointLimits(-1.7628, 1.7628, 2.1750, 7.5, 3750.0, 87.0),
    JointLimits(-2.8973, 2.8973, 2.1750, 10.0, 5000.0, 87.0),
    JointLimits(-3.0718, -0.0698, 2.1750, 12.5, 6250.0, 87.0),
    JointLimits(-2.8973, 2.8973, 2.6100, 15.0, 7500.0, 12.0),
    JointLimits(-0.0175, 3.7525, 2.6100, 20.0, 10000.0, 12.0),
    JointLimits(-2.8973, 2.8973, 2.6100, 20.0, 10000.0, 12.0),
)

DH_PARAMETERS = (
    JointFrame(0.0, 0.333, 0.0),
    JointFrame(0.0, 0.0, -math.pi / 2),
    JointFrame(0.0, 0.316, math.pi / 2),
    JointFrame(0.0825, 0.0, math.pi / 2),
    JointFrame(-0.0825, 0.384, -math.pi / 2),
    JointFrame(0.0, 0.0, math.pi / 2),
    JointFrame(0.088, 0.0, math.pi / 2),
)
FLANGE_OFFSET = 0.107
"""Distance of the flange `panda_link8` from `panda_link7` along z [m]."""

INERTIALS = {
    "panda_link0": Inertial(
        0.629769, (-0.041018, -0.00014, 0.049974), (0.00315, 0.00388, 0.004285, 8.2904e-7, 0.00015, 8.2299e-6)
    ),
    "panda_link1": Inertial(
        4.970684, (0.003875, 0.002081, -0.04762), (0.70337, 0.70661, 0.009117, -0.000139, 0.006772, 0.019169)
    ),
    "panda_link2": Inertial(
        0.646926, (-0.003141, -0.02872, 0.003495), (0.007962, 0.02811, 0.025995, -0.003925, 0.010254, 0.000704)
    ),
    "panda_link3": Inertial(
        3.228604, (0.027518, 0.039252, -0.066502), (0.037242, 0.036155, 0.01083, -0.004761, -0.011396, -0.012805)
    ),
    "panda_link4": Inertial(
        3.587895, (-0.05317, 0.104419, 0.027454), (0.025853, 0.019552, 0.028323, 0.007796, -0.001332, 0.008641)
    ),
    "panda_link5": Inertial(
        1.225946, (-0.011953, 0.041065, -0.038437), (0.035549, 0.029474, 0.008627, -0.002117, -0.004037, 0.000229)
    ),
    "panda_link6": Inertial(
        1.666555, (0.060149, -0.014117, -0.010517), (0.001964, 0.004354, 0.005433, 0.000109, -0.001158, 0.000341)
    ),
    "panda_link7": Inertial(
        0.735522, (0.010517, -0.004252, 0.061597), (0.012516, 0.010027, 0.004815, -0.000428, -0.001196, -0.000741)
    ),
    "panda_hand": Inertial(0.73, (-0.01, 0.0, 0.03), (0.001, 0.0025, 0.0017, 0.0, 0.0, 0.0)),
    "panda_leftfinger": Inertial(0.015, (0.0, 0.0, 0.0), (2.375e-6, 2.375e-6, 7.5e-7, 0.0, 0.0, 0.0)),
    "panda_rightfinger": Inertial(0.015, (0.0, 0.0, 0.0), (2.375e-6, 2.375e-6, 7.5e-7, 0.0, 0.0, 0.0)),
}

MAX_GRIP_FORCE = 70.0
"""Maximum continuous force of each finger [N]."""
MAX_FINGER_SPEED = 0.05
"""Maximum speed of each finger [m/s]."""

JOINT_DAMPING = 0.5
"""Viscous friction of the arm's joints [Nm s/rad]."""
FINGER_DAMPING = 5.0
"""Viscous friction of the fingers [N s/m]."""

HAND_ANGLE = -math.pi / 4
"""Rotation of the hand relative to the flange about z [rad]."""
GRASP_OFFSET = 0.1034
"""Distance of G from the flange along z [m]."""
FINGER_OFFSET = 0.0584
"""Distance of the finger frames from the flange along z [m]."""

MAX_OPENING = 0.08
"""Distance between the pads of the open hand [m]."""

PAD_HALF_WIDTH = 0.01
"""Half width of a pad along the finger frame's x [m]."""
PAD_HALF_HEIGHT = 0.0095
"""Half height of a pad along the finger frame's z, which is the distance of the finger tips below G [m]."""
PAD_THICKNESS = 0.0155
"""Thickness of finger and pad, measured outwards from the gripping face, the finger frame's plane y = 0 [m]."""
PAD_CENTER = GRASP_OFFSET - FINGER_OFFSET
"""Distance of the pad's center from the finger frame along z, which puts it at G [m]."""
