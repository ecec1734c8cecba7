"""Estimators of success to compare with each other, and the base rate that they must beat."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from ictamp_drake.core.checks import check_range
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import FloatArray, Skeleton
from ictamp_drake.estimators.context import EstimatorConfig, EstimatorContext
from ictamp_drake.estimators.p_score import PScoreConfig
from ictamp_drake.estimators.q_value import QValueConfig
from ictamp_drake.learning.checkpoint import SKILLS, load, name_of


@dataclass(frozen=True)
class BaseRates:
    """Share of successes in the data that P was trained on, by skill.

    Attributes:
        pick: Share of successful picks; by default the share in the test scenes of the estimator's checkpoint.
        place: Share of successful placements; by default the share in the test scenes of the estimator's checkpoint.
    """

    pick: float | None = None
    place: float | None = None

    def __post_init__(self) -> None:
        for skill in SKILLS:
            if (rate := getattr(self, skill)) is not None:
                check_range(f"base-rate.{skill}", rate, 0, 1)

    def complete(self, checkpoints: Path) -> "KnownRates":
        """Read the rates that are not given from checkpoints, and return all rates.

        Raises:
            IctampError: A checkpoint cannot be loaded, see `checkpoint.load`, or does not hold the rate.
        """
        given = {skill: getattr(self, skill) for skill in SKILLS}
        return KnownRates(
            {skill: _read_base_rate(checkpoints, skill) if r is None else r for skill, r in given.items()}
        )


def _read_base_rate(checkpoints: Path, skill: str) -> float:
    metrics = load(checkpoints, "estimator", skill).metrics
    if "base_rate" not in metrics:
        path = checkpoints / name_of("estimator", skill)
        advice = f"give it by --base-rate.{skill}, e.g. 0.5"
        raise IctampError(Code.MISSING_FIELD, "missing field", file=path, field="metrics.base_rate", advice=advice)
    return metrics["base_rate"]


@dataclass(frozen=True)
class KnownRates:
    """Estimator that knows how often each skill succeeds, and nothing about the situation.

    Attributes:
        rates: Success rates by skill.
    """

    rates: Mapping[str, float]

    def create(self, _: EstimatorContext) -> "KnownRates":
        """Itself, the same in every scene."""
        return self

    def estimate(self, options: Sequence[tuple[Hashable, Skeleton]]) -> FloatArray:
        """Success rate of each option's first action, shape (len(options),)."""
        return np.array([self.rates[plan.actions[0].name] for _, plan in options])


def contenders(checkpoints: Path, rates: KnownRates, plans: bool = True) -> dict[str, EstimatorConfig]:
    """P, STAP's Q of a single draw and other ways of reading the critics, P over fewer k, and the base rate, by name.

    Args:
        checkpoints: Folder of all networks.
        rates: Base rates that the others must beat.
        plans: Include STAP's product along the plan, the best of 16 rollouts.

    Raises:
        IctampError: A checkpoint is missing or damaged, or holds something else.
    """
    P, Q = PScoreConfig(checkpoints), QValueConfig(checkpoints)
    best = replace(Q, draws=16, best=True)
    ahead = {"Q along plan": replace(best, horizon="plan")} if plans else {}
    P.check()
    for config in (Q, *ahead.values()):
        config.check()
    several = {"Q of 1 draw": Q, "Q mean of 64": replace(Q, draws=64), "Q best of 16": best}
    return {"P": P, **several, **ahead, "P of 16 draws": replace(P, draws=16), "base rate": rates}
