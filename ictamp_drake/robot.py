"""Check a robot file: `python -m ictamp_drake.robot check ROBOT.yaml`."""

import logging
import sys
from collections.abc import Iterator
from dataclasses import dataclass
from typing import Literal

import numpy as np
import tyro
from rich.console import Console
from rich.table import Table

from ictamp_drake.robots.checking.report import Report, check_robot
from ictamp_drake.robots.robot import Robot
from ictamp_drake.runs.command import BAD_INPUT, COMPLETE, command
from ictamp_drake.tamp.holding import check_holding
from ictamp_drake.viz.robot import show_robot

NAME = "ictamp_drake.robot"


@dataclass(frozen=True)
class RobotOptions:
    """Check the file of a robot against its models, and say what is wrong with it and what to do.

    The exit code is 0 when nothing is wrong, and 2 otherwise.

    Attributes:
        action: What to do.
        robot: Name of a robot that ships, or the path of a robot file.
        show: Show the robot at home in a browser, with the frames of base, flange, grasp and pads, until Ctrl-C.
    """

    action: tyro.conf.Positional[Literal["check"]]
    robot: tyro.conf.Positional[str]
    show: bool = False


class _Once(logging.Filter):
    """Lets each message pass once: Drake reads a model several times."""

    def __init__(self) -> None:
        super().__init__()
        self._seen: set[str] = set()

    def filter(self, record: logging.LogRecord) -> bool:
        message = record.getMessage()
        is_new = message not in self._seen
        self._seen.add(message)
        return is_new


def act(options: RobotOptions, console: Console) -> int:
    """Check the robot, print what is wrong with it or else its measures, and return the exit code."""
    logging.getLogger("drake").addFilter(_Once())
    report = check_robot(options.robot)
    problems = report.problems
    if report.robot is not None and not problems:
        problems = tuple(check_holding(report.robot))
    for problem in problems:
        console.print(str(problem), soft_wrap=True)
    if problems:
        console.print(f"{options.robot}: {len(problems)} to mend", soft_wrap=True)
    else:
        _print(report, console)
    if options.show and report.robot is not None:
        show_robot(report.robot)
    return BAD_INPUT if problems else COMPLETE


def _print(report: Report, console: Console) -> None:
    """Print the measures of a robot with which nothing is wrong."""
    robot, reach = report.robot, report.reach
    if robot is None or reach is None:
        return
    table = Table("joint", "from", "to", "home", "velocity", "acceleration", "jerk", "effort", box=None)
    numbers = (robot.lower, robot.upper, robot.home, robot.velocity, robot.acceleration, robot.jerk, robot.effort)
    for joint, *row in zip(robot.joints, *numbers, strict=True):
        table.add_row(joint, *(f"{number:.4g}" for number in row))
    console.print(table)
    for line in _describe(robot):
        console.print(line, soft_wrap=True)
    console.print(f"Inverse kinematics: {reach.kind}, {reach.solved:.0%} of random reachable poses solved")
    console.print(f"Reach: {reach.farthest:.2f} m from the base to the grasp frame")
    console.print(f"Table at the height of the base: {reach.table:.0%} of the grasps from above can be reached")
    console.print(f"{robot.name}: nothing is wrong", soft_wrap=True)


def _describe(robot: Robot) -> Iterator[str]:
    gripper = robot.gripper
    yield f"Gripper: opens {1000 * gripper.opening:.0f} mm, grips with {gripper.force:g} N, {gripper.speed:g} m/s"
    travel = float(np.ptp(gripper.rises))
    if travel > 1e-4:
        yield f"The pads move {1000 * travel:.1f} mm along the approach as they close"
    if robot.spec.touching is None:
        found = "; ".join(" and ".join(pair) for pair in robot.touching)
        yield f"Links that always touch, and are not tested: {found or 'none'}"


def main(arguments: list[str] | None = None) -> int:
    """Run the program and return its exit code."""
    return command(NAME, RobotOptions, act, "Interrupted.", arguments)


if __name__ == "__main__":
    sys.exit(main())
