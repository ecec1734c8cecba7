"""Strategies of the experiments by name, and the regimes under which they are compared."""

import re
import shlex
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import tyro

from ictamp_drake.core.checks import check_different
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.spelling import respell, respell_option
from ictamp_drake.estimators.monte_carlo import MonteCarloConfig
from ictamp_drake.estimators.q_value import QValueConfig
from ictamp_drake.planning.els import ElsConfig
from ictamp_drake.runs.jobs import check_folder_name
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
    "optimization-constant": Method(sampler="optimization", estimator="constant"),
}
"""Sampler, estimator and planner of each strategy. Strategies that need no estimator have the cheapest one."""


@dataclass(frozen=True)
class Regime:
    """Conditions under which strategies are compared.

    Attributes:
        method: Options that all strategies share.
        usual: Names of the strategies that run by default.
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
    "default": Regime(Method(time_limit=60.0), ("p-score", "adaptive", "optimization-constant")),
    "ceiling": Regime(replace(_ONE_DRAW, time_limit=3600.0, max_steps=300), ("p-score", "monte-carlo")),
}
"""Paper: one draw of k per step, which is not repeated when it has no motion. Default: the options of the package.
Ceiling: as in the paper, but limited only by steps, so that there is time to count the successes of each option.
"""

_NAME = re.compile(r"\w[\w.+-]*")
"""Pattern of a strategy's name, which is also a folder's name."""


def methods(regime: str, strategies: Sequence[str], seeds: Sequence[int]) -> Mapping[str, list[Method]]:
    """Return the methods of each strategy by name, one for each seed.

    Args:
        regime: Name of the regime.
        strategies: Names of strategies, or NAME=OPTIONS for a new one; by default the usual ones of the regime.
        seeds: Random seeds of the search.

    Raises:
        IctampError: A strategy does not exist, or two have the same name.
    """
    conditions = REGIMES[regime]
    found = [_parse_strategy(strategy, conditions.method) for strategy in strategies or conditions.usual]
    check_different("strategies", [name for name, _ in found])
    return {name: [replace(method, seed=seed) for seed in seeds] for name, method in found}


def _parse_strategy(strategy: str, shared: Method) -> tuple[str, Method]:
    """Return the name and the method of a strategy under the shared conditions."""
    name, defined, options = strategy.partition("=")
    name = respell(name)
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
    check_folder_name("strategies", name)
    try:
        arguments = [respell_option(each) for each in shlex.split(options)]
    except ValueError as error:
        problem = f"cannot read the options of {{value}}: {error}"
        raise IctampError(Code.NOT_READABLE, problem, field="strategies", value=strategy) from error
    if any(each.partition("=")[0] == "--seed" for each in arguments):
        problem, advice = "expected options without --seed, got {value}", "give --seeds, which all strategies share"
        raise IctampError(Code.CONFLICT, problem, field="strategies", value=strategy, advice=advice)
    return name, tyro.cli(Method, args=arguments, default=shared)


def _combine(shared: Method, strategy: Method) -> Method:
    """Apply a strategy to the conditions of a regime. The constants of samplers remain those of the regime."""
    return replace(
        shared,
        sampler=strategy.sampler,
        estimator=strategy.estimator,
        planner=strategy.planner,
        estimators=strategy.estimators,
        planners=strategy.planners,
    )
