"""The check of a robot file as a whole."""

from collections.abc import Iterator
from contextlib import suppress
from dataclasses import dataclass
from pathlib import Path

from pydrake.planning import RobotDiagramBuilder

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.reading import in_file, read_text
from ictamp_drake.robots.alone import Alone
from ictamp_drake.robots.checking.arm import check_contacts, check_direction, check_limits, check_shapes
from ictamp_drake.robots.checking.file import decode_all
from ictamp_drake.robots.checking.gripper import check_gripper
from ictamp_drake.robots.checking.joints import check_joints
from ictamp_drake.robots.checking.models import find_models
from ictamp_drake.robots.checking.names import check_names
from ictamp_drake.robots.checking.reach import Reach, check_reach, measure_reach
from ictamp_drake.robots.robot import Robot
from ictamp_drake.robots.spec import MAX_BYTES, find_file


@dataclass(frozen=True)
class Report:
    """Result of a check.

    Attributes:
        problems: Mistakes, each with its place in the file.
        robot: Robot; None if it cannot be built.
        reach: Reach of the arm; None if it was not measured.
    """

    problems: tuple[IctampError, ...]
    robot: Robot | None = None
    reach: Reach | None = None


def check_robot(name: str) -> Report:
    """Check a robot that ships, or the file of another one.

    What needs something that is wrong is not checked: the text of the file comes first, then the files of the models,
    then the names in them, and then all the rest.
    """
    try:
        file = find_file(name)
    except IctampError as error:
        return Report((error,))
    try:
        report = _check(name, file)
    except IctampError as error:  # what went wrong between the checks, such as a file that cannot be read
        report = Report((error,))
    for problem in report.problems:
        with suppress(IctampError), in_file(file):
            raise problem
    return report


def _check(name: str, file: Path) -> Report:
    """Check a robot file. The mistakes have no files and lines yet."""
    spec, problems = decode_all(read_text(file, MAX_BYTES))
    if spec is None:
        return Report(tuple(problems))
    models, problems = find_models(spec, file.parent)
    if models is None:
        return Report(tuple(problems))
    if wrong := check_names(spec, models):
        return Report((*problems, *wrong))
    robot, reach = Robot(name, spec, *models), None
    try:
        problems += list(_check_built(robot, has_shapes=not problems))
        if not problems:
            reach = measure_reach(robot)
            problems = check_reach(reach)
    except IctampError as error:
        return Report((*problems, error))
    return Report(tuple(problems), robot, reach)


def _check_built(robot: Robot, *, has_shapes: bool) -> Iterator[IctampError]:
    """Yield what is wrong with a robot whose models have all that the file names.

    Args:
        robot: Robot.
        has_shapes: Whether its shapes for contact can be read.
    """
    bodies = robot.add_alone(RobotDiagramBuilder(time_step=0.0).plant(), "solid" if has_shapes else "visible")
    wrong = list(check_joints(robot, bodies))
    yield from wrong
    yield from check_limits(robot)
    if has_shapes:
        yield from check_shapes(robot, bodies)
    if not wrong:
        yield from check_gripper(robot, bodies)
        yield from check_direction(robot)
        with suppress(IctampError):  # without measures of the gripper, nothing is known about contacts
            yield from check_contacts(robot, Alone(robot), robot.gripper)
