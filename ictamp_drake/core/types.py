"""The letters of the paper as types: c, s, a, p, k; and the result of one run of a skill.

Names carry frames in monogram style: `X_WO` is the pose of O in W, `p_OG` the position of G in O. Units are meters,
radians, seconds and kilograms. A pose is an array of seven numbers: unit quaternion (w, x, y, z), then position
(x, y, z).
"""

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Generic, Literal, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from ictamp_drake.core.failures import Failure

FloatArray = NDArray[np.float64]

KinematicsKind = Literal["auto", "closed-form", "analytic", "numeric"]
"""Kind of inverse kinematics, see `robots.choice`."""

C = TypeVar("C", bound=Hashable)
"""Type of a configuration: `Configuration` in Drake, anything immutable and comparable in a toy world."""

Parameter = FloatArray
"""k, the parameter of a skill: (x, y, z, yaw) [m, m, m, rad], shape (4,).

Pick: pose of the grasp frame G in the object's upright frame U. U's origin is the box's center, and its z axis is the
box axis nearest to the world's vertical, pointing up. G's z axis points down, and yaw turns G about the vertical. Where
the pads are not at G, as those of a linkage, the middle between the closed pads takes the place of G's origin.
Place: pose of the bottom center of the held object in the receptacle's frame T, whose origin is the center of its top
face. Yaw turns the object's upright frame relative to T.
"""


class Atom(NamedTuple):
    """Ground atom of the symbolic state, e.g. on(cyan_box, table)."""

    predicate: str
    args: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.predicate}({', '.join(self.args)})"


State = frozenset[Atom]
"""s = H(c), the atoms that hold; absent atoms are false."""


class Action(NamedTuple):
    """a, a ground high-level action: pick(object, what it stands on) or place(object, receptacle)."""

    name: str
    args: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.name}({', '.join(self.args)})"


class Obstruction(NamedTuple):
    """A box that blocks an action from its initial pose."""

    action: Action
    box: str


@dataclass(frozen=True)
class Skeleton:
    """p = (s_0, a_1, s_1, ..., a_n, s_n), a high-level plan (paper, Problem Formulation).

    Raises:
        ValueError: There is not exactly one more state than actions.
    """

    states: tuple[State, ...]
    actions: tuple[Action, ...]

    def __post_init__(self) -> None:
        if len(self.states) != len(self.actions) + 1:
            raise ValueError(f"{len(self.actions)} actions need {len(self.actions) + 1} states, not {len(self.states)}")

    def __len__(self) -> int:
        return len(self.actions)

    def suffix(self, start: int) -> "Skeleton":
        """Return the rest of the plan from its state number `start` on."""
        return Skeleton(self.states[start:], self.actions[start:])


def _freeze(array: FloatArray) -> FloatArray:
    copy = np.array(array, dtype=np.float64)
    copy.setflags(write=False)
    return copy


@dataclass(frozen=True)
class GripperCommand:
    """A command to the hand, in terms of Franka's own `move` and `grasp` commands.

    Attributes:
        width: Distance between the finger pads to move to [m].
        force: Grip force of each finger beyond that position [N], 0 to release.
    """

    width: float
    force: float = 0.0


@dataclass(frozen=True, eq=False)
class Configuration:
    """c, the complete state from which the simulator continues. Immutable, picklable, compared bit for bit.

    Attributes:
        q: Positions of the arm's joints, from the base to the hand [rad], shape (n,).
        fingers: Positions of the joints of the fingers [m or rad], shape (m,).
        poses: Pose X_WO of every box by name, each of shape (7,).
        held: Box that the hand grips, or None when it grips nothing.
        gripper: Last command to the hand; by default closed.
        commanded: Last commanded positions of the arm, where the next motion starts [rad], shape (n,); by default those
            of `q`, from which they differ by a fraction of a milliradian when the arm carries a load.
        x: Complete state of the simulated plant, shape (s,): positions and velocities in the plant's order, with
            quaternions that are not normalized; None when c was not simulated, and then everything is at rest.
    """

    q: FloatArray
    fingers: FloatArray
    poses: Mapping[str, FloatArray]
    held: str | None = None
    gripper: GripperCommand = GripperCommand(width=0.0)
    commanded: FloatArray = None  # type: ignore[assignment]
    x: FloatArray | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "q", _freeze(self.q))
        object.__setattr__(self, "fingers", _freeze(self.fingers))
        object.__setattr__(self, "poses", {name: _freeze(self.poses[name]) for name in sorted(self.poses)})
        object.__setattr__(self, "commanded", _freeze(self.q if self.commanded is None else self.commanded))
        object.__setattr__(self, "x", None if self.x is None else _freeze(self.x))

    @cached_property
    def _key(self) -> tuple[Hashable, ...]:
        poses = tuple((name, pose.tobytes()) for name, pose in self.poses.items())
        state = None if self.x is None else self.x.tobytes()
        joints = self.q.tobytes(), self.fingers.tobytes(), self.commanded.tobytes()
        return *joints, poses, self.held, self.gripper, state

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Configuration) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)

    def __reduce__(self) -> tuple[type["Configuration"], tuple[object, ...]]:
        # Arrays would lose their write protection otherwise.
        return Configuration, (self.q, self.fingers, self.poses, self.held, self.gripper, self.commanded, self.x)


@dataclass(frozen=True, eq=False)
class Segment:
    """A piece of a motion: the arm follows a B-spline, or stands still, while the gripper obeys one command.

    Attributes:
        label: Purpose of the segment, e.g. "approach", "lower", "grasp".
        duration: Duration of the segment [s].
        gripper: Command to the hand, given at the segment's start or once the previous command is obeyed.
        order: Order of the B-spline (degree + 1).
        knots: Times from the segment's start [s], shape (n + order,).
        control_points: Joint positions of the arm [rad], shape (n, joints); a single row means that the arm stands
            still.
        touches: Names of the boxes and supports that the arm, or a box in its hand, may touch; empty when it moves
            freely, None when nothing is known. Physics lets everything else sleep, and wakes it when touched.
    """

    label: str
    duration: float
    gripper: GripperCommand
    order: int
    knots: FloatArray
    control_points: FloatArray
    touches: frozenset[str] | None = None


Motion = tuple[Segment, ...]
"""Trajectory of one run of a skill, segment after segment, from rest to rest."""


@dataclass(frozen=True, eq=False)
class Recording:
    """States during the simulation of a motion.

    Attributes:
        times: Times from the start of the motion [s], shape (m,).
        states: States of the plant at these times, as in `Configuration.x`, shape (m, s).
    """

    times: FloatArray
    states: FloatArray


@dataclass(frozen=True, eq=False)
class Attempt(Generic[C]):
    """One run of a skill: one low-level step of the search.

    Attributes:
        action: High-level action that was tried.
        failure: Cause of the failure; None when the action's promised state was reached.
        successor: Configuration c' in which the simulation ended; None when nothing was simulated.
        k: Parameter that was executed, or the last one refused; None when none was found.
        motion: Executed motion, until everything is at rest; empty when nothing was simulated.
        rejections: Kinematic failures of the parameters drawn before the last one.
        seconds: Computing time by stage [s].
        detail: Sentence that adds to the failure; may be empty.
        obstacles: Names of what the arm or the held box would have touched, one for each parameter refused for that.
        recording: Recording of the simulation; None when nothing was simulated.
        unreached: Poses of G at which the arm has no posture, one for each parameter refused for that, shape (7,) each.
    """

    action: Action
    failure: Failure | None
    successor: C | None = None
    k: Parameter | None = None
    motion: Motion = ()
    rejections: tuple[Failure, ...] = ()
    seconds: Mapping[str, float] = field(default_factory=dict)
    detail: str = ""
    obstacles: tuple[str, ...] = ()
    recording: Recording | None = None
    unreached: tuple[FloatArray, ...] = ()

    @property
    def succeeded(self) -> bool:
        return self.failure is None

    @property
    def tried(self) -> int:
        """Number of parameters that were tried."""
        return len(self.rejections) + 1

    @property
    def duration(self) -> float:
        """Time that the motion takes to execute [s]."""
        return sum(segment.duration for segment in self.motion)

    @property
    def effort(self) -> float:
        """Total computing time of all stages [s]."""
        return sum(self.seconds.values())
