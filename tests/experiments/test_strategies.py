"""The strategies of the experiments: their options, and strategies that users define."""

import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.experiments.strategies import REGIMES, STRATEGIES, methods
from tests.refusals import refusal


@pytest.mark.parametrize("regime", REGIMES)
def test_every_strategy_has_options_that_are_understood(regime: str) -> None:
    found = methods(regime, list(STRATEGIES), [0])
    assert list(found) == list(STRATEGIES)
    assert len({repr(method) for (method,) in found.values()}) == len(STRATEGIES)


@pytest.mark.parametrize("regime", REGIMES)
def test_a_regime_has_usual_strategies(regime: str) -> None:
    assert list(methods(regime, (), [0])) == list(REGIMES[regime].usual)


def test_the_papers_regime_draws_once_and_limits_time_and_steps() -> None:
    for (method,) in methods("paper", (), [0]).values():
        assert method.skills.draws == method.samplers.policy.candidates == 1
        assert (method.time_limit, method.max_steps) == (120.0, 600)


@pytest.mark.parametrize("options", ["--seed 5", "--planner els --seed=5"])
def test_a_strategy_has_no_seed_of_its_own(options: str) -> None:
    with refusal(Code.CONFLICT, "strategies", value=f"mine={options}"):
        methods("default", [f"mine={options}"], [0])


def test_a_strategy_is_run_with_every_seed() -> None:
    seeded = methods("default", ["adaptive"], [3, 5])["adaptive"]
    assert [method.seed for method in seeded] == [3, 5]


def test_a_strategy_of_ones_own_is_named_with_its_options() -> None:
    (mine,) = methods("default", ["mine=--planner els --planners.els.p-w 2"], [0])["mine"]
    assert mine.planner == "els"
    assert mine.planners.els.p_w == 2


@pytest.mark.parametrize("name", ["best", "a/b=--planner els", "..=--planner els", "=--planner els"])
def test_what_is_no_strategy_is_refused_with_the_names_that_are(name: str) -> None:
    with refusal(Code.UNKNOWN_CHOICE, "strategies", value=name, choices=tuple(STRATEGIES)):
        methods("paper", [name], [0])


@pytest.mark.parametrize("name", ["results.jsonl", "config.yaml", "index.html", 201 * "a"])
def test_a_strategy_does_not_take_the_name_of_a_file_of_the_run(name: str) -> None:
    with refusal(Code.BAD_NAME, "strategies", value=name):
        methods("paper", [f"{name}=--planner els"], [0])


@pytest.mark.parametrize("names", [["stap", "stap"], ["mine=--planner els", "mine=--planner stap"]])
def test_strategies_of_the_same_name_are_refused(names: list[str]) -> None:
    with refusal(Code.REPEATED, "strategies", value=names[0].partition("=")[0]):
        methods("paper", names, [0])


def test_options_with_an_open_quotation_are_refused() -> None:
    with refusal(Code.NOT_READABLE, "strategies"):
        methods("paper", ["mine=--planner 'els"], [0])
