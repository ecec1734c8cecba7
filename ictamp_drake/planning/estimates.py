"""What an estimator says of steps, asked once of each."""

from collections.abc import Sequence
from typing import Generic

from ictamp_drake.core.protocols import Estimator
from ictamp_drake.core.types import C
from ictamp_drake.planning.rule import RunStep
from ictamp_drake.planning.tree import Tree


class Estimates(Generic[C]):
    """P of steps by configuration and plan; as neither of a step ever changes, what is known stays known.

    Args:
        estimator: of P.
    """

    def __init__(self, estimator: Estimator[C]) -> None:
        self._estimator = estimator
        self._known: dict[RunStep, float] = {}

    def of(self, tree: Tree[C], runs: Sequence[RunStep]) -> list[float]:
        """P of each step; the estimator is asked for all unknown ones together."""
        unknown = [run for run in runs if run not in self._known]
        if unknown:
            values = self._estimator.estimate([(tree.nodes[run.node].c, tree.plans[run.plan]) for run in unknown])
            self._known.update(zip(unknown, values.tolist(), strict=True))
        return [self._known[run] for run in runs]
