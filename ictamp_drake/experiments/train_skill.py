"""Train the policy and the critics of each skill separately from recorded attempts.

`python -m ictamp_drake.experiments.train_skill --data data/attempts --out runs/skills`
"""

import sys
from dataclasses import asdict, dataclass, replace
from pathlib import Path

import numpy as np

from ictamp_drake.experiments.trainer import Course, main
from ictamp_drake.learning.checkpoint import SKILLS, Checkpoint
from ictamp_drake.learning.classifier import Classifier
from ictamp_drake.learning.evaluation import calibrate, evaluate_classifier
from ictamp_drake.learning.models import SkillModel, arrays_of
from ictamp_drake.learning.networks import NetworkConfig
from ictamp_drake.learning.objectives import Classification, Improvement, PolicyTraining
from ictamp_drake.learning.training import FitConfig
from ictamp_drake.observation.state_matrix import Observation


@dataclass(frozen=True)
class TrainSkill:
    """Train Q(matrix, k), and then the policy that proposes k.

    Options for the actor-critic of STAP (offline, critics first): `--critic.kind flat --critic.members 2
    --critic.width 256 --policy.network.kind squashed --policy.network.network.kind flat
    --policy.network.network.width 256 --policy.imitation 0 --policy.temperature 0.1 --policy.entropy -4
    --fit.rate 1e-4`.

    Attributes:
        data: Folder of recorded attempts.
        out: Folder of the run. By default a new one in runs/. The folder of an interrupted run is continued.
        skills: Skills to train, one after the other.
        sampler: Source of k: only attempts with a k from this sampler are used. By default all attempts are used.
        critic: Networks of Q.
        policy: Policy π and its objective.
        fit: Options of the training of both.
    """

    data: Path
    out: Path | None = None
    skills: tuple[str, ...] = SKILLS
    sampler: str | None = None
    critic: NetworkConfig = NetworkConfig()
    policy: PolicyTraining = PolicyTraining()
    fit: FitConfig = FitConfig()


def train(options: TrainSkill, course: Course) -> bool:
    """Train one skill and write its checkpoint. Return False when interrupted."""
    critic = Classifier(course.skill, options.critic)
    if not course.fit("critic", Classification(critic), options.fit, bootstraps=options.critic.members):
        return False
    calibrate(critic, course.parts.validation)
    improvement = Improvement(options.policy, critic)
    complete = replace(course, parts=course.parts.select_informative()).fit("policy", improvement, options.fit)
    model = SkillModel(improvement.policy, critic)
    Checkpoint(
        kind="policy",
        skill=course.skill,
        arrays={**arrays_of(improvement.policy, "policy."), **arrays_of(critic, "critic.")},
        network={"policy": asdict(options.policy.network), "critic": asdict(options.critic)},
        provenance=course.about,
        metrics={**evaluate_classifier(critic, course.parts.test), **evaluate_policy(model, course)},
    ).save(course.folder)
    return complete


def evaluate_policy(model: SkillModel, course: Course, count: int = 16) -> dict[str, float]:
    """Return the mean Q of one draw and of the best of several in test scenes, by the critics and without physics."""
    test = course.parts.test
    observation = Observation(test.matrix.numpy(), test.mask.numpy())
    Q = model.Q(observation, model.draw(observation, count, np.random.default_rng(0)))
    return {"Q_of_one_draw": float(Q.mean()), f"Q_of_best_of_{count}": float(Q.max(axis=1).mean())}


if __name__ == "__main__":
    sys.exit(main("ictamp_drake.experiments.train_skill", TrainSkill, train))
