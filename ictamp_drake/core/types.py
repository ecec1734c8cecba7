"""The letters of the paper as types: c, s, a, p, k, and what one run of a skill leaves.

Frames are in names, monogram style: `X_WO` is the pose of O in W, `p_OG` the position of G in O. Metres, radians,
seconds, kilograms. A pose is an array of seven numbers, unit quaternion (w, x, y, z) then position (x, y, z).
"""

from collections.abc import Hashable, Mapping
from dataclasses import dataclass, field
from functools import cached_property
from typing import Generic, NamedTuple, TypeVar

import numpy as np
from numpy.typing import NDArray

from ictamp_drake.core.failures import Failure

FloatArray = NDArray[np.float64]

C = TypeVar("C", bound=Hashable)
"""Type of a configuration: `Configuration` in Drake, anything immutable and comparable in a toy world."""

Parameter = FloatArray
"""k, the parameter of a skill: (x, y, z, yaw) [m, m, m, rad], shape (4,).

Pick: pose of the grasp frame G in the object's upright frame U, whose origin is the box's centre and whose z axis is
the box axis nearest to the world's vertical, pointing up; G's z axis points down, yaw turns G about the vertical.
Place: pose of the bottom centre of the held object in the receptacle's frame T, whose origin is the centre of its top
face; yaw turns the object's upright frame against T's.
"""


class Atom(NamedTuple):
    """Ground atom of the symbolic state, e.g. on(cyan_box, table)."""

    predicate: str
    args: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.predicate}({', '.join(self.args)})"


State = frozenset[Atom]
"""s = H(c), the atoms that hold; whatever is absent is false."""


class Action(NamedTuple):
    """a, a ground high-level action: pick(object, what it stands on) or place(object, receptacle)."""

    name: str
    args: tuple[str, ...]

    def __str__(self) -> str:
        return f"{self.name}({', '.join(self.args)})"


class Obstruction(NamedTuple):
    """A box that is in the way of an action where it stood at first."""

    action: Action
    box: str


@dataclass(frozen=True)
class Skeleton:
    """p = (s_0, a_1, s_1, ..., a_n, s_n), a high-level plan (paper, Problem Formulation).

    Raises:
        ValueError: unless there is exactly one state more than actions.
    """

    states: tuple[State, ...]
    actions: tuple[Action, ...]

    def __post_init__(self) -> None:
        if len(self.states) != len(self.actions) + 1:
            raise ValueError(f"{len(self.actions)} actions need {len(self.actions) + 1} states, not {len(self.states)}")

    def __len__(self) -> int:
        return len(self.actions)

    def suffix(self, start: int) -> "Skeleton":
        """The rest of the plan from its state number `start` on."""
        return Skeleton(self.states[start:], self.actions[start:])


def _freeze(array: FloatArray) -> FloatArray:
    copy = np.array(array, dtype=np.float64)
    copy.setflags(write=False)
    return copy


@dataclass(frozen=True)
class GripperCommand:
    """What the hand is told, in the terms of Franka's own `move` and `grasp` commands.

    Attributes:
        width: distance between the finger pads to go to [m].
        force: grip force of each finger beyond that position [N], 0 to release.
    """

    width: float
    force: float = 0.0


@dataclass(frozen=True, eq=False)
class Configuration:
    """c, everything that the simulator needs to go on. Immutable, picklable, compared bit for bit.

    Attributes:
        q: joint positions, 7 of the arm [rad] and 2 of the fingers [m], shape (9,).
        poses: X_WO of every box by name, each of shape (7,).
        held: the box that the hand grips, or None when it grips nothing.
        gripper: the last command of the hand; by default as far open as the Panda's goes (`models.hand.MAX_OPENING`).
        commanded: last commanded positions of the arm, where the next motion starts [rad], shape (7,); by default those
            of `q`, from which an arm that carries a load differs by a fraction of a milliradian.
        x: complete state of the simulated plant, positions and velocities in its own order, whose quaternions are not
            normalised, shape (n,); None when c was not reached by simulation, and then everything is at rest.
    """

    q: FloatArray
    poses: Mapping[str, FloatArray]
    held: str | None = None
    gripper: GripperCommand = GripperCommand(width=0.08)
    commanded: FloatArray = None  # type: ignore[assignment]
    x: FloatArray | None = None

    def __post_init__(self) -> None:
        object.__setattr__(self, "q", _freeze(self.q))
        object.__setattr__(self, "poses", {name: _freeze(self.poses[name]) for name in sorted(self.poses)})
        object.__setattr__(self, "commanded", _freeze(self.q[:7] if self.commanded is None else self.commanded))
        object.__setattr__(self, "x", None if self.x is None else _freeze(self.x))

    @cached_property
    def _key(self) -> tuple[Hashable, ...]:
        poses = tuple((name, pose.tobytes()) for name, pose in self.poses.items())
        state = None if self.x is None else self.x.tobytes()
        return self.q.tobytes(), poses, self.held, self.gripper, self.commanded.tobytes(), state

    def __eq__(self, other: object) -> bool:
        return isinstance(other, Configuration) and self._key == other._key

    def __hash__(self) -> int:
        return hash(self._key)

    def __reduce__(self) -> tuple[type["Configuration"], tuple[object, ...]]:
        # Arrays would lose their write protection otherwise.
        return Configuration, (self.q, self.poses, self.held, self.gripper, self.commanded, self.x)


@dataclass(frozen=True, eq=False)
class Segment:
    """A piece of a motion: the arm follows a B-spline, or stands still, while the gripper obeys one command.

    Attributes:
        label: what it is for, e.g. "approach", "lower", "grasp".
        duration: [s].
        gripper: the command in force from the segment's start, or from when the one before is obeyed.
        order: order of the B-spline (degree + 1).
        knots: times from the segment's start [s], shape (n + order,).
        control_points: arm joint positions [rad], shape (n, 7); a single row means that the arm stands still there.
        touches: names of the boxes and supports that the arm, or a box in its hand, may touch; empty when it moves
            freely, None when nothing is known. Physics lets everything else sleep, and wakes it if it is touched.
    """

    label: str
    duration: float
    gripper: GripperCommand
    order: int
    knots: FloatArray
    control_points: FloatArray
    touches: frozenset[str] | None = None


Motion = tuple[Segment, ...]
"""The trajectory of one run of a skill, segment after segment, from rest to rest."""


@dataclass(frozen=True, eq=False)
class Recording:
    """What a simulation of a motion went through.

    Attributes:
        times: from its start [s], shape (m,).
        states: of the plant at these times, as in `Configuration.x`, shape (m, n).
    """

    times: FloatArray
    states: FloatArray


@dataclass(frozen=True, eq=False)
class Attempt(Generic[C]):
    """One run of a skill: one low-level step of the search.

    Attributes:
        action: the high-level action that was tried.
        failure: None when the action's promised state was reached.
        successor: c', where the simulation ended; None when nothing was simulated.
        k: the parameter that was executed or refused last; None when none was found.
        motion: what was executed, to its end at rest; empty when nothing was simulated.
        rejections: kinematic failures of the parameters drawn before the last one.
        seconds: computing time by stage [s].
        detail: one sentence more than the failure says.
        obstacles: what the arm or the held box would have touched, by name, once for each parameter refused for that.
        recording: of the simulation, None when nothing was simulated.
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

    @property
    def succeeded(self) -> bool:
        return self.failure is None

    @property
    def tried(self) -> int:
        """Parameters that were looked at."""
        return len(self.rejections) + 1

    @property
    def duration(self) -> float:
        """How long the motion takes to execute [s]."""
        return sum(segment.duration for segment in self.motion)

    @property
    def effort(self) -> float:
        """Computing time of all stages together [s]."""
        return sum(self.seconds.values())
