"""All constants of motion planning."""

from dataclasses import dataclass
from math import inf

from ictamp_drake.core.checks import check_fields, check_range
from ictamp_drake.motion.inverse_kinematics import KinematicsConfig
from ictamp_drake.motion.paths import PathConfig
from ictamp_drake.motion.trajectory_optimization import LEAST_POINTS, TrajectoryConfig


@dataclass(frozen=True)
class MotionConfig:
    """How motions are planned.

    Attributes:
        kinematics: constants of inverse kinematics.
        trajectory: constants of trajectories.
        path: constants of sampled paths.
        step: longest way of the hand between two collision checks [m].
        turn: largest turn of the hand and of each joint between two collision checks [rad].
        padding: distance from the scene that transfers keep, as far as their ends have it [m].
        held_shrinkage: how much smaller than it is the held box counts on every side [m].
        rise: height above the obstacles in between at which the raised path crosses them [m].
        hand_width: from the hand's way to its outermost part, sideways [m].
        corridors: radii [rad] and numbers of control points tried around a path, one after the other.
        push_rounds: how often a trajectory is pushed out of its collisions.
        push_radius: how far one push may move the control points [rad].
        push_margin: distance demanded beyond the padding [m].
        push_samples: moments of the trajectory at which distances are demanded.
    """

    kinematics: KinematicsConfig = KinematicsConfig()
    trajectory: TrajectoryConfig = TrajectoryConfig()
    path: PathConfig = PathConfig()
    step: float = 0.01
    turn: float = 0.02
    padding: float = 0.005
    held_shrinkage: float = 0.001
    rise: float = 0.03
    hand_width: float = 0.11
    corridors: tuple[tuple[float, int], ...] = ((0.2, 14), (0.1, 18))
    push_rounds: int = 4
    push_radius: float = 0.1
    push_margin: float = 0.01
    push_samples: int = 40

    def __post_init__(self) -> None:
        check_fields(
            self,
            "skills.motion",
            step=(1e-4, 1),
            turn=(1e-4, 1),
            padding=(0, 1),
            held_shrinkage=(0, 0.003),  # something is left of the smallest box
            rise=(0, 10),
            hand_width=(0, 1),
            push_rounds=(0, 1e6),
            push_radius=(0, 10),
            push_margin=(0, 1),
            push_samples=(3, 1e6),
        )
        for radius, points in self.corridors:
            check_range("skills.motion.corridors", radius, 0, inf)
            check_range("skills.motion.corridors", points, LEAST_POINTS, 1000)
