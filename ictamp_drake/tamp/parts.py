"""What a search is put together from, so that any part can be one of one's own; see docs/extending.md."""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Protocol

from ictamp_drake.core.protocols import Estimator, PlanGenerator, SkillRunner
from ictamp_drake.core.types import Atom, Configuration, State
from ictamp_drake.planning.rule import RuleConfig
from ictamp_drake.skills.base import SkillConfig
from ictamp_drake.skills.runner import SamplerConfig
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.world.world import World


class EstimatorConfig(Protocol):
    """Configuration of an estimator."""

    def create(self, world: World, skills: SkillRunner[Configuration]) -> Estimator[Configuration]:
        """The estimator for one search in the scene, with the skills that the search runs."""


class GeneratorConfig(Protocol):
    """Configuration of a plan generator."""

    def create(self, domain: Domain, initial: State, goal: frozenset[Atom]) -> PlanGenerator:
        """A stream of plans from `initial` to states that hold `goal`."""


@dataclass(frozen=True)
class Parts:
    """Configurations of the parts of a search, those of a `Method` or of one's own.

    Attributes:
        sampler: of k.
        estimator: of P.
        generator: of high-level plans.
        rule: that chooses the next computational action.
        skills: by the name of their action, in the place of those of the package.
    """

    sampler: SamplerConfig
    estimator: EstimatorConfig
    generator: GeneratorConfig
    rule: RuleConfig
    skills: Mapping[str, SkillConfig] = field(default_factory=dict)
