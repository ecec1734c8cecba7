"""Train P for each skill, the probability that a high-level action succeeds, from attempts with the shipped policy.

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
    """Train an ensemble on outcomes of attempts, with early stopping and calibration on unseen scenes.

    The ensemble takes the attempted k as an input, and P is its mean over the k that the policy proposes. Therefore it
    can learn from attempts with any k, but only attempts with the policy can measure the quality of P.

    Attributes:
        data: Folder of recorded attempts with the policy.
        also: Folders of additional training attempts with any k. They are not used for calibration or testing.
        out: Folder of the run. By default a new one in runs/. The folder of an interrupted run is continued.
        skills: Skills to train, one after the other.
        sampler: Source of k: only attempts with a k from this sampler are used. By default all attempts are used.
        policy: Folder of the policy whose success rate P predicts. By default that of the package.
        network: Ensemble of networks.
        fit: Options of the training.
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
    """Train the estimator of one skill and write its checkpoint. Return False when interrupted."""
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
    """Return metrics of P, which does not depend on k, on held-out attempts."""
    P, _ = model.believe(Observation(test.matrix.numpy(), test.mask.numpy()), PScoreConfig().draws)
    return metrics(P, test.success.numpy())


if __name__ == "__main__":
    sys.exit(main("ictamp_drake.experiments.train_estimator", TrainEstimator, train))
