"""Train the dynamics of each skill for estimates along whole plans: the pose of the action's box after a success.

`python -m ictamp_drake.experiments.train_dynamics --data data/attempts --out runs/dynamics`
"""

import sys
from dataclasses import asdict, dataclass, replace
from pathlib import Path

from ictamp_drake.experiments.trainer import Course, main
from ictamp_drake.learning.checkpoint import SKILLS, Checkpoint
from ictamp_drake.learning.dynamics import Dynamics
from ictamp_drake.learning.evaluation import evaluate_dynamics
from ictamp_drake.learning.models import arrays_of
from ictamp_drake.learning.networks import NetworkConfig
from ictamp_drake.learning.objectives import PoseRegression
from ictamp_drake.learning.training import FitConfig


@dataclass(frozen=True)
class TrainDynamics:
    """Train T(matrix, k) on the attempts that succeeded.

    Attributes:
        data: Folder of recorded attempts.
        out: Folder of the run. By default a new one in runs/. The folder of an interrupted run is continued.
        skills: Skills to train, one after the other.
        sampler: Source of k: only attempts with a k from this sampler are used. By default all attempts are used.
        network: Network that predicts the residual. With several members, their mean.
        fit: Options of the training.
    """

    data: Path
    out: Path | None = None
    skills: tuple[str, ...] = SKILLS
    sampler: str | None = None
    network: NetworkConfig = NetworkConfig(members=1, width=128)
    fit: FitConfig = FitConfig()


def train(options: TrainDynamics, course: Course) -> bool:
    """Train the dynamics of one skill and write its checkpoint. Return False when interrupted."""
    course = replace(course, parts=course.parts.successes())
    dynamics = Dynamics(course.skill, options.network)
    complete = course.fit("dynamics", PoseRegression(dynamics), options.fit)
    Checkpoint(
        kind="dynamics",
        skill=course.skill,
        arrays=arrays_of(dynamics),
        network=asdict(options.network),
        provenance=course.about,
        metrics=evaluate_dynamics(dynamics, course.parts.test),
    ).save(course.folder)
    return complete


if __name__ == "__main__":
    sys.exit(main("ictamp_drake.experiments.train_dynamics", TrainDynamics, train))
