"""Interface of selection rules. A rule reads the tree and chooses what is computed next."""

from dataclasses import dataclass
from typing import Protocol, runtime_checkable

from ictamp_drake.core.protocols import RuleContext, SelectionRule
from ictamp_drake.core.types import C, Obstruction
from ictamp_drake.planning.tree import RunStep, Tree


@dataclass(frozen=True)
class OpenPlan:
    """Ask the plan generator for one more high-level plan.

    Attributes:
        obstructions: Boxes that the plan should move out of the way. When there are any, the search continues the plan
            from every node that its first actions have already reached, not only from the root.
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
