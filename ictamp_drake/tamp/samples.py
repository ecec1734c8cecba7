"""Joint trajectories of a plan, sampled and split at the commands to the hand: as CSV and for ROS 2."""

import csv
import io
import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from itertools import groupby
from typing import Any

import numpy as np
import yaml

from ictamp_drake.core.types import FloatArray, GripperCommand
from ictamp_drake.tamp.plan import Plan
from ictamp_drake.world.commands import arm_trajectory

ROS_HEADER = """\
# Joint trajectories of a plan, for ROS 2. Radians, seconds, meters, newtons.
#
# To be done in this order, each when the one before is done. Times without "from_start" are from the start of the plan.
#   gripper           goal of the hand: width between the finger pads, force of each finger (0: move and do not grip)
#   joint_trajectory  a trajectory_msgs/JointTrajectory, from rest to rest, which begins where the one before ends
"""

_DIGITS = 9
"""Decimal places of the samples."""


@dataclass(frozen=True, eq=False)
class Part:
    """Piece of the arm's motion between two commands to the hand, from rest to rest.

    Attributes:
        start: Time from the start of the plan [s].
        gripper: Command to the hand, given at the start of the part.
        times: Times of the samples from the start of the part, ascending from 0 to its duration [s], shape (n,).
        q: Joint positions [rad], shape (n, joints).
        v: Joint velocities [rad/s], shape (n, joints).
        a: Joint accelerations [rad/s^2], shape (n, joints).
    """

    start: float
    gripper: GripperCommand
    times: FloatArray
    q: FloatArray
    v: FloatArray
    a: FloatArray


def sample(plan: Plan, rate: float) -> list[Part]:
    """Sample the motion of a plan; a part begins wherever the command to the hand changes.

    Args:
        plan: Plan to sample.
        rate: Number of samples per second. The end of each part is a sample, too.
    """
    segments = [segment for attempt in plan.attempts for segment in attempt.motion]
    parts, start = [], 0.0
    for gripper, group in groupby(segments, key=lambda segment: segment.gripper):
        trajectory = arm_trajectory(list(group))
        end = trajectory.end_time()
        times = np.append(np.arange(math.ceil(end * rate - 1e-6)) / rate, end)
        derivatives = [trajectory] + [trajectory.MakeDerivative(order) for order in (1, 2)]
        q, v, a = (each.vector_values(times).T for each in derivatives)
        parts.append(Part(start, gripper, times, q, v, a))
        start += end
    return parts


def joints_csv(parts: Sequence[Part], joints: Sequence[str]) -> str:
    """Return a table of all samples, with the names of the joints.

    Where one part ends and the next begins, the same time comes twice.
    """
    quantities = ("", "_velocity", "_acceleration")
    heading = ["part", "time", *(f"{joint}{quantity}" for quantity in quantities for joint in joints)]
    return _csv(heading, _rows(parts))


def _rows(parts: Sequence[Part]) -> Iterator[list[float]]:
    for number, part in enumerate(parts):
        samples = np.column_stack([part.start + part.times, part.q, part.v, part.a])
        yield from ([number, *row] for row in samples.round(_DIGITS).tolist())


def gripper_csv(parts: Sequence[Part]) -> str:
    """Return a table of the commands to the hand, one at the start of each part."""
    rows = ([number, round(part.start, _DIGITS), *_goal(part).values()] for number, part in enumerate(parts))
    return _csv(["part", "time", "width", "force"], rows)


def ros_yaml(parts: Sequence[Part], joints: Sequence[str]) -> str:
    """Return goals of the hand and `trajectory_msgs/JointTrajectory` messages of the joints, alternately, as YAML."""
    entries: list[dict[str, Any]] = []
    for part in parts:
        time = round(part.start, _DIGITS)
        entries += [{"time": time, "gripper": _goal(part)}, {"time": time, "joint_trajectory": _message(part, joints)}]
    text = yaml.dump(entries, Dumper=yaml.CSafeDumper, sort_keys=False, default_flow_style=None, width=1000)
    return ROS_HEADER + str(text)


def _goal(part: Part) -> dict[str, float]:
    return {"width": float(part.gripper.width), "force": float(part.gripper.force)}


def _message(part: Part, joints: Sequence[str]) -> dict[str, Any]:
    samples = zip(part.times, *(each.round(_DIGITS).tolist() for each in (part.q, part.v, part.a)), strict=True)
    points = [
        {"positions": q, "velocities": v, "accelerations": a, "effort": [], "time_from_start": _duration(time)}
        for time, q, v, a in samples
    ]
    header = {"stamp": _duration(0.0), "frame_id": ""}
    return {"header": header, "joint_names": list(joints), "points": points}


def _duration(seconds: float) -> dict[str, int]:
    """Return `builtin_interfaces/Duration`, or a time."""
    whole, nanoseconds = divmod(round(seconds * 1e9), 10**9)
    return {"sec": whole, "nanosec": nanoseconds}


def _csv(heading: Sequence[str], rows: Iterator[list[float]]) -> str:
    text = io.StringIO()
    csv.writer(text, lineterminator="\n").writerows([heading, *rows])
    return text.getvalue()
