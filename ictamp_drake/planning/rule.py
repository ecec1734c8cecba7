"""What a selection rule is made from and what it answers: it reads the tree and says what is computed next."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from ictamp_drake.core.protocols import RuleContext, SelectionRule
from ictamp_drake.core.types import C, Obstruction
from ictamp_drake.planning.tree import RunStep, Tree


@dataclass(frozen=True)
class OpenPlan:
    """Ask the plan generator for one more high-level plan.

    Attributes:
        obstructions: what the plan is to get out of the way. When there are any, the search goes on with the plan from
            wherever its first actions have led already, and not from the root alone.
    """

    obstructions: frozenset[Obstruction] = frozenset()


Option = OpenPlan | RunStep
"""A computational action."""

Rule = SelectionRule[Tree[C], Option]
"""A selection rule for trees of configurations C."""


@runtime_checkable
class RuleConfig(Protocol):
    """Configuration of a selection rule, for trees of any configurations."""

    def create(self, context: RuleContext[C], /) -> Rule[C]:
        """The rule for one search."""
