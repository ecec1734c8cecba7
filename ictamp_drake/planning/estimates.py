"""Estimates of steps, computed once for each."""

from collections.abc import Sequence
from typing import Generic

import numpy as np

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.protocols import Estimator
from ictamp_drake.core.types import C, Skeleton
from ictamp_drake.planning.tree import RunStep, Tree


class Estimates(Generic[C]):
    """Cache of the P of each step, that is, of each pair of node and plan.

    Args:
        estimator: Estimator of P.
    """

    def __init__(self, estimator: Estimator[C]) -> None:
        self._estimator = estimator
        self._known: dict[RunStep, float] = {}

    def look_up(self, tree: Tree[C], runs: Sequence[RunStep]) -> list[float]:
        """P of each step; one call of the estimator computes all unknown ones."""
        unknown = [run for run in runs if run not in self._known]
        if unknown:
            values = ask_estimator(self._estimator, [(tree.nodes[run.node].c, tree.plans[run.plan]) for run in unknown])
            self._known.update(zip(unknown, values, strict=True))
        return [self._known[run] for run in runs]


def ask_estimator(estimator: Estimator[C], options: Sequence[tuple[C, Skeleton]]) -> list[float]:
    """P of each option, as the estimator returns it.

    Raises:
        IctampError: The estimator did not return one probability for each option.
    """
    values = np.asarray(estimator.estimate(options), dtype=np.float64)
    name = type(estimator).__name__
    if values.shape != (len(options),):
        problem = f"expected P of shape {(len(options),)}, one for each option, got shape {{value}}"
        raise IctampError(Code.WRONG_LENGTH, problem, field=name, value=values.shape)
    for P in values[~((values >= 0) & (values <= 1))]:
        raise IctampError(Code.OUT_OF_RANGE, "expected P from 0 to 1, got {value}", field=name, value=float(P))
    return values.tolist()
