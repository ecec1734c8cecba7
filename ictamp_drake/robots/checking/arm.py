"""Checks of an arm: its limits, its home, and its shapes."""

from collections.abc import Iterator

import numpy as np

from ictamp_drake.core.checks import check_range
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.robots.alone import Alone
from ictamp_drake.robots.bodies import RobotBodies
from ictamp_drake.robots.gripper import Gripper
from ictamp_drake.robots.robot import Robot

_LIMITS = ("velocity", "acceleration", "jerk", "effort")
_TILT = 5.0
"""Largest angle between a hand that points down and the vertical [deg]."""


def check_limits(robot: Robot) -> Iterator[IctampError]:
    """Yield the limits that neither model nor file gives, and places of home beyond the joints' limits."""
    for name in _LIMITS:
        try:
            getattr(robot, name)
        except IctampError as error:
            yield error
    for number, (position, low, high) in enumerate(zip(robot.home, robot.lower, robot.upper, strict=True)):
        try:
            check_range(f"home[{number}]", position, low, high, " rad")
        except IctampError as error:
            yield error


def check_direction(robot: Robot) -> Iterator[IctampError]:
    """Yield a mistake if the hand does not point down at home."""
    down = -robot.forward(robot.home[None])[0, 2, 2]
    tilt = float(np.rad2deg(np.arccos(np.clip(down, -1.0, 1.0))))
    if tilt > _TILT:
        problem = f"expected a hand that points down, but its z axis is {tilt:.0f} deg off"
        advice = "choose another home, or turn gripper.mount or gripper.grasp"
        yield IctampError(Code.CONFLICT, problem, field="home", value=robot.spec.home, advice=advice)


def check_contacts(robot: Robot, alone: Alone, gripper: Gripper) -> Iterator[IctampError]:
    """Yield each pair of links that touch at home, with the hand open or half open."""
    fingers = [gripper.positions(share * gripper.opening) for share in (1.0, 0.5)]
    for one, other in sorted({pair for each in fingers for pair in alone.contacts(robot.home, each)}):
        problem = f"{one} and {other} touch at home"
        advice = "choose another home, or smaller shapes in collision:"
        yield IctampError(Code.OVERLAP, problem, field="home", value=[one, other], advice=advice)


def check_shapes(robot: Robot, bodies: RobotBodies) -> Iterator[IctampError]:
    """Yield links that have a mass but no shapes for contact, so that they would pass through everything.

    Args:
        robot: Robot.
        bodies: The robot in a plant with all its shapes.
    """
    for body in bodies.links:
        is_arm = body.model_instance() == bodies.instances[0]
        given = robot.spec.collision if is_arm else robot.spec.gripper.collision
        shapes = bodies.plant.GetCollisionGeometriesForBody(body)
        if body.default_mass() > 0 and not shapes and body.name() not in given:
            section = "collision" if is_arm else "gripper.collision"
            problem = "{value} has no shapes for contact, so it would pass through everything"
            advice = f"give shapes in {section}:, or an empty list if it needs none"
            field = "model" if is_arm else "gripper.model"
            yield IctampError(Code.EMPTY, problem, field=field, value=body.name(), advice=advice)
