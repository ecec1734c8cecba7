"""The command line that is derived from the options."""

import math
import re
from collections.abc import Iterator
from dataclasses import asdict, fields, is_dataclass, replace
from pathlib import Path
from typing import Any

import pytest
import tyro

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.protocols import Config
from ictamp_drake.estimators.constant import ConstantConfig
from ictamp_drake.estimators.p_score import PScoreConfig
from ictamp_drake.estimators.q_value import QValueConfig
from ictamp_drake.planning.els import ElsConfig
from ictamp_drake.planning.stap import StapConfig
from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.engine import EngineConfig
from ictamp_drake.skills.config import PolicyConfig, UniformConfig
from ictamp_drake.symbolic.skeletons import BestFirst
from ictamp_drake.tamp.method import Estimators, Generators, Method, Planners, Samplers
from tests.refusals import refusal

NOWHERE = Path("nowhere")


def test_every_constant_can_be_set_on_the_command_line() -> None:
    method = tyro.cli(
        Method,
        args=[
            *("--planners.completion-tree.W", "7", "--planners.els.p-w", "3", "--planner", "els"),
            *("--samplers.optimization.restarts", "3", "--physics.time-step", "0.002"),
            *("--skills.pick.force", "20", "--generators.best-first.weight", "1.5", "--predicates.tilt", "0.2"),
            *("--estimators.constant.P", "0.5", "--skills.motion.padding", "0.01"),
            *("--samplers.policy.candidates", "1", "--estimators.q-value.draws", "8"),
        ],
    )
    assert method.planner == "els"
    assert method.planners.completion_tree.W == 7
    assert method.planners.els.p_w == 3
    assert method.samplers.optimization.restarts == 3
    assert method.physics.time_step == 0.002
    assert method.skills.pick.force == 20
    assert method.skills.motion.padding == 0.01
    assert method.generators.best_first.weight == 1.5
    assert method.predicates.tilt == 0.2
    assert method.estimators.constant.P == 0.5
    assert method.samplers.policy.candidates == 1
    assert method.estimators.q_value.draws == 8


def _constants(config: Any, where: str = "") -> Iterator[tuple[str, Any, str]]:
    """Each option, with the dataclass and the field that it sets."""
    for field in fields(config):
        value, option = getattr(config, field.name), where + field.name.replace("_", "-")
        yield from _constants(value, f"{option}.") if is_dataclass(value) else [(option, config, field.name)]


CONSTANTS = {option: (config, name) for option, config, name in _constants(Method())}
CHECKED = ("skills.pick", "skills.place", "skills.motion", "physics", "predicates", "samplers")


@pytest.mark.parametrize("option", CONSTANTS)
def test_every_constant_has_a_line_of_help(option: str) -> None:
    config, name = CONSTANTS[option]
    assert re.search(rf"^ +{name}: \S", config.__doc__, re.MULTILINE), "what tyro reads is one attribute a line"


@pytest.mark.parametrize("option", [option for option in CONSTANTS if option.startswith(CHECKED)])
def test_constants_that_are_no_number_are_refused_by_the_name_of_their_option(option: str) -> None:
    config, name = CONSTANTS[option]
    value = getattr(config, name)
    if isinstance(value, float):
        with refusal(Code.OUT_OF_RANGE, option, value=math.nan):
            replace(config, **{name: math.nan})
    if isinstance(value, tuple) and value and isinstance(value[0], float):
        with refusal(Code.OUT_OF_RANGE, option):
            replace(config, **{name: (math.nan, *value[1:])})


def test_without_options_the_command_line_gives_the_defaults() -> None:
    assert tyro.cli(Method, args=[]) == Method()


@pytest.mark.parametrize(
    ("method", "families"),
    [
        (Method(), ("policy", "p_score", "breadth_first", "completion_tree")),
        (
            Method(sampler="uniform", estimator="constant", generator="best-first", planner="round-robin"),
            ("uniform", "constant", "best_first", "round_robin"),
        ),
        (Method(planner="stap", estimator="constant"), ("policy", "q_value", "breadth_first", "stap")),
    ],
)
def test_only_constants_of_what_is_used_decide(method: Method, families: tuple[str, ...]) -> None:
    kept = [method.decisive[family] for family in ("samplers", "estimators", "generators", "planners")]
    assert [tuple(constants) for constants in kept] == [(name,) for name in families]
    assert method.decisive["skills"] == asdict(method.skills)


@pytest.mark.parametrize(
    "configs", [Samplers(), Estimators(), Generators(), Planners()], ids=lambda configs: type(configs).__name__
)
def test_each_choice_names_a_configuration(configs: Samplers | Estimators | Generators | Planners) -> None:
    by_name = configs.by_name()
    assert [name.replace("-", "_") for name in by_name] == [field.name for field in fields(configs)]
    assert list(by_name.values()) == [getattr(configs, field.name) for field in fields(configs)]
    assert all(isinstance(config, Config) for config in by_name.values())
    assert not any("_" in name for name in by_name)


def test_the_defaults_are_among_the_choices() -> None:
    method = Method()
    assert method.sampler in Samplers().by_name()
    assert method.estimator in Estimators().by_name()
    assert method.generator in Generators().by_name()
    assert method.planner in Planners().by_name()


def test_names_can_be_written_both_ways() -> None:
    method = tyro.cli(Method, args=["--estimator", "p_score", "--generator", "best-first", "--sampler", "policy"])
    assert (method.estimator, method.generator, method.sampler) == ("p-score", "best-first", "policy")
    assert Method(estimator="p_score") == Method(estimator="p-score")


def test_the_chosen_planner_is_the_rule_of_the_search() -> None:
    known = Planners().by_name()
    assert {name: Method(planner=name).rule_config for name in known} == known


def test_a_method_names_the_parts_of_its_search() -> None:
    method = Method(sampler="uniform", estimator="constant", generator="best-first", planner="els")
    found = (method.sampler_config, method.estimator_config, method.generator_config, method.rule_config)
    assert found == (UniformConfig(), ConstantConfig(), BestFirst(), ElsConfig())


def test_stap_asks_for_the_product_along_the_plan_whatever_the_estimator() -> None:
    method = Method(planner="stap", planners=Planners(stap=StapConfig(draws=7, iterations=3)))
    assert method.estimator_config == QValueConfig(horizon="plan", best=True, draws=7, refinements=3)
    assert Method().estimator_config == PScoreConfig()


@pytest.mark.parametrize(("elapsed", "left"), [(0.0, 10.0), (4.0, 6.0), (12.0, 0.0)])
def test_the_planner_gets_what_is_left_of_the_time(elapsed: float, left: float) -> None:
    method = Method(time_limit=10.0, max_steps=5)
    budget = method.budget(elapsed, cpu_elapsed=1.0)
    assert budget.seconds == left
    assert budget.steps == 5
    assert budget.cpu_seconds is None
    assert replace(method, cpu_limit=10.0).budget(0.0, cpu_elapsed=elapsed).cpu_seconds == left


@pytest.mark.parametrize(
    "bad",
    [
        lambda: Method(time_limit=-1.0),
        lambda: Method(time_limit=float("nan")),
        lambda: Method(cpu_limit=-1.0),
        lambda: Method(cpu_limit=float("nan")),
        lambda: Method(max_steps=-1),
        lambda: Method(seed=-1),
        lambda: Method(sampler="best_first"),
        lambda: Method(estimator=""),
        lambda: Method(generator="depth-first"),
        lambda: Method(planner="breadth-first"),
        lambda: Method(max_expansions=0),
        lambda: EngineConfig(workers=0),
        lambda: Conduct(grace=-1.0),
    ],
)
def test_senseless_values_are_refused(bad) -> None:  # type: ignore[no-untyped-def]
    with pytest.raises(IctampError) as caught:
        bad()
    assert caught.value.code in (Code.OUT_OF_RANGE, Code.UNKNOWN_CHOICE)


@pytest.mark.parametrize(
    ("method", "missing"),
    [
        (Method(sampler="policy", samplers=Samplers(policy=PolicyConfig(NOWHERE))), "pick_policy"),
        (Method(estimator="p-score", estimators=Estimators(p_score=PScoreConfig(NOWHERE))), "pick_estimator"),
        (Method(estimator="q-value", estimators=Estimators(q_value=QValueConfig(NOWHERE))), "pick_policy"),
    ],
    ids=lambda value: value if isinstance(value, str) else "",
)
def test_missing_checkpoints_are_noticed_before_a_run(method: Method, missing: str) -> None:
    with refusal(Code.NOT_FOUND, file=NOWHERE / f"{missing}.safetensors"):
        method.check()
    Method().check()


def test_the_live_view_takes_one_worker() -> None:
    assert Conduct(meshcat=True, engine=EngineConfig(workers=4)).engine.workers == 1
