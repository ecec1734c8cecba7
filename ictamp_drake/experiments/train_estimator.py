"""Train P of each skill, the probability that a high-level action succeeds, from attempts with the shipped policy.

`python -m ictamp_drake.experiments.train_estimator --data data/policy_attempts --out runs/estimator`
"""

import sys
from dataclasses import asdict, dataclass
from pathlib import Path

from ictamp_drake.experiments.trainer import Course, main
from ictamp_drake.learning.checkpoint import SKILLS, Checkpoint
from ictamp_drake.learning.classifier import Classifier
from ictamp_drake.learning.evaluation import calibrate, judged
from ictamp_drake.learning.models import arrays_of
from ictamp_drake.learning.networks import NetworkConfig
from ictamp_drake.learning.objectives import Classification
from ictamp_drake.learning.training import FitConfig


@dataclass(frozen=True)
class TrainEstimator:
    """Train an ensemble on outcomes, stop it early and calibrate it on scenes it has not seen.

    Attributes:
        data: folder of recorded attempts.
        out: folder of the run, by default a new one in runs/; naming that of an interrupted run continues it.
        skills: to train, one after the other.
        sampler: learn only from attempts whose k came from there; from all by default.
        network: the ensemble.
        fit: how it is trained.
    """

    data: Path
    out: Path | None = None
    skills: tuple[str, ...] = SKILLS
    sampler: str | None = None
    network: NetworkConfig = NetworkConfig()
    fit: FitConfig = FitConfig()


def train(options: TrainEstimator, course: Course) -> bool:
    """Train one skill's estimator and write its checkpoint; False when it was interrupted."""
    estimator = Classifier(course.skill, options.network, sees_k=False)
    complete = course.fit("estimator", Classification(estimator), options.fit, bootstraps=options.network.members)
    calibrate(estimator, course.parts.validation)
    Checkpoint(
        kind="estimator",
        skill=course.skill,
        arrays=arrays_of(estimator),
        network=asdict(options.network),
        provenance=course.about,
        metrics=judged(estimator, course.parts.test),
    ).save(course.folder)
    return complete


if __name__ == "__main__":
    sys.exit(main("ictamp_drake.experiments.train_estimator", TrainEstimator, train))
