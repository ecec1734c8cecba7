"""Train P of each skill, the probability that a high-level action succeeds, from attempts with the shipped policy.

`python -m ictamp_drake.experiments.train_estimator --data data/outcomes --out runs/estimator`
"""

import sys
from dataclasses import asdict, dataclass
from pathlib import Path

from ictamp_drake.estimators.p_score import PScoreConfig
from ictamp_drake.experiments.trainer import Course, main
from ictamp_drake.learning.batches import Batch
from ictamp_drake.learning.checkpoint import SHIPPED, SKILLS, Checkpoint, load
from ictamp_drake.learning.classifier import Classifier
from ictamp_drake.learning.evaluation import calibrate
from ictamp_drake.learning.metrics import metrics
from ictamp_drake.learning.models import EstimatorModel, arrays_of, load_skill
from ictamp_drake.learning.networks import NetworkConfig
from ictamp_drake.learning.objectives import Classification
from ictamp_drake.learning.training import FitConfig
from ictamp_drake.observation.state_matrix import Observation


@dataclass(frozen=True)
class TrainEstimator:
    """Train an ensemble on outcomes, stop it early and calibrate it on scenes it has not seen.

    It learns from the k that was tried; P is its mean over the k that the policy proposes. So it can learn from
    attempts with any k, while only those with the policy tell how good P is.

    Attributes:
        data: folder of recorded attempts with the policy.
        also: folders of attempts with any k that are learned from too, and neither calibrate nor test.
        out: folder of the run, by default a new one in runs/; naming that of an interrupted run continues it.
        skills: to train, one after the other.
        sampler: learn only from attempts whose k came from there; from all by default.
        policy: folder of the policy whose success P is to be, by default that of the package.
        network: the ensemble.
        fit: how it is trained.
    """

    data: Path
    also: tuple[Path, ...] = ()
    out: Path | None = None
    skills: tuple[str, ...] = SKILLS
    sampler: str | None = None
    policy: Path | None = None
    network: NetworkConfig = NetworkConfig(width=48)
    fit: FitConfig = FitConfig()


def train(options: TrainEstimator, course: Course) -> bool:
    """Train one skill's estimator and write its checkpoint; False when it was interrupted."""
    folder, skill = options.policy or SHIPPED, course.skill
    policy, found = load_skill(folder, skill).policy, load(folder, "policy", skill)
    critic = Classifier(skill, options.network)
    course = course.with_added_data(*options.also)
    complete = course.fit("estimator", Classification(critic), options.fit, bootstraps=options.network.members)
    calibrate(critic, course.parts.validation)
    Checkpoint(
        kind="estimator",
        skill=skill,
        arrays={**arrays_of(policy, "policy."), **arrays_of(critic, "critic.")},
        network={"policy": found.network["policy"], "critic": asdict(options.network)},
        provenance=course.about,
        metrics=evaluate_estimator(EstimatorModel(policy, critic), course.parts.test),
    ).save(course.folder)
    return complete


def evaluate_estimator(model: EstimatorModel, test: Batch) -> dict[str, float]:
    """Figures of P, which sees no k, on held-out attempts."""
    P, _ = model.believe(Observation(test.matrix.numpy(), test.mask.numpy()), PScoreConfig().draws)
    return metrics(P, test.success.numpy())


if __name__ == "__main__":
    sys.exit(main("ictamp_drake.experiments.train_estimator", TrainEstimator, train))
