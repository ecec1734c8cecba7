"""Reading of plan.yaml: a plan that can be executed, or an error that names what is wrong."""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from ictamp_drake.core.checks import check_vector
from ictamp_drake.core.decoding import decode, mapping
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.reading import in_file, parse, read_text
from ictamp_drake.core.types import Action, Attempt, Configuration, FloatArray, GripperCommand, Segment
from ictamp_drake.robots.robot import find_robot
from ictamp_drake.scenes.spec import SceneSpec, locate_robot
from ictamp_drake.tamp.plan_checks import (
    check_action,
    check_configuration,
    check_continuity,
    check_derived,
    check_segment,
    check_start,
    check_states,
    within,
)
from ictamp_drake.tamp.plan_file import FORMAT, plan_content, predicates_of
from ictamp_drake.tamp.plan_origin import Origin
from ictamp_drake.tamp.symbols import goal_of
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.start import check_overlaps
from ictamp_drake.world.world import World

FORMATS = (1, 2, FORMAT)
"""Formats that are read. Format 1 lacks `commanded`, `x` and `touches`, and formats 1 and 2 what surrounds the motion:
robot, bodies, and what is expected after each step."""

_Pose = tuple[float, float, float, float, float, float, float]


class Parts(NamedTuple):
    """Parts of a plan, in the order of `Plan`."""

    spec: SceneSpec
    c: Configuration
    attempts: tuple[Attempt[Configuration], ...]
    origin: Origin | None


def read_parts(path: Path) -> Parts:
    """Read and check the parts of a plan.

    Raises:
        IctampError: The file cannot be read, is not a plan, or contradicts itself.
    """
    with in_file(path):
        content = mapping(parse(read_text(path)))
        version = content.get("format", FORMAT)
        if isinstance(version, bool) or version not in FORMATS:
            problem = f"expected {', '.join(map(str, FORMATS[:-1]))} or {FORMAT}, got {{value}}"
            raise IctampError(Code.OTHER_VERSION, problem, field="format", value=version)
        found = decode(_File, content)
        found = replace(found, scene=_locate_robot(found.scene, path.parent))
        parts = _check_parts(found)
        _check_whole(content, parts, found.format)
    return parts


def _locate_robot(spec: SceneSpec, folder: Path) -> SceneSpec:
    """Return the scene with the path of its robot file, which may be relative to the folder of the plan.

    Raises:
        IctampError: There is no such robot, or its file or models are not valid.
    """
    robot = locate_robot(spec.robot, folder)
    find_robot(robot)
    return replace(spec, robot=robot)


def _check_parts(found: "_File") -> Parts:
    """Return the parts of the plan, each of which is sound by itself."""
    spec = found.scene
    with within("scene"):
        goal_of(spec)
    with within("initial"):
        c = found.initial.configuration(spec)
        check_start(c, spec)
    attempts = []
    for number, step in enumerate(found.steps):
        with within(f"steps[{number}]"):
            attempts.append(step.attempt(spec))
    check_continuity(c, attempts, found.format)
    return Parts(spec, c, tuple(attempts), found.origin)


def _check_whole(content: Mapping[str, object], parts: Parts, version: int) -> None:
    """Raise IctampError when parts of the plan contradict each other."""
    spec, c, attempts, origin = parts
    world = World(spec)
    check_overlaps(world, c, "initial.poses")
    abstraction = SceneAbstraction(world, predicates_of(origin))
    ends = [None if attempt.successor is None else abstraction(attempt.successor) for attempt in attempts]
    check_states(spec, abstraction(c), [attempt.action for attempt in attempts], ends)
    derived = plan_content(spec, c, attempts, origin, abstraction)
    for key in ("scene", "origin"):
        del derived[key]
    given = {key: value for key, value in content.items() if key in derived}
    if version < FORMAT:
        derived = {key: derived[key] for key in ("initial", "skeleton", "steps")}
        given = {key: value for key, value in given.items() if key in derived}
    else:
        del derived["format"], given["format"]
    check_derived(given, derived, "", complete=version == FORMAT)


@dataclass(frozen=True)
class _Moment:
    """A configuration in the file; what follows from the other fields is compared with them later."""

    q: tuple[float, ...]
    poses: dict[str, _Pose]
    held: str | None = None
    width: Any = None
    load: Any = None
    poses_in_base: Any = None
    atoms: Any = None

    def arrays(self, spec: SceneSpec) -> tuple[FloatArray, FloatArray, dict[str, FloatArray]]:
        """Return positions of the arm and of the fingers, and poses of the boxes."""
        robot = find_robot(spec.robot)
        count = len(robot.joints) + len(robot.gripper.joints)
        if len(self.q) != count:
            raise IctampError(Code.WRONG_LENGTH, f"expected {count} numbers, got {{value}}", field="q", value=self.q)
        q, fingers = np.split(np.array(self.q), [len(robot.joints)])
        return q, fingers, {name: np.array(pose) for name, pose in self.poses.items()}


@dataclass(frozen=True)
class _Start(_Moment):
    """Entry `initial` of the file."""

    commanded: tuple[float, ...] | None = None
    x: tuple[float, ...] | None = None
    gripper: GripperCommand | None = None

    def configuration(self, spec: SceneSpec) -> Configuration:
        """Return the configuration; plans of earlier versions start with an open hand."""
        q, fingers, poses = self.arrays(spec)
        gripper = self.gripper or GripperCommand(find_robot(spec.robot).gripper.opening)
        commanded = None if self.commanded is None else np.array(self.commanded)
        x = None if self.x is None else np.array(self.x)
        return Configuration(q, fingers, poses, self.held, gripper, commanded, x)  # type: ignore[arg-type]


@dataclass(frozen=True)
class _Segment:
    """One of the `segments` of a step in the file."""

    label: str
    start: float
    duration: float
    gripper: GripperCommand
    order: int
    knots: tuple[float, ...]
    control_points: tuple[tuple[float, ...], ...]
    touches: tuple[str, ...] | None = None

    def segment(self) -> Segment:
        for number, point in enumerate(self.control_points):
            if len(point) != (joints := len(self.control_points[0])):
                problem, field = f"expected {joints} numbers, got {{value}}", f"control_points[{number}]"
                raise IctampError(Code.WRONG_LENGTH, problem, field=field, value=point)
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
    k: tuple[float, float, float, float]
    segments: tuple[_Segment, ...]
    expected: _Moment | None = None

    def attempt(self, spec: SceneSpec) -> Attempt[Configuration]:
        """Return the step, which is sound by itself."""
        name, _, arguments = self.action.removesuffix(")").partition("(")
        action = Action(name, tuple(arguments.split(", ")))
        check_action(action, spec)
        check_vector("k", self.k, -100, 100, count=None)
        if not self.segments:
            raise IctampError(Code.EMPTY, "expected at least one", field="segments")
        motion = []
        for number, each in enumerate(self.segments):
            with within(f"segments[{number}]"):
                motion.append(each.segment())
                check_segment(motion[-1], spec)
        return Attempt(action, None, self._end(motion[-1], spec), np.array(self.k), tuple(motion))

    def _end(self, last: Segment, spec: SceneSpec) -> Configuration | None:
        if self.expected is None:
            return None
        with within("expected"):
            q, fingers, poses = self.expected.arrays(spec)
        c = Configuration(q, fingers, poses, self.expected.held, last.gripper, last.control_points[-1])
        with within("expected"):
            check_configuration(c, spec)
        return c


@dataclass(frozen=True, kw_only=True)
class _File:
    """The whole file. What follows from the scene is compared with it later."""

    format: int
    units: Any = None
    origin: Origin | None = None
    robot: Any = None
    contact: Any = None
    bodies: Any = None
    scene: SceneSpec
    initial: _Start
    skeleton: tuple[str, ...] = ()
    steps: tuple[_Step, ...]
