"""Uniform allocation: every computational action is as likely as any other."""

from dataclasses import dataclass
from typing import Generic

import numpy as np

from ictamp_drake.core.protocols import RuleContext
from ictamp_drake.core.types import C
from ictamp_drake.planning.rule import OpenPlan, Option
from ictamp_drake.planning.tree import Tree


@dataclass(frozen=True)
class UniformAllocationConfig:
    """Configuration of uniform allocation, which has no settings."""

    def create(self, _: RuleContext[C]) -> "UniformAllocation[C]":
        """The rule for one search."""
        return UniformAllocation()


class UniformAllocation(Generic[C]):
    """Draw uniformly among opening a plan and every step that any node could attempt."""

    def choose(self, tree: Tree[C], rng: np.random.Generator) -> Option:
        """Choose the next computational action."""
        options: list[Option] = [] if tree.exhausted else [OpenPlan()]
        options += tree.runs
        return options[rng.integers(len(options))]
