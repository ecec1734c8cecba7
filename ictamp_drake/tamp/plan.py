"""`plan.yaml`: a plan with everything needed to execute it without this package."""

import tempfile
import webbrowser
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import yaml
from pydrake.trajectories import Trajectory

from ictamp_drake.core.decoding import decode, mapping
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.files import write_whole
from ictamp_drake.core.reading import in_file, parse, read_text
from ictamp_drake.core.types import Action, Attempt, Configuration, GripperCommand, Segment
from ictamp_drake.models.hand import MAX_OPENING
from ictamp_drake.scenes.spec import SceneSpec, to_yaml
from ictamp_drake.symbolic.goals import parse_goal
from ictamp_drake.tamp.replay import Replay, duration, replay
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.commands import arm_trajectory
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.world import World

if TYPE_CHECKING:
    from ictamp_drake.tamp.playback import PlanSystem

FORMAT = 2
"""Format of the written files. Files of format 1 lack `commanded`, `x` and `touches`, and can still be read."""

HEADER = """\
# A plan for a Franka Emika Panda with its hand, found and executed in simulation. Metres, radians, seconds, newtons.
#
# format      of this file
# scene       the scene's file. Supports stand still; "position" is the center of a support's TOP face and of a box.
# initial     the start, at rest. q: 7 arm joints, then 2 fingers [m]. poses: of each box's center in the world frame,
#             unit quaternion w, x, y, z, then x, y, z. commanded: the 7 arm joints as they were commanded last, where
#             the first segment begins; from then on each begins where the one before ends, at rest. x: the complete
#             state of the simulator, for the same execution bit for bit. held: the box in the hand, null for none.
#             gripper: the command that is in force, as in a segment.
# skeleton    the high-level plan.
# steps       one for each action, to be executed without a pause between them:
#   action    pick(object, what it stands on) or place(object, receptacle)
#   k         x, y, z, yaw. Pick: the grasp in the object's upright frame (origin in the box's center, z is the box
#             axis nearest to the vertical, pointing up). Place: the bottom center of the held object in the
#             receptacle's frame (origin in the center of its top face).
#   segments  one after the other:
#     label           what it is for
#     start           time from the start of the plan
#     duration        how long it takes; the next segment starts when it is over
#     gripper         commanded at the segment's start, or as soon as the command before is obeyed, and in force from
#                     then on. width: distance between the finger pads, to which each finger moves at 0.05 m/s. force:
#                     grip force of each finger, built up within 0.05 s when the fingers have arrived; 0 lets go, before
#                     the fingers move.
#     order           of the arm's B-spline (degree + 1)
#     knots           its knots, time from the segment's start; the first and last are as often repeated as `order` says
#     control_points  its control points, positions of the 7 arm joints; a single one means that the arm stands still
#     touches         the boxes and supports that the arm or the box in its hand may touch meanwhile; null if unknown
"""


@dataclass(frozen=True, eq=False)
class Plan:
    """A plan that was executed in simulation: skills with their parameters and motions.

    Attributes:
        spec: Scene of the plan.
        c: Initial configuration c_0.
        attempts: Runs of the skills in order, each with action, k and motion.
    """

    spec: SceneSpec
    c: Configuration
    attempts: tuple[Attempt[Configuration], ...]

    @property
    def actions(self) -> tuple[Action, ...]:
        """High-level actions of the plan."""
        return tuple(attempt.action for attempt in self.attempts)

    @property
    def duration(self) -> float:
        """Total time of the motions, without pauses in between [s]."""
        return duration(self.attempts)

    def __len__(self) -> int:
        return len(self.attempts)

    def __str__(self) -> str:
        return "\n".join(map(str, self.actions))

    def trajectory(self) -> Trajectory:
        """Return the commanded joint positions of the arm [rad], shape (7, 1), from time 0 to `duration`, C² in time.

        The commands of the hand are in the segments of each attempt's motion.

        Raises:
            ValueError: The plan is empty.
        """
        return arm_trajectory([segment for attempt in self.attempts for segment in attempt.motion])

    def system(self) -> "PlanSystem":
        """Return a Drake system that plays the plan in a diagram of one's own. Its class documents the output ports.

        Raises:
            IctampError: An action of the plan is not applicable after those before it.
        """
        from ictamp_drake.tamp.playback import PlanSystem  # noqa: PLC0415  (imports this module)

        return PlanSystem(self)

    def replay(self, physics: PhysicsConfig | None = None) -> Replay:
        """Execute the plan in a new simulator, by default with the default options."""
        world = World(self.spec)
        return replay(
            (physics or PhysicsConfig()).create(world),
            abstraction=SceneAbstraction(world),
            goal=parse_goal(self.spec.goal, sorted(self.spec.boxes), sorted(self.spec.supports)),
            c=self.c,
            attempts=self.attempts,
        )

    def show(self, path: Path | str | None = None, *, browser: bool = True) -> Path:
        """Write the plan's replay as a page, and open it in a browser.

        Args:
            path: File of the page; by default a temporary file.
            browser: Whether to open the page.

        Returns:
            File of the page, which needs neither network nor server.
        """
        from ictamp_drake.tamp.pages import write_replay  # noqa: PLC0415  (drawing modules take long to load)

        page = Path(path) if path else Path(tempfile.mkdtemp(prefix="ictamp-")) / "replay.html"
        write_replay(self, page)
        if browser:
            webbrowser.open(page.absolute().as_uri())
        return page

    def save(self, path: Path | str) -> None:
        """Write the plan as YAML, with everything needed to execute it without this package; see `load`."""
        write_plan(self, Path(path))

    @classmethod
    def load(cls, path: Path | str) -> "Plan":
        """Read a plan that `save` wrote.

        Raises:
            IctampError: The file cannot be read or is not a plan.
        """
        return read_plan(Path(path))


def write_plan(plan: Plan, path: Path) -> None:
    """Write the file, which appears whole or not at all. Numbers are read back exactly."""
    content = {
        "format": FORMAT,
        "scene": yaml.safe_load(to_yaml(plan.spec)),
        "initial": {
            "q": plan.c.q.tolist(),
            "poses": {name: pose.tolist() for name, pose in plan.c.poses.items()},
            "commanded": plan.c.commanded.tolist(),
            "x": None if plan.c.x is None else plan.c.x.tolist(),
            "held": plan.c.held,
            "gripper": {"width": float(plan.c.gripper.width), "force": float(plan.c.gripper.force)},
        },
        "skeleton": [str(attempt.action) for attempt in plan.attempts],
        "steps": _steps(plan.attempts),
    }
    text = yaml.dump(content, Dumper=yaml.CSafeDumper, sort_keys=False, default_flow_style=None, width=120)
    write_whole(path, HEADER + text)


def read_plan(path: Path) -> Plan:
    """Read a plan back.

    Raises:
        IctampError: The file cannot be read or is not a plan.
    """
    with in_file(path):
        content = mapping(parse(read_text(path)))
        version = content.get("format", FORMAT)
        if version not in (1, FORMAT):
            raise IctampError(
                Code.OTHER_VERSION, f"expected 1 or {FORMAT}, got {{value}}", field="format", value=version
            )
        found = decode(_File, content)
    return Plan(found.scene, found.initial.configuration(), tuple(step.attempt() for step in found.steps))


_Seven = tuple[float, float, float, float, float, float, float]
"""Joint positions of the arm, or a pose."""


@dataclass(frozen=True)
class _Start:
    """Entry `initial` of the file."""

    q: tuple[float, ...]
    poses: dict[str, _Seven]
    commanded: _Seven | None = None
    x: tuple[float, ...] | None = None
    held: str | None = None
    gripper: GripperCommand = GripperCommand(MAX_OPENING)  # plans of earlier versions start with an open hand

    def __post_init__(self) -> None:
        if len(self.q) != 9:
            raise IctampError(Code.WRONG_LENGTH, "expected nine numbers, got {value}", field="q", value=self.q)

    def configuration(self) -> Configuration:
        poses = {name: np.array(pose) for name, pose in self.poses.items()}
        commanded = None if self.commanded is None else np.array(self.commanded)
        x = None if self.x is None else np.array(self.x)
        return Configuration(np.array(self.q), poses, self.held, self.gripper, commanded, x)  # type: ignore[arg-type]


@dataclass(frozen=True)
class _Segment:
    """One of the `segments` of a step in the file."""

    label: str
    start: float
    duration: float
    gripper: GripperCommand
    order: int
    knots: tuple[float, ...]
    control_points: tuple[_Seven, ...]
    touches: tuple[str, ...] | None = None

    def segment(self) -> Segment:
        return Segment(
            label=self.label,
            duration=self.duration,
            gripper=self.gripper,
            order=self.order,
            knots=np.array(self.knots),
            control_points=np.array(self.control_points),
            touches=None if self.touches is None else frozenset(self.touches),
        )


@dataclass(frozen=True)
class _Step:
    """One of the `steps` in the file."""

    action: str
    k: tuple[float, ...] | None
    segments: tuple[_Segment, ...]

    def attempt(self) -> Attempt[Configuration]:
        name, _, arguments = self.action.removesuffix(")").partition("(")
        motion = tuple(segment.segment() for segment in self.segments)
        k = None if self.k is None else np.array(self.k)
        return Attempt(Action(name, tuple(arguments.split(", "))), None, k=k, motion=motion)


@dataclass(frozen=True, kw_only=True)
class _File:
    """The whole file."""

    format: int
    scene: SceneSpec
    initial: _Start
    skeleton: tuple[str, ...] = ()
    steps: tuple[_Step, ...]


def _steps(attempts: Sequence[Attempt[Configuration]]) -> list[dict[str, Any]]:
    steps = []
    start = 0.0
    for attempt in attempts:
        segments = []
        for segment in attempt.motion:
            segments.append(_segment_to_dict(segment, start))
            start += segment.duration
        k = None if attempt.k is None else attempt.k.tolist()
        steps.append({"action": str(attempt.action), "k": k, "segments": segments})
    return steps


def _segment_to_dict(segment: Segment, start: float) -> dict[str, Any]:
    return {
        "label": segment.label,
        "start": start,
        "duration": float(segment.duration),
        "gripper": {"width": float(segment.gripper.width), "force": float(segment.gripper.force)},
        "order": segment.order,
        "knots": segment.knots.tolist(),
        "control_points": segment.control_points.tolist(),
        "touches": None if segment.touches is None else sorted(segment.touches),
    }
