"""Measures of a robot that follow from its model: motion of the fingers, size of the hand, links that always touch."""

from collections.abc import Mapping
from typing import TYPE_CHECKING, NamedTuple

import numpy as np
from pydrake.math import RigidTransform
from pydrake.planning import RobotDiagramBuilder

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import FloatArray
from ictamp_drake.robots.alone import Alone
from ictamp_drake.robots.bodies import RobotBodies
from ictamp_drake.robots.hand import Cylinder, Hand, Outline, Row
from ictamp_drake.robots.model_files import Mimic
from ictamp_drake.robots.spec import GripperSpec

if TYPE_CHECKING:
    from ictamp_drake.robots.robot import Robot

_STEPS = 101
"""Number of positions of the fingers at which they are measured."""
_MEETING = 0.002
"""Largest distance between the pads of closed fingers that counts as closed [m]."""
_TINY = 1e-6
"""Change of a joint for derivatives [rad or m]."""
_POSTURES = 200
"""Number of random postures in which links are tested for contact with each other."""


class Moves(NamedTuple):
    """Movement of the fingers from closed to open, in the order of `Gripper`."""

    widths: FloatArray
    places: FloatArray
    rises: FloatArray
    pulls: FloatArray


def measure_fingers(bodies: RobotBodies, spec: GripperSpec, mimics: Mapping[str, Mimic]) -> Moves:
    """Measure how the fingers move between the limits of the driven joints.

    Args:
        bodies: Robot in a plant whose joints move freely.
        spec: Gripper.
        mimics: Joints that follow others, by name.

    Raises:
        IctampError: The fingers do not open as far as the file says, do not close, or a driven joint has no limits.
    """
    fingers = _Fingers(bodies, mimics)
    ends = _find_ends(bodies, spec, fingers)
    shares = np.linspace(0.0, 1.0, _STEPS)[:, None]
    driven = (1 - shares) * ends[:, 0] + shares * ends[:, 1]
    pads = np.array([fingers.pads(each) for each in driven])
    widths = pads[:, 0, 1] - pads[:, 1, 1]
    if np.any(np.diff(widths) <= 0):  # a hand that opens again beyond the place where it is closed
        start = int(np.argmin(widths))
        driven, pads, widths = driven[start:], pads[start:], widths[start:]
    if len(widths) < 2 or widths[-1] < spec.opening - 1e-6:
        problem = f"expected at most the opening of the model, {max(widths):.4g} m, got {{value}}"
        raise IctampError(Code.OUT_OF_RANGE, problem, field="gripper.opening", value=spec.opening)
    if widths[0] > _MEETING:
        problem = f"the pads do not meet: they are {1000 * widths[0]:.1f} mm apart when the hand is closed"
        raise IctampError(Code.CONFLICT, problem, field="gripper.pads")
    places = np.array([fingers.places(each) for each in driven])
    pulls = np.array([fingers.pulls(each) for each in driven])
    rises = np.round(pads[:, :, 2].mean(axis=1), 9) + 0.0
    return Moves(np.maximum(widths, 0.0), places, rises, np.round(pulls, 6))


def _find_ends(bodies: RobotBodies, spec: GripperSpec, fingers: "_Fingers") -> FloatArray:
    """Return the positions of the driven joints in the closed and in the open hand, shape (driven, 2) [rad or m]."""
    ends = np.array([[joint.position_lower_limit(), joint.position_upper_limit()] for joint in bodies.driven])
    if not np.all(np.isfinite(ends)):
        number = int(np.argmin(np.isfinite(ends).all(axis=1)))
        problem = "expected a joint with position limits, got {value}"
        raise IctampError(Code.OUT_OF_RANGE, problem, field=f"gripper.joints[{number}]", value=spec.joints[number])
    for number, (lower, upper) in enumerate(ends):
        low, high = np.tile(ends.mean(axis=1), (2, 1))
        low[number], high[number] = lower, upper
        if fingers.width(low) > fingers.width(high):  # its lower limit is that of the open hand
            ends[number] = upper, lower
    return ends


class _Fingers:
    """Places of the pads in G at positions of the driven joints."""

    def __init__(self, bodies: RobotBodies, mimics: Mapping[str, Mimic]) -> None:
        names = [joint.name() for joint in bodies.finger_joints]
        driven = [names.index(joint.name()) for joint in bodies.driven]
        self._bodies, self._names, self._driven = bodies, names, driven
        self._followers = [
            (number, names.index(mimic.leader), mimic)
            for number, name in enumerate(names)
            if (mimic := mimics.get(name)) and number not in driven and mimic.leader in names
        ]
        self._context = bodies.plant.CreateDefaultContext()

    def places(self, driven: FloatArray) -> FloatArray:
        """Positions of all joints of the fingers, shape (driven,) -> (joints,)."""
        places = np.zeros(len(self._names))
        places[self._driven] = driven
        for number, leader, mimic in self._followers:
            places[number] = mimic.multiplier * places[leader] + mimic.offset
        return places

    def pads(self, driven: FloatArray) -> FloatArray:
        """Positions in G of the centers of both gripping faces, shape (driven,) -> (2, 3) [m]."""
        plant = self._bodies.plant
        q = np.zeros(plant.num_positions())
        q[self._bodies.gripper] = self.places(driven)
        plant.SetPositions(self._context, q)
        grasp = self._bodies.grasp
        poses = [plant.CalcRelativeTransform(self._context, grasp, face) for face in self._bodies.faces]
        return np.array([X.translation() for X in poses])

    def pulls(self, driven: FloatArray) -> FloatArray:
        """Change of each pad's distance from the other by each driven joint, shape (driven,) -> (driven, 2)."""
        steps = [(self.pads(driven + d) - self.pads(driven - d)) / (2 * _TINY) for d in _TINY * np.eye(len(driven))]
        return np.array([step[:, 1] * [1, -1] for step in steps])

    def width(self, driven: FloatArray) -> float:
        """Distance between the pads along G's y axis [m]."""
        first, second = self.pads(driven)
        return float(first[1] - second[1])


def measure_hand(robot: "Robot", moves: Moves) -> Hand:
    """Return the measures of the hand, those of the file or else from bounding boxes of the model's shapes."""
    spec = robot.spec.gripper
    x, y, z = spec.pads.size
    given = spec.outlines
    if given is not None:
        upper, core = tuple(Row(*row) for row in given.upper), tuple(Cylinder(*row) for row in given.core)
        disk = Cylinder(*given.disk) if given.disk else None
        return Hand(x / 2, y, z / 2, Outline(*given.finger), upper, core, disk)
    fingers, others = _bound_shapes(robot, moves)
    beside = [points for points in fingers if points[:, 2].max() > -z / 2]
    points = np.concatenate([np.array([[x / 2, spec.opening / 2 + y, z / 2]]), *beside])
    half_width = (float(np.abs(points[:, 1]).max()) - spec.opening / 2) / 2
    finger = Outline(float(np.abs(points[:, 0]).max()), half_width, -float(points[:, 2].max()))
    above = [points for points in fingers if points[:, 2].max() <= -z / 2]
    return Hand(x / 2, y, z / 2, finger, tuple(map(_row_around, [*others, *above])))


def _row_around(points: FloatArray) -> Row:
    """Return the row of cylinders around points in G, shape (n, 3) [m]."""
    low, high = points[:, 1].min(), points[:, 1].max()
    radius = max(float(np.abs(points[:, 0]).max()), 1e-3)
    first, last = min(low + radius, (low + high) / 2), max(high - radius, (low + high) / 2)
    return Row(float(first), float(last), radius, -float(points[:, 2].max()))


def _bound_shapes(robot: "Robot", moves: Moves) -> tuple[list[FloatArray], list[FloatArray]]:
    """Corners of boxes around the shapes of the open hand, each (8, 3) [m]: of the fingers, and of the rest.

    They are seen from between the pads, with the axes of G.
    """
    builder = RobotDiagramBuilder(time_step=0.0)
    plant = builder.plant()
    bodies = robot.add_alone(plant, "solid")
    diagram = builder.Build()
    inspector = diagram.scene_graph().model_inspector()
    context = plant.GetMyContextFromRoot(diagram.CreateDefaultContext())
    q = np.zeros(plant.num_positions())
    opening = robot.spec.gripper.opening
    q[bodies.gripper] = [np.interp(opening, moves.widths, column) for column in moves.places.T]
    plant.SetPositions(context, q)
    signs = np.array(np.meshgrid(*[[-1.0, 1.0]] * 3)).reshape(3, -1)
    found: tuple[list[FloatArray], list[FloatArray]] = ([], [])
    X_PG = RigidTransform([0.0, 0.0, -float(np.interp(opening, moves.widths, moves.rises))])
    for body in bodies.turning:
        X_PB = X_PG @ plant.CalcRelativeTransform(context, bodies.grasp, body.body_frame())
        for geometry in plant.GetCollisionGeometriesForBody(body):
            box = inspector.GetObbInGeometryFrame(geometry)
            X_PO = X_PB @ inspector.GetPoseInFrame(geometry) @ box.pose()
            found[body not in bodies.moving].append((X_PO @ (signs * box.half_width()[:, None])).T)
    return found


def find_touching(robot: "Robot") -> tuple[tuple[str, str], ...]:
    """Find the pairs of links that touch in all of many random postures, open and closed."""
    alone, rng, fingers = Alone(robot, filtered=False), np.random.default_rng(0), robot.gripper.places
    lower, upper = np.clip(robot.lower, -np.pi, np.pi), np.clip(robot.upper, -np.pi, np.pi)
    postures = (alone.contacts(rng.uniform(lower, upper), fingers[i % len(fingers)]) for i in range(_POSTURES))
    always = set(next(postures))
    while always and (touching := next(postures, None)) is not None:
        always.intersection_update(touching)
    return tuple(sorted(always))
