"""The rows of the experiments: strategies by name, and the regimes under which they are compared."""

import re
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import tyro

from ictamp_drake.core.checks import check_different
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.estimators.monte_carlo import MonteCarloConfig
from ictamp_drake.estimators.q_value import QValueConfig
from ictamp_drake.planning.els import ElsConfig
from ictamp_drake.skills.config import PolicyConfig, SkillsConfig
from ictamp_drake.tamp.method import Estimators, Method, Planners, Samplers

_PRODUCT = QValueConfig(horizon="plan", draws=16, best=True)

STRATEGIES: dict[str, Method] = {
    "p-score": Method(),
    "p-product": Method(estimator="q-value", estimators=Estimators(q_value=replace(_PRODUCT, critics="estimator"))),
    "q-value": Method(estimator="q-value"),
    "q-product": Method(estimator="q-value", estimators=Estimators(q_value=_PRODUCT)),
    "constant": Method(estimator="constant"),
    "monte-carlo": Method(estimator="monte-carlo", estimators=Estimators(monte_carlo=MonteCarloConfig(executions=10))),
    "adaptive": Method(planner="adaptive"),
    "round-robin": Method(planner="round-robin", estimator="constant"),
    "els-3-1": Method(planner="els", estimator="constant", planners=Planners(els=ElsConfig(p_w=3.0, p_c=1.0))),
    "els-1-1": Method(planner="els", estimator="constant", planners=Planners(els=ElsConfig(p_w=1.0, p_c=1.0))),
    "els-q": Method(planner="els", estimator="q-value", planners=Planners(els=ElsConfig(weighted=True))),
    "uniform": Method(planner="uniform", estimator="constant"),
    "stap": Method(planner="stap", estimator="q-value"),
    "uniform-k": Method(sampler="uniform"),
    "optimisation-constant": Method(sampler="optimisation", estimator="constant"),
}
"""Sampler, estimator and planner of each strategy; those that ask no estimator name the cheapest one."""


@dataclass(frozen=True)
class Regime:
    """Conditions under which strategies are compared.

    Attributes:
        method: What all strategies have in common.
        usual: Names of the strategies that are run unless told otherwise.
    """

    method: Method
    usual: tuple[str, ...]


_ONE_DRAW = Method(skills=SkillsConfig(draws=1), samplers=Samplers(policy=PolicyConfig(candidates=1)))

REGIMES: dict[str, Regime] = {
    "paper": Regime(
        replace(_ONE_DRAW, time_limit=120.0, max_steps=600),
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
    "default": Regime(Method(time_limit=60.0), ("p-score", "adaptive", "optimisation-constant")),
    "ceiling": Regime(replace(_ONE_DRAW, time_limit=3600.0, max_steps=300), ("p-score", "monte-carlo")),
}
"""Paper: one draw of k a step, which is not drawn anew when it has no motion. Default: the options of the package.
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
    conditions = REGIMES[regime]
    found = [_parse_strategy(strategy, conditions.method) for strategy in strategies or conditions.usual]
    check_different("strategies", [name for name, _ in found])
    return {name: [replace(method, seed=seed) for seed in seeds] for name, method in found}


def _parse_strategy(strategy: str, shared: Method) -> tuple[str, Method]:
    """Name and method of a strategy under the conditions that all share."""
    name, defined, options = strategy.partition("=")
    if not defined and name in STRATEGIES:
        return name, _combine(shared, STRATEGIES[name])
    if not (defined and _NAME.fullmatch(name)):
        raise IctampError(
            Code.UNKNOWN_CHOICE,
            "expected the name of a strategy, or NAME=OPTIONS, got {value}",
            field="strategies",
            value=strategy,
            choices=STRATEGIES,
            advice='or give options with a name of letters, digits, _, ., + and -, e.g. "mine=--planner els"',
        )
    try:
        return name, tyro.cli(Method, args=shlex.split(options), default=shared)
    except ValueError as error:
        problem = f"cannot read the options of {{value}}: {error}"
        raise IctampError(Code.NOT_READABLE, problem, field="strategies", value=strategy) from error


def _combine(shared: Method, strategy: Method) -> Method:
    """The conditions of a regime with all that a strategy says: its constants of samplers are those of the regime."""
    return replace(
        shared,
        sampler=strategy.sampler,
        estimator=strategy.estimator,
        planner=strategy.planner,
        estimators=strategy.estimators,
        planners=strategy.planners,
    )
