"""Constants of motion planning."""

from dataclasses import dataclass
from math import inf

from ictamp_drake.core.checks import check_fields, check_range
from ictamp_drake.core.types import KinematicsKind

LEAST_POINTS = 7
"""Minimum number of control points of a spline: three at each end do not move."""

MIN_DURATION = 1e-3
"""Minimum duration of a trajectory [s]."""


@dataclass(frozen=True)
class KinematicsConfig:
    """Constants of inverse kinematics.

    Attributes:
        kind: Kind of inverse kinematics: the closed form of the Panda, analytic for most arms of six or seven joints,
            numeric for any arm, or the first of these that serves (auto).
        starts: Number of starts for each pose, numeric kind only.
        joint_margin: Distance kept from the joint limits [rad].
        last_step: Grid step over the free joint for postures, the last of a Panda [rad].
        travel_step: Grid step over the free joint for travel times [rad].
        guess_weight: Weight of the squared distance from the guess. A larger weight gives solutions nearer to it.
        comfort_weight: Weight of the squared distance from the arm's comfortable posture.
        attempts: Maximum number of postures tried, the cheapest first.
        apart: Minimum difference between postures tried, in at least one joint [rad].
        line_step: Longest step of the hand along a straight line [m]. Turns count as `line_radius` times the angle.
        line_radius: Lever arm that converts hand rotation to distance [m].
        line_tolerance: Tolerance of G's position along each axis [m] and of its rotation about each axis [rad].
        line_joint_step: Largest change of a joint within one step [rad]. More is a jump to another posture.
        line_iterations: Maximum number of Newton steps for one point of the line.
    """

    kind: KinematicsKind = "auto"
    starts: int = 64
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
            starts=(1, 1e4),
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
    """Constants of the search for a path.

    Attributes:
        margin: Distance that joints may go beyond the range between start and end [rad].
        edge: Longest edge of the trees [rad].
        step: Distance between checked points of an edge [rad].
        max_checks: Number of configurations checked before the search gives up.
        shortcuts: Number of attempts to shorten the path found.
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
            step=(1e-3, min(self.margin, 1)),  # OMPL needs it shorter than the diagonal of the range
            max_checks=(0, 1e9),
            shortcuts=(0, 1e6),
        )


@dataclass(frozen=True)
class TrajectoryConfig:
    """Constants of the speed and resolution of trajectories.

    Attributes:
        velocity: Fraction of the joints' velocity limits that is used.
        acceleration: Fraction of the joints' acceleration limits that is used.
        jerk: Fraction of the joints' jerk limits that is used.
        order: Order of the splines. With 5, jerk is continuous.
        control_points: Number of control points of a spline between two points.
        straightness: Weight of the mean squared distance from the guess [s/rad^2]. A larger one keeps idle joints
            quieter.
        max_duration: Longest duration that the solver considers [s]. A guess that it cannot improve may take longer.
        iterations: Maximum number of solver iterations, after which the result so far is used.
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
class CarryingConfig:
    """Constants of the speed at which a box is carried.

    Attributes:
        reserve: Minimum ratio of the load that the friction of the fingers can bear to the load of the moving box. A
            motion with a lower ratio is slowed down.
        slide: Longest slide of a held box in the fingers that the time step of physics may cause in one motion [m]. A
            motion with a longer slide is slowed down.
    """

    reserve: float = 1.25
    slide: float = 0.01

    def __post_init__(self) -> None:
        check_fields(self, "skills.motion.carrying", reserve=(1e-3, 100), slide=(1e-4, 1))


@dataclass(frozen=True)
class MotionConfig:
    """Constants of motion planning.

    Attributes:
        kinematics: Constants of inverse kinematics.
        trajectory: Constants of trajectories.
        path: Constants of sampled paths.
        carrying: Constants of the speed at which a box is carried.
        step: Longest motion of the hand between two collision checks [m].
        turn: Largest turn of the hand and of each joint between two collision checks [rad].
        padding: Distance that transfers keep from the scene, or less if their ends are nearer [m].
        held_shrinkage: Length by which the held box counts as smaller on every side [m].
        rise: Height above the obstacles in between at which the raised path crosses them [m].
        hand_width: Sideways distance from the hand's path to its outermost part [m].
        corridors: Radius [rad] and number of control points of each corridor tried around a path, in this order.
        push_rounds: Maximum number of times that a trajectory is pushed out of its collisions.
        push_radius: Largest change of each coordinate of a control point in one push [rad].
        push_margin: Distance demanded beyond the padding [m].
        push_samples: Number of moments of a trajectory, counting its ends, at which distances are demanded.
    """

    kinematics: KinematicsConfig = KinematicsConfig()
    trajectory: TrajectoryConfig = TrajectoryConfig()
    path: PathConfig = PathConfig()
    carrying: CarryingConfig = CarryingConfig()
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
            held_shrinkage=(0, 0.003),  # leaves something of the smallest box
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
