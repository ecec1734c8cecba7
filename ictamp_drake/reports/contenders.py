"""The estimators of success that are compared with each other, and the base rate that they must beat."""

from collections.abc import Hashable, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Protocol

import numpy as np

from ictamp_drake.core.checks import check_range
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.protocols import Estimator
from ictamp_drake.core.types import Configuration, FloatArray, Skeleton
from ictamp_drake.estimators.p_score import PScoreConfig
from ictamp_drake.estimators.q_value import QValueConfig
from ictamp_drake.learning.checkpoint import SKILLS, load, name_of
from ictamp_drake.world.world import World


class Contender(Protocol):
    """The configuration of an estimator that does not need to run skills."""

    def create(self, world: World) -> Estimator[Configuration]:
        """The estimator for one scene."""


@dataclass(frozen=True)
class BaseRates:
    """Share of successes in what P was trained on, by skill.

    Attributes:
        pick: by default what the checkpoint of the estimator says about its test scenes.
        place: the same of placements.
    """

    pick: float | None = None
    place: float | None = None

    def __post_init__(self) -> None:
        for skill in SKILLS:
            if (rate := getattr(self, skill)) is not None:
                check_range(f"base-rate.{skill}", rate, 0, 1)

    def complete(self, checkpoints: Path) -> "KnownRates":
        """All rates, from checkpoints where they are not given.

        Raises:
            IctampError: see `checkpoint.load`; or a checkpoint does not say.
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
    """The estimator that knows how often each skill succeeds, and nothing of the situation.

    Attributes:
        rates: by skill.
    """

    rates: Mapping[str, float]

    def create(self, world: object = None) -> "KnownRates":  # noqa: ARG002  (the same for all estimators)
        """Itself, the same in every scene."""
        return self

    def estimate(self, options: Sequence[tuple[Hashable, Skeleton]]) -> FloatArray:
        """The rate of each option's first action, shape (len(options),)."""
        return np.array([self.rates[plan.actions[0].name] for _, plan in options])


def contenders(checkpoints: Path, rates: KnownRates, plans: bool = True) -> dict[str, Contender]:
    """P, STAP's Q of a single draw and other ways of reading the critics, P over fewer k, and the base rate, by name.

    Args:
        checkpoints: folder of all networks.
        rates: that the others must beat.
        plans: also STAP's product along the plan, the best of 16 rollouts.

    Raises:
        IctampError: a checkpoint is missing, damaged or of something else.
    """
    P, Q = PScoreConfig(checkpoints), QValueConfig(checkpoints)
    best = replace(Q, draws=16, best=True)
    ahead = {"Q along plan": replace(best, horizon="plan")} if plans else {}
    P.check()
    for config in (Q, *ahead.values()):
        config.check()
    several = {"Q of 1 draw": Q, "Q mean of 64": replace(Q, draws=64), "Q best of 16": best}
    return {"P": P, **several, **ahead, "P of 16 draws": replace(P, draws=16), "base rate": rates}
