"""Checks of a plan that was read: what passes can be executed, and nothing in it contradicts anything else."""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from itertools import pairwise
from typing import Any

import numpy as np

from ictamp_drake.core.checks import POSITIVE, check_choice, check_count, check_range, check_vector
from ictamp_drake.core.errors import Code, IctampError, join_fields, show
from ictamp_drake.core.types import Action, Attempt, Configuration, FloatArray, GripperCommand, Segment, State
from ictamp_drake.robots.robot import Robot, find_robot
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.tamp.symbols import kinds_of

MAX_DURATION = 600.0
"""Longest duration of a segment [s]."""
MAX_ORDER = 20
"""Highest order of a spline."""
JOINT_TOLERANCE = 1e-3
"""Distance by which the arm may be beyond its joint limits [rad]."""
FINGER_TOLERANCE = 2e-3
"""Distance by which a finger may be beyond its limits in a simulated state [m]."""
MAX_LAG = 0.02
"""Largest difference between the arm's positions and its commanded ones at the start [rad]."""
MAX_JUMP = {1: 2e-3, 2: 1e-6, 3: 1e-6}
"""Largest jump of commanded positions between segments by the format of the file [rad]. Plans of format 1 planned each
skill from where the arm was, and not from where it was commanded to be."""
END_SPEED = 1e-3
"""Largest speed of a joint that counts as rest at the ends of a segment [rad/s]."""
QUATERNION_TOLERANCE = 1e-6
"""Largest deviation of a quaternion's length from 1."""
MAX_SPEED = 10.0
"""Highest speed of a simulated body or joint at the start [m/s, rad/s]."""
NUMBER_TOLERANCE = 1e-6
"""Largest difference of a number from what follows from the rest of the file."""


@contextmanager
def within(field: str) -> Iterator[None]:
    """Put the path of a field in front of errors of a block."""
    try:
        yield
    except IctampError as error:
        error.add_field(field)
        raise


def check_configuration(c: Configuration, spec: SceneSpec) -> None:
    """Raise IctampError unless arm, hand and boxes are somewhere where they can be."""
    robot = find_robot(spec.robot)
    _check_joints("q", c.q, robot)
    places, tolerance = robot.gripper.places, FINGER_TOLERANCE * (1 if robot.gripper.shares is not None else 10)
    if not ((c.fingers >= places.min(axis=0) - tolerance) & (c.fingers <= places.max(axis=0) + tolerance)).all():
        problem = "expected positions of the fingers within their limits, got {value}"
        raise IctampError(Code.OUT_OF_RANGE, problem, field="q", value=c.fingers.tolist())
    for name in [name for name in c.poses if name not in spec.boxes]:
        check_choice(f"poses.{name}", name, spec.boxes)
    for name in spec.boxes:
        if name not in c.poses:
            raise IctampError(Code.MISSING_FIELD, "missing field", field=f"poses.{name}")
        check_vector(f"poses.{name}", c.poses[name][4:].tolist(), -100, 100, " m")
        length = float(np.linalg.norm(c.poses[name][:4]))
        if not abs(length - 1) <= QUATERNION_TOLERANCE:
            problem = "expected a unit quaternion w, x, y, z, then a position x, y, z, got {value}"
            raise IctampError(Code.OUT_OF_RANGE, problem, field=f"poses.{name}", value=c.poses[name].tolist())
    if c.held is not None:
        check_choice("held", c.held, spec.boxes)
    with within("gripper"):
        check_command(c.gripper, robot)


def check_start(c: Configuration, spec: SceneSpec) -> None:
    """Raise IctampError unless execution can start from c."""
    check_configuration(c, spec)
    _check_joints("commanded", c.commanded, find_robot(spec.robot))
    if np.abs(c.commanded - c.q).max() > MAX_LAG:
        problem = f"expected positions within {MAX_LAG} rad of q, got {{value}}"
        raise IctampError(Code.CONFLICT, problem, field="commanded", value=c.commanded.tolist())
    if c.x is None:
        return
    arm, boxes = len(c.q), len(spec.boxes)
    joints = arm + len(c.fingers)
    _check_length("x", c.x, 2 * joints + 13 * boxes)
    check_vector("x", c.x.tolist(), -100, 100, count=None)
    check_vector("x", c.x[joints + 7 * boxes :].tolist(), -MAX_SPEED, MAX_SPEED, count=None)
    poses = [c.x[joints + 7 * number :][:7] for number in range(boxes)]
    found = {name: _normalized(pose) for name, pose in zip(sorted(spec.boxes), poses, strict=True)}
    q, fingers = np.split(c.x[find_robot(spec.robot).places], [arm])
    if Configuration(q, fingers, found) != Configuration(c.q, c.fingers, c.poses):
        problem = "expected the positions of q and poses, exactly as they are there"
        raise IctampError(Code.CONFLICT, problem, field="x")


def _normalized(pose: FloatArray) -> FloatArray:
    with np.errstate(all="ignore"):
        return np.concatenate([pose[:4] / np.linalg.norm(pose[:4]), pose[4:]])


def check_command(command: GripperCommand, robot: Robot) -> None:
    """Raise IctampError unless the hand can obey the command."""
    check_range("width", command.width, 0, robot.gripper.opening, " m")
    check_range("force", command.force, 0, robot.gripper.force, " N")


def check_segment(segment: Segment, spec: SceneSpec) -> None:
    """Raise IctampError unless the arm can follow the segment, from rest to rest."""
    points, order, knots, robot = segment.control_points, segment.order, segment.knots, find_robot(spec.robot)
    check_range("duration", segment.duration, POSITIVE, MAX_DURATION, " s")
    with within("gripper"):
        check_command(segment.gripper, robot)
    if not len(points):
        raise IctampError(Code.EMPTY, "expected at least one", field="control_points")
    for number, q in enumerate(points):
        _check_joints(f"control_points[{number}]", q, robot)
    moves = len(points) > 1
    check_range("order", order, 4 if moves else 1, MAX_ORDER if moves else 1)
    if order > len(points):
        problem = f"expected at least {order} points for a spline of order {order}, got {{value}}"
        raise IctampError(Code.WRONG_LENGTH, problem, field="control_points", value=points.tolist())
    _check_length("knots", knots, len(points) + order)
    check_vector("knots", knots.tolist(), 0, segment.duration + 1e-9, " s", count=None)
    clamped = max(np.abs(knots[:order]).max(), np.abs(knots[-order:] - segment.duration).max()) <= 1e-9
    if not clamped or (np.diff(knots) < 0).any():
        problem = f"expected ascending times, {order} times 0 first and {order} times the duration last, got {{value}}"
        raise IctampError(Code.CONFLICT, problem, field="knots", value=knots.tolist())
    if moves:
        _check_speeds(points, knots, order, robot)
    for number, name in enumerate(sorted(segment.touches or ())):
        check_choice(f"touches[{number}]", name, [*spec.boxes, *spec.supports])


def _check_length(field: str, values: FloatArray, length: int) -> None:
    if len(values) != length:
        problem = f"expected {length} numbers, got {len(values)}"
        raise IctampError(Code.WRONG_LENGTH, problem, field=field, value=values.tolist())


def _check_joints(field: str, q: FloatArray, robot: Robot) -> None:
    _check_length(field, q, len(robot.joints))
    if not ((q >= robot.lower - JOINT_TOLERANCE) & (q <= robot.upper + JOINT_TOLERANCE)).all():
        problem = "expected positions within the joint limits, got {value}"
        raise IctampError(Code.OUT_OF_RANGE, problem, field=field, value=q.tolist())


def _check_speeds(points: FloatArray, knots: FloatArray, order: int, robot: Robot) -> None:
    speeds = _derive(points, knots, order)
    if not (np.abs(speeds[[0, -1]]) <= END_SPEED).all():
        raise IctampError(Code.CONFLICT, "expected the arm at rest at both ends", field="control_points")
    accelerations = _derive(speeds, knots[1:-1], order - 1)
    for values, limits, what in (
        (speeds, robot.velocity, "velocity"),
        (accelerations, robot.acceleration, "acceleration"),
    ):
        if not (np.abs(values) <= limits).all():
            problem = f"expected a motion within the {what} limits of the joints"
            raise IctampError(Code.OUT_OF_RANGE, problem, field="control_points")


def _derive(points: FloatArray, knots: FloatArray, order: int) -> FloatArray:
    """Return the control points of a spline's derivative; not all are finite when knots coincide where none may."""
    widths = knots[order:-1] - knots[1:-order]
    with np.errstate(all="ignore"):
        derived: FloatArray = (order - 1) * np.diff(points, axis=0) / widths[:, None]
    return derived


def check_continuity(c: Configuration, attempts: Sequence[Attempt[Configuration]], version: int) -> None:
    """Raise IctampError unless each segment begins where the one before ends, the first where the arm was commanded."""
    ends = [("", c.commanded, c.commanded)]
    for number, attempt in enumerate(attempts):
        for index, segment in enumerate(attempt.motion):
            points = segment.control_points
            ends.append((f"steps[{number}].segments[{index}].control_points[0]", points[0], points[-1]))
    for (_, _, before), (field, after, _) in pairwise(ends):
        jump = float(np.abs(after - before).max())
        if jump > MAX_JUMP[version]:
            problem = "expected the positions where the arm was commanded to be before, got {value}"
            raise IctampError(Code.CONFLICT, problem, field=field, value=after.tolist())


def check_states(spec: SceneSpec, initial: State, actions: Sequence[Action], found: Sequence[State | None]) -> None:
    """Raise IctampError unless each action can be done in its state and leads to the next one.

    Args:
        spec: Scene of the plan.
        initial: Atoms that hold at the start.
        actions: Actions of the plan.
        found: Atoms that hold after each action; None where they are not known.
    """
    used = {argument for action in actions for argument in action.args}
    with within("initial.poses"):
        boxes, places = (sorted(used & names.keys()) for names in (spec.boxes, spec.places))
        domain = Domain.create(boxes, places, initial, kinds_of(spec))
    state = initial
    for number, (action, after) in enumerate(zip(actions, found, strict=True)):
        try:
            state = domain.successor(state, action)
        except ValueError as error:
            problem = "{value} cannot be done in the state before it"
            raise IctampError(Code.CONFLICT, problem, field=f"steps[{number}].action", value=str(action)) from error
        if after is not None and after != state:
            problem = "expected the state that the action leads to; {value} differ"
            different = sorted(map(str, after ^ state))
            raise IctampError(Code.CONFLICT, problem, field=f"steps[{number}].expected", value=different)


def check_action(action: Action, spec: SceneSpec) -> None:
    """Raise IctampError unless the action names a skill, a box, and what it stands on or goes to."""
    check_choice("action", action.name, ("pick", "place"))
    check_count("action", action.args, 2, 2)
    box, place = action.args
    check_choice("action", box, spec.boxes)
    check_choice("action", place, [name for name in (*spec.places, *spec.boxes) if name != box])


def check_derived(given: object, derived: object, field: str, *, complete: bool) -> None:
    """Raise IctampError where a value differs from the one that follows from the rest of the file.

    Args:
        given: Value in the file.
        derived: Value that follows.
        field: Path of the value.
        complete: Whether every value that follows must be there.
    """
    if isinstance(derived, Mapping) and isinstance(given, Mapping):
        for key in given.keys() - derived.keys():
            raise IctampError(Code.UNKNOWN_FIELD, "unknown field", field=join_fields(field, str(key)))
        for key, value in derived.items():
            if key in given:
                check_derived(given[key], value, join_fields(field, key), complete=complete)
            elif complete:
                raise IctampError(Code.MISSING_FIELD, "missing field", field=join_fields(field, key))
    elif isinstance(derived, list) and isinstance(given, list) and len(derived) == len(given):
        for number, (one, other) in enumerate(zip(given, derived, strict=True)):
            check_derived(one, other, f"{field}[{number}]", complete=complete)
    elif not _is_same(given, derived):
        problem = f"expected {show(derived)}, which follows from the rest of the file, got {{value}}"
        raise IctampError(Code.CONFLICT, problem, field=field, value=given)


def _is_same(given: Any, derived: Any) -> bool:
    if isinstance(derived, bool) or not isinstance(derived, int | float) or np.isinf(derived):
        return type(given) is type(derived) and bool(given == derived)
    try:
        return not isinstance(given, bool) and abs(float(given) - derived) <= NUMBER_TOLERANCE
    except (TypeError, ValueError, OverflowError):
        return False
