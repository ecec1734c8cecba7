"""What a selection rule is: it reads the tree and says which computational action comes next."""

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
        obstructions: what the plan is to get out of the way. When there are any, the search goes on with the plan from
            wherever its first actions have led already, and not from the root alone.
    """

    obstructions: frozenset[Obstruction] = frozenset()


Option = OpenPlan | RunStep


class SelectionRule(Protocol[C]):
    """A search strategy. One rule serves one search, so it may remember what it computed for a node."""

    def choose(self, tree: Tree[C], rng: np.random.Generator) -> Option:
        """The next computational action.

        Called while there is anything to do: the generator is not exhausted, or a plan is open. A rule that rolls
        plans out looks at `tree.log[-1]`: whatever comes next is its own decision after every single step.
        """


class RuleConfig(Protocol):
    """Configuration of a selection rule."""

    def create(self, estimator: Estimator[C]) -> SelectionRule[C]:
        """The rule for one search."""
