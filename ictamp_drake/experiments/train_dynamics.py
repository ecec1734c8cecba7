"""Train the dynamics of each skill, where an action's box is after a success, for estimates along whole plans.

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
        data: folder of recorded attempts.
        out: folder of the run, by default a new one in runs/; naming that of an interrupted run continues it.
        skills: to train, one after the other.
        sampler: learn only from attempts whose k came from there; from all by default.
        network: what gives the residual; of several members the mean.
        fit: how it is trained.
    """

    data: Path
    out: Path | None = None
    skills: tuple[str, ...] = SKILLS
    sampler: str | None = None
    network: NetworkConfig = NetworkConfig(members=1, width=128)
    fit: FitConfig = FitConfig()


def train(options: TrainDynamics, course: Course) -> bool:
    """Train one skill's dynamics and write its checkpoint; False when it was interrupted."""
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
