"""Your own selection rule: `python docs/examples/own_rule.py`."""

from dataclasses import dataclass
from pathlib import Path
from typing import Generic

import numpy as np

import ictamp_drake as ict
from ictamp_drake.plugins import C, OpenPlan, Option, RuleContext, Tree


@dataclass(frozen=True)
class PatientConfig:
    """Constants of the rule.

    Attributes:
        patience: failed steps until one more high-level plan is opened.
    """

    patience: int = 5

    def create(self, _: RuleContext[C]) -> "Patient[C]":
        """The rule for one search; its context has the estimator, for rules that ask for P."""
        return Patient(self.patience)


@dataclass(frozen=True)
class Patient(Generic[C]):
    """Runs what is nearest to the goal, each failure counting as one action more."""

    patience: int

    def choose(self, tree: Tree[C], _: np.random.Generator) -> Option:
        """The next computational action."""
        failures = sum(step.child is None for step in tree.steps)
        runs = tree.runs
        if not runs or (not tree.exhausted and len(tree.openings) <= failures // self.patience):
            return OpenPlan()
        return min(runs, key=lambda run: len(tree.plans[run.plan]) + tree.nodes[run.node].cnt[run.plan])


def main() -> None:
    method = ict.Method(sampler="optimization", estimator="constant", time_limit=250)
    task = ict.load(Path(__file__).with_name("own_scene.yaml"), method)
    result = ict.solve(task, method, planner=PatientConfig(patience=2)).result

    assert result.solved, result.stop_reason
    print(result.tree.summary())
    failures = result.failures.total()
    assert result.high_level_plans <= 1 + failures // 2


if __name__ == "__main__":
    main()
