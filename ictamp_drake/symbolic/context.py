"""Inputs from which a generator of high-level plans is created."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from ictamp_drake.core.protocols import Config, PlanGenerator
from ictamp_drake.core.types import State
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.symbolic.goal import Goal


@dataclass(frozen=True)
class GeneratorContext:
    """Inputs from which a plan generator is created.

    Attributes:
        domain: Ground actions of the scene.
        initial: H(c_0), the state in which plans begin.
        goal: Goal that holds in the state in which plans end.
    """

    domain: Domain
    initial: State
    goal: Goal


@runtime_checkable
class GeneratorConfig(Config[GeneratorContext, PlanGenerator], Protocol):
    """Configuration of a plan generator."""
