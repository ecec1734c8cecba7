"""Write a plan file as joint trajectories: `python -m ictamp_drake.export PLAN.yaml`."""

import sys
from dataclasses import dataclass
from pathlib import Path

import tyro
from rich.console import Console

from ictamp_drake.core.checks import check_range
from ictamp_drake.core.files import make_folder, refuse_unwritable, write_whole
from ictamp_drake.robots.robot import find_robot
from ictamp_drake.runs.command import COMPLETE, command
from ictamp_drake.tamp.plan import Plan
from ictamp_drake.tamp.samples import gripper_csv, joints_csv, ros_yaml, sample

NAME = "ictamp_drake.export"


@dataclass(frozen=True)
class ExportOptions:
    """Write the arm's trajectories and the goals of the hand, as CSV and as ROS 2 messages.

    The motion is split wherever the command to the hand changes. joints.csv has the sampled positions, velocities and
    accelerations, gripper.csv the goals of the hand, and joint_trajectory.yaml both in the order of execution, the
    motions as trajectory_msgs/JointTrajectory.

    Attributes:
        plan: File of the plan, plan.yaml of a run.
        out: Folder of the files. By default that of the plan.
        rate: Number of samples per second.
    """

    plan: tyro.conf.Positional[Path]
    out: Path | None = None
    rate: float = 100.0

    def __post_init__(self) -> None:
        check_range("rate", self.rate, 1, 10_000, " Hz")


def act(options: ExportOptions, console: Console) -> int:
    """Write the files and return the exit code.

    Raises:
        IctampError: The file is not a plan, or a file cannot be written.
    """
    plan = Plan.load(options.plan)
    parts, joints = sample(plan, options.rate), find_robot(plan.spec.robot).joints
    folder = options.out or options.plan.parent
    make_folder(folder)
    texts = {
        "joints.csv": joints_csv(parts, joints),
        "gripper.csv": gripper_csv(parts),
        "joint_trajectory.yaml": ros_yaml(parts, joints),
    }
    for name, text in texts.items():
        with refuse_unwritable(folder / name):
            write_whole(folder / name, text)
        console.print(f"Written: {folder / name}", soft_wrap=True)
    return COMPLETE


def main(arguments: list[str] | None = None) -> int:
    """Run the program and return its exit code."""
    return command(NAME, ExportOptions, act, "Interrupted.", arguments)


if __name__ == "__main__":
    sys.exit(main())
