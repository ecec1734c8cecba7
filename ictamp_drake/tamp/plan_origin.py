"""Origin of a plan: who found it, with what, and the limits that its motions keep."""

import json
from dataclasses import dataclass, field
from functools import cache
from importlib import metadata
from typing import Any

from ictamp_drake.core.checks import POSITIVE, check_range
from ictamp_drake.core.provenance import PACKAGE, commit
from ictamp_drake.tamp.method import Method
from ictamp_drake.world.config import PredicateConfig


@dataclass(frozen=True)
class Timing:
    """Fractions of the joints' limits that motions use.

    Attributes:
        velocity: Fraction of the velocity limits.
        acceleration: Fraction of the acceleration limits.
        jerk: Fraction of the jerk limits.
    """

    velocity: float
    acceleration: float
    jerk: float

    def __post_init__(self) -> None:
        for name, fraction in vars(self).items():
            check_range(name, fraction, POSITIVE, 1)


@dataclass(frozen=True)
class Origin:
    """Facts about the search that found a plan.

    Attributes:
        version: Version of this package.
        commit: Commit of this package, None if unknown.
        seed: Random seed of the search.
        timing: Fractions of the joints' limits that the motions were timed for.
        predicates: Tolerances of H, which decide the atoms of a configuration.
        options: All options that affect the result, in types that YAML supports.
    """

    version: str
    commit: str | None
    seed: int
    timing: Timing
    predicates: PredicateConfig = PredicateConfig()
    options: dict[str, Any] = field(default_factory=dict)

    @classmethod
    def of(cls, method: Method) -> "Origin":
        """Return the origin of plans that the method finds in this process."""
        limits = method.skills.motion.trajectory
        timing = Timing(limits.velocity, limits.acceleration, limits.jerk)
        options = json.loads(json.dumps(method.decisive, default=str))
        return cls(*_package(), method.seed, timing, method.predicates, options)


@cache
def _package() -> tuple[str, str | None]:
    """Return version and commit of this package."""
    try:
        version = metadata.version("ictamp_drake")
    except metadata.PackageNotFoundError:
        version = "not installed"
    return version, commit(PACKAGE)
