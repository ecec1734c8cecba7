"""The rows of the experiments: strategies by name, and the regimes under which they are compared."""

import re
import shlex
from collections.abc import Mapping, Sequence

import tyro

from ictamp_drake.core.checks import check_different
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.tamp.method import Method

_PRODUCT = (
    "--planner completion-tree --estimator q-value --estimators.q-value.horizon plan --estimators.q-value.draws 16 "
    "--estimators.q-value.best"
)
_ONE_DRAW = "--skills.draws 1 --samplers.policy.candidates 1"

STRATEGIES: dict[str, str] = {
    "p-score": "--planner completion-tree --estimator p-score",
    "p-product": f"{_PRODUCT} --estimators.q-value.critics estimator",
    "q-value": "--planner completion-tree --estimator q-value",
    "q-product": _PRODUCT,
    "constant": "--planner completion-tree --estimator constant",
    "monte-carlo": "--planner completion-tree --estimator monte-carlo --estimators.monte-carlo.executions 10",
    "adaptive": "--planner adaptive --estimator p-score",
    "round-robin": "--planner round-robin --estimator constant",
    "els-3-1": "--planner els --planners.els.p-w 3 --planners.els.p-c 1 --estimator constant",
    "els-1-1": "--planner els --planners.els.p-w 1 --planners.els.p-c 1 --estimator constant",
    "els-q": "--planner els --planners.els.weighted --estimator q-value",
    "uniform": "--planner uniform --estimator constant",
    "stap": "--planner stap --estimator q-value",
    "uniform-k": "--planner completion-tree --estimator p-score --sampler uniform",
    "optimisation-constant": "--planner completion-tree --estimator constant --sampler optimisation",
}
"""Options of each strategy; those that ask no estimator name the cheapest one."""

REGIMES: dict[str, tuple[str, tuple[str, ...]]] = {
    "paper": (
        f"{_ONE_DRAW} --time-limit 120 --max-steps 600",
        (
            "p-score",
            "p-product",
            "q-value",
            "q-product",
            "constant",
            "round-robin",
            "els-3-1",
            "els-1-1",
            "els-q",
            "stap",
            "adaptive",
        ),
    ),
    "default": ("--time-limit 60", ("p-score", "adaptive", "optimisation-constant")),
    "ceiling": (f"{_ONE_DRAW} --time-limit 3600 --max-steps 300", ("p-score", "monte-carlo")),
}
"""Options that all strategies share, and which are run unless told otherwise.

Paper: one draw of k a step, which is not drawn anew when it has no motion. Default: the options of the package.
Ceiling: the paper's, but limited by steps alone, so that counting the success of each option has all the time it takes.
"""


_NAME = re.compile(r"\w[\w.+-]*")
"""Of a strategy, and so of a folder for what it leaves."""


def methods(regime: str, strategies: Sequence[str], seeds: Sequence[int]) -> Mapping[str, list[Method]]:
    """For each strategy by name its method, once with each seed.

    Args:
        regime: name of a regime.
        strategies: names of strategies, or NAME=OPTIONS for one that has no name yet; by default those of the regime.
        seeds: of the search.

    Raises:
        IctampError: no such strategy, or two with the same name.
    """
    shared, usual = REGIMES[regime]
    named = [_parse_strategy(strategy) for strategy in strategies or usual]
    check_different("strategies", [name for name, _ in named])
    return {
        name: [tyro.cli(Method, args=[*shlex.split(shared), *options, "--seed", str(seed)]) for seed in seeds]
        for name, options in named
    }


def _parse_strategy(strategy: str) -> tuple[str, list[str]]:
    name, defined, options = strategy.partition("=")
    if not (defined and _NAME.fullmatch(name)) and strategy not in STRATEGIES:
        raise IctampError(
            Code.UNKNOWN_CHOICE,
            "expected the name of a strategy, or NAME=OPTIONS, got {value}",
            field="strategies",
            value=strategy,
            choices=STRATEGIES,
            advice='or give options with a name of letters, digits, _, ., + and -, e.g. "mine=--planner els"',
        )
    try:
        return name, shlex.split(options if defined else STRATEGIES[strategy])
    except ValueError as error:
        problem = f"cannot read the options of {{value}}: {error}"
        raise IctampError(Code.NOT_READABLE, problem, field="strategies", value=strategy) from error
