"""All constants of motion planning."""

from dataclasses import dataclass
from math import inf

from ictamp_drake.core.checks import check_fields, check_range

LEAST_POINTS = 7
"""Control points that a spline has at least: three at each end do not move."""

MIN_DURATION = 1e-3
"""Least duration of a trajectory [s]."""


@dataclass(frozen=True)
class KinematicsConfig:
    """How inverse kinematics is solved.

    Attributes:
        joint_margin: distance kept from the joint limits [rad].
        last_step: between the angles of the last joint at which postures are looked at [rad].
        travel_step: the same when only the time to a posture is asked for [rad].
        guess_weight: cost of the distance from the guess; larger gives solutions nearer to it.
        comfort_weight: cost of the distance from the arm's comfortable configuration.
        attempts: postures tried, the cheapest first.
        apart: least difference of a joint between those tried [rad].
        line_step: longest step of the hand along a straight line [m]; turns count as `line_radius` times the angle.
        line_radius: [m].
        line_tolerance: of G's position along each axis [m] and of its direction [rad].
        line_joint_step: longest change of a joint within one step; more is a jump to another posture [rad].
        line_iterations: Newton steps for one point of the line.
    """

    joint_margin: float = 0.02
    last_step: float = 0.05
    travel_step: float = 0.1
    guess_weight: float = 1.0
    comfort_weight: float = 0.1
    attempts: int = 12
    apart: float = 0.3
    line_step: float = 0.02
    line_radius: float = 0.1
    line_tolerance: float = 1e-4
    line_joint_step: float = 0.3
    line_iterations: int = 8

    def __post_init__(self) -> None:
        check_fields(
            self,
            "skills.motion.kinematics",
            joint_margin=(0, 1),
            last_step=(1e-3, 6),
            travel_step=(1e-3, 6),
            guess_weight=(0, 1e6),
            comfort_weight=(0, 1e6),
            attempts=(1, 1e6),
            apart=(0, 6),
            line_step=(1e-4, 1),
            line_radius=(0, 10),
            line_tolerance=(1e-9, 0.1),
            line_joint_step=(1e-3, 6),
            line_iterations=(1, 1e4),
        )


@dataclass(frozen=True)
class PathConfig:
    """How a path is searched.

    Attributes:
        margin: how far joints may go beyond the range between start and end [rad].
        edge: longest edge of the trees [rad].
        step: distance between checked points of an edge [rad].
        max_checks: configurations checked before the search gives up.
        shortcuts: attempts to shorten the path found.
    """

    margin: float = 0.8
    edge: float = 0.6
    step: float = 0.05
    max_checks: int = 4000
    shortcuts: int = 30

    def __post_init__(self) -> None:
        check_fields(
            self,
            "skills.motion.path",
            margin=(1e-3, 10),
            edge=(1e-3, 10),
            step=(1e-3, min(self.margin, 1)),  # OMPL wants it shorter than the diagonal of the range
            max_checks=(0, 1e9),
            shortcuts=(0, 1e6),
        )


@dataclass(frozen=True)
class TrajectoryConfig:
    """How fast and how finely.

    Attributes:
        velocity: used part of the joints' velocity limits.
        acceleration: used part of the joints' acceleration limits.
        jerk: used part of the joints' jerk limits.
        order: of the splines; 5 has continuous jerk.
        control_points: of a spline between two points.
        straightness: cost of leaving the guess [s/rad^2]; larger keeps idle joints quieter.
        max_duration: greatest duration that the solver considers [s]; what it can't improve on may take longer.
        iterations: of the solver; what it has then is used.
    """

    velocity: float = 0.7
    acceleration: float = 0.5
    jerk: float = 0.1
    order: int = 5
    control_points: int = 14
    straightness: float = 0.1
    max_duration: float = 60.0
    iterations: int = 40

    def __post_init__(self) -> None:
        check_fields(
            self,
            "skills.motion.trajectory",
            velocity=(1e-3, 1),
            acceleration=(1e-3, 1),
            jerk=(1e-3, 1),
            order=(4, LEAST_POINTS),
            control_points=(LEAST_POINTS, 1000),
            straightness=(0, 1e6),
            max_duration=(MIN_DURATION, 1e6),
            iterations=(0, 1e6),
        )


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
            check_range("a radius of skills.motion.corridors", radius, 0, inf)
            check_range("a number of points of skills.motion.corridors", points, LEAST_POINTS, 1000)
