"""Inputs from which an estimator of P is created."""

from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from ictamp_drake.core.protocols import Config, Estimator, SkillRunner
from ictamp_drake.core.types import Attempt, Configuration

if TYPE_CHECKING:
    from ictamp_drake.world.world import World


@dataclass(frozen=True)
class NoSkills:
    """Placeholder for skills where none are run, e.g. when estimates are compared.

    Attributes:
        draws: Number of parameters k that an attempt would draw.
    """

    draws: int = 1

    def attempt(self, *_: object, **__: object) -> Attempt[Configuration]:
        """Raise RuntimeError."""
        raise RuntimeError("no skills are run here")


@dataclass(frozen=True)
class EstimatorContext:
    """Inputs from which an estimator is created.

    Attributes:
        world: The scene.
        skills: Skills that the search runs, for estimators that try them.
    """

    world: "World"
    skills: SkillRunner[Configuration] = field(default_factory=NoSkills)


@runtime_checkable
class EstimatorConfig(Config[EstimatorContext, Estimator[Configuration]], Protocol):
    """Configuration of an estimator of P."""
