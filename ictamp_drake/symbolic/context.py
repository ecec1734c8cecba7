"""What a generator of high-level plans is made from."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from ictamp_drake.core.protocols import Config, PlanGenerator
from ictamp_drake.core.types import Atom, State
from ictamp_drake.symbolic.domain import Domain


@dataclass(frozen=True)
class GeneratorContext:
    """What a plan generator is made from.

    Attributes:
        domain: Ground actions of the scene.
        initial: H(c_0), the state that plans begin in.
        goal: Atoms that hold where they end.
    """

    domain: Domain
    initial: State
    goal: frozenset[Atom]


@runtime_checkable
class GeneratorConfig(Config[GeneratorContext, PlanGenerator], Protocol):
    """Configuration of a plan generator."""
