"""Checks of a gripper: how far its fingers open, and how its pads meet."""

from collections.abc import Iterator
from dataclasses import replace

import numpy as np

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import FloatArray
from ictamp_drake.robots.bodies import RobotBodies
from ictamp_drake.robots.measure import Moves, measure_fingers
from ictamp_drake.robots.model_files import read_mimics
from ictamp_drake.robots.robot import Robot

_OFF = 0.001
"""Largest distance by which pads may miss each other, and G their middle [m]."""
_TURNED = 3.0
"""Largest angle between axes that should agree [deg]."""
_TURN = "turn the frame by its rotation"


def check_gripper(robot: Robot, bodies: RobotBodies) -> Iterator[IctampError]:
    """Yield what is wrong with the fingers, pads and grasp frame of a gripper.

    Args:
        robot: Robot.
        bodies: The robot in a finalized plant whose joints all move freely.
    """
    X_GF, X_GP = _poses(bodies, np.zeros(len(bodies.finger_joints)))
    wrong = list(_check_axes(X_GF))
    if not wrong:
        wrong = list(_check_opposite(X_GF))
    if not any(each.where.field == "gripper.grasp" for each in wrong):
        moves, refused = _measure(robot, bodies)
        wrong = [*refused, *wrong]
        if moves is not None and not wrong:
            wrong = list(_check_middle(robot, bodies, moves))
    yield from wrong
    if not X_GP[2, 3] < 0:
        problem = "expected z of the grasp frame out of the palm, but the wrist is in front of it"
        yield IctampError(Code.CONFLICT, problem, field="gripper.grasp", advice=_TURN)


def _measure(robot: Robot, bodies: RobotBodies) -> tuple[Moves | None, list[IctampError]]:
    """Measure the fingers, and where the opening is wrong, once more with another one; return the mistakes, too."""
    spec, mimics = robot.spec.gripper, read_mimics(robot.gripper_model or robot.model)
    problems: list[IctampError] = []
    for each in (spec, replace(spec, opening=0.01)):
        try:
            return measure_fingers(bodies, each, mimics), problems
        except IctampError as error:
            problems.append(error)
            if error.where.field != "gripper.opening":
                break
    return None, problems


def _poses(bodies: RobotBodies, fingers: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Poses in G of both pads' faces, shape (2, 4, 4), and of the body to which the hand is fixed, shape (4, 4)."""
    plant = bodies.plant
    context = plant.CreateDefaultContext()
    q = np.zeros(plant.num_positions())
    q[bodies.gripper] = fingers
    plant.SetPositions(context, q)
    wrist = bodies.arm_joints[-1].frame_on_child()
    frames = (*bodies.faces, wrist)
    first, second, X_GP = (plant.CalcRelativeTransform(context, bodies.grasp, frame).GetAsMatrix4() for frame in frames)
    return np.array([first, second]), X_GP


def _check_axes(X_GF: FloatArray) -> Iterator[IctampError]:
    """Yield mistakes of the directions of pads and grasp frame."""
    away, up = X_GF[:, :3, 1], X_GF[:, :3, 2]
    wrong = [
        max(_angle(away[i], [0.0, side, 0.0]), _angle(up[i], [0.0, 0.0, 1.0])) > _TURNED
        for i, side in enumerate((1.0, -1.0))
    ]
    if all(wrong) and max(_angle(away[0], -away[1]), _angle(*up)) < _TURNED:
        expected = "expected y of the grasp frame from the second pad to the first, and z as that of the pads"
        yield IctampError(Code.CONFLICT, expected, field="gripper.grasp", advice=f"{_TURN}, or exchange the pads")
        return
    for i, (name, where) in enumerate((("first", "y"), ("second", "-y"))):
        if wrong[i]:
            expected = f"expected y of the pad's frame along {where} of the grasp frame and z along its z"
            yield IctampError(Code.CONFLICT, expected, field=f"gripper.pads.{name}", advice=_TURN)


def _check_opposite(X_GF: FloatArray) -> Iterator[IctampError]:
    """Yield mistakes of the pads' places to each other."""
    miss = X_GF[0, :3, 3] - X_GF[1, :3, 3]
    for axis, distance in (("x", abs(miss[0])), ("z", abs(miss[2]))):
        if distance > _OFF:
            problem = f"the pads are not opposite: {1000 * distance:.1f} mm apart along {axis} of the grasp frame"
            yield IctampError(Code.CONFLICT, problem, field="gripper.pads", advice="move one of the pads' frames")


def _check_middle(robot: Robot, bodies: RobotBodies, moves: Moves) -> Iterator[IctampError]:
    """Yield a mistake if the grasp frame is not between the pads."""
    X_GF, _ = _poses(bodies, moves.places[len(moves.places) // 2])
    x, y, _ = (X_GF[0, :3, 3] + X_GF[1, :3, 3]) / 2
    z = min(moves.rises, key=abs)
    if max(abs(x), abs(y)) > _OFF or abs(z) > robot.spec.gripper.pads.size[2] / 2:
        middle = ", ".join(f"{1000 * each:.1f}" for each in (x, y, z))
        problem = f"the middle between the pads is at ({middle}) mm in the grasp frame"
        yield IctampError(Code.CONFLICT, problem, field="gripper.grasp", advice="move the frame there")


def _angle(axis: FloatArray, other: FloatArray | list[float]) -> float:
    """Angle between unit vectors [deg]."""
    return float(np.rad2deg(np.arccos(np.clip(axis @ np.asarray(other), -1.0, 1.0))))
