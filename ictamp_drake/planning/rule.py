"""Interface of selection rules, which read the tree and choose the next computational action."""

from dataclasses import dataclass
from typing import Protocol

import numpy as np

from ictamp_drake.core.protocols import Estimator
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


class SelectionRule(Protocol[C]):
    """A search strategy. One rule serves one search, so it may cache results for nodes."""

    def choose(self, tree: Tree[C], rng: np.random.Generator) -> Option:
        """Choose the next computational action.

        Called while there is something to do: the generator is not exhausted, or a plan is open. A rule that rolls out
        plans reads `tree.log[-1]`: it decides again after every single step.
        """


class RuleConfig(Protocol):
    """Configuration of a selection rule."""

    def create(self, estimator: Estimator[C]) -> SelectionRule[C]:
        """Create the rule for one search."""
