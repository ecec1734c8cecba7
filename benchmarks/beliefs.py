"""Weight of an attempt against P: `python benchmarks/beliefs.py`, about two minutes.

Repeated attempts from the same c show how far the share of successes deviates from P. For each skill, this prints the
strength of the Beta prior with mean P that makes the attempts most likely (a constant of `planning.beliefs`), and the
negative log likelihood for several strengths. The attempts are those in every ninth scene of data/outcomes, on which P
was trained.
"""

from pathlib import Path

import numpy as np
from scipy.optimize import minimize_scalar
from scipy.stats import betabinom

from ictamp_drake.core.types import FloatArray, Skeleton
from ictamp_drake.estimators.context import EstimatorContext
from ictamp_drake.estimators.p_score import PScoreConfig
from ictamp_drake.learning.cases import read_cases
from ictamp_drake.learning.checkpoint import SKILLS
from ictamp_drake.learning.dataset import scene
from ictamp_drake.reports.predictions import group_by_scene
from ictamp_drake.world.world import World

DATA = Path(__file__).parents[1] / "data" / "outcomes"
EVERY = 9
DRAWS = 2
STRENGTHS = (0.5, 1.0, 2.0, 4.0, 8.0, 16.0)


def count_successes(skill: str) -> tuple[FloatArray, FloatArray]:
    """Return P and the number of successes of each case, both of shape (n,)."""
    cases = [case for case in read_cases(DATA, skill, DRAWS, "policy") if case.scene % EVERY == 0]
    P, successes = list[float](), list[int]()
    for group in group_by_scene(cases):
        estimator = PScoreConfig().create(EstimatorContext(World(scene(group[0].spec))))
        options = [(case.c, Skeleton((frozenset(), frozenset()), (case.action,))) for case in group]
        P += estimator.estimate(options).tolist()
        successes += [int(case.outcomes.sum()) for case in group]
    return np.clip(P, 0.02, 0.98), np.array(successes, dtype=np.float64)


def surprise(strength: float, P: FloatArray, successes: FloatArray) -> float:
    """Negative log likelihood of the successes."""
    return -float(betabinom.logpmf(successes, DRAWS, strength * P, strength * (1 - P)).sum())


def main() -> None:
    """Print the table."""
    print(f"{'':8}{'cases':>7}{'best':>7}" + "".join(f"{strength:>8g}" for strength in STRENGTHS))
    together = np.zeros(len(STRENGTHS))
    for skill in SKILLS:
        P, successes = count_successes(skill)
        best = minimize_scalar(lambda log, *data: surprise(np.exp(log), *data), (-3, 5), args=(P, successes))
        losses = [surprise(strength, P, successes) for strength in STRENGTHS]
        together += losses
        print(f"{skill:8}{len(P):7}{np.exp(best.x):7.1f}" + "".join(f"{loss:8.1f}" for loss in losses))
    print(f"{'both':8}{'':14}" + "".join(f"{loss:8.1f}" for loss in together))


if __name__ == "__main__":
    main()
