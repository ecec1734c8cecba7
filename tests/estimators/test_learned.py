"""The contract of learned estimators, with untrained networks."""

from collections.abc import Callable
from functools import partial
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple

import numpy as np
import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.core.protocols import Estimator
from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.core.types import Action, Attempt, Configuration, FloatArray, Skeleton
from ictamp_drake.estimators.context import EstimatorContext
from ictamp_drake.estimators.imagination import Imagination
from ictamp_drake.estimators.p_score import PScore, PScoreConfig
from ictamp_drake.estimators.q_value import QValueConfig
from ictamp_drake.learning.checkpoint import SKILLS
from ictamp_drake.learning.models import load_dynamics, load_skill
from ictamp_drake.observation.state_matrix import Observer
from ictamp_drake.world.world import World
from tests.learning.synthetic import write_untrained
from tests.refusals import refusal
from tests.world.scenes import far_boxes, hold_box, scene

Config = Callable[[Path], PScoreConfig | QValueConfig]
CONFIGS: dict[str, Config] = {
    "p_score": PScoreConfig,
    "q_value": QValueConfig,
    "q_value_plan": partial(QValueConfig, horizon="plan"),
    "q_value_of_P": partial(QValueConfig, critics="estimator"),
    "q_value_refined": partial(QValueConfig, draws=8, best=True, horizon="plan", refinements=2),
}


@pytest.fixture(scope="module")
def world() -> World:
    return World(scene(far_boxes()))


@pytest.fixture(scope="module")
def checkpoints(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_untrained(tmp_path_factory.mktemp("checkpoints"))


@pytest.fixture(params=list(CONFIGS))
def config(request: pytest.FixtureRequest) -> Config:
    return CONFIGS[request.param]


class Draws(NamedTuple):
    """The part of the skills that an estimator uses."""

    draws: int
    attempt: Callable[..., Attempt[Configuration]] = lambda *_: pytest.fail("the estimator runs no skill")


def option(c: Configuration, *actions: Action) -> tuple[Configuration, Skeleton]:
    return c, Skeleton((frozenset(),) * (len(actions) + 1), actions)


def options(world: World) -> list[tuple[Configuration, Skeleton]]:
    c, held = world.initial_configuration(), hold_box(world, "yellow_box")
    picks = [option(c, Action("pick", (box, "table"))) for box in ("cyan_box", "red_box", "blue_box")]
    places = [option(held, Action("place", ("yellow_box", where))) for where in ("rack", "table", "cyan_box")]
    return [each for pair in zip(picks, places, strict=True) for each in pair]


def test_every_option_gets_a_probability_of_its_own(config: Config, world: World, checkpoints: Path) -> None:
    P = config(checkpoints).create(EstimatorContext(world)).estimate(options(world))
    assert P.shape == (6,)
    assert P.dtype == np.float64
    assert ((P > 0) & (P < 1)).all()
    assert len(set(P.tolist())) == 6


def test_no_options_are_no_trouble(config: Config, world: World, checkpoints: Path) -> None:
    assert config(checkpoints).create(EstimatorContext(world)).estimate([]).shape == (0,)


def test_the_same_question_has_the_same_answer(config: Config, world: World, checkpoints: Path) -> None:
    asked = options(world)
    estimator: Estimator[Configuration] = config(checkpoints).create(EstimatorContext(world))
    first = estimator.estimate(asked)
    estimator.estimate(asked[2:])
    np.testing.assert_array_equal(estimator.estimate(asked), first)
    np.testing.assert_array_equal(config(checkpoints).create(EstimatorContext(world)).estimate(asked), first)


def test_P_does_not_depend_on_what_else_is_asked(world: World, checkpoints: Path) -> None:
    asked, estimator = options(world), PScoreConfig(checkpoints).create(EstimatorContext(world))
    whole = estimator.estimate(asked)
    alone = [float(estimator.estimate([option])[0]) for option in asked]
    np.testing.assert_allclose(whole, alone, rtol=1e-5)
    np.testing.assert_allclose(estimator.estimate(asked[::-1]), whole[::-1], rtol=1e-5)


def test_a_step_that_may_draw_more_k_is_likelier_to_succeed(world: World, checkpoints: Path) -> None:
    asked = options(world)
    P = [
        PScoreConfig(checkpoints).create(context).estimate(asked)
        for context in (EstimatorContext(world), *(EstimatorContext(world, Draws(draws)) for draws in (1, 8)))
    ]
    np.testing.assert_array_equal(P[0], P[1])
    assert ((P[2] > P[1]) & (P[2] < 1)).all()


def test_P_comes_with_an_uncertainty(world: World, checkpoints: Path) -> None:
    estimator = PScoreConfig(checkpoints).create(EstimatorContext(world))
    assert isinstance(estimator, PScore)
    P, std = estimator.estimate_with_spread(options(world))
    np.testing.assert_array_equal(P, estimator.estimate(options(world)))
    assert ((std > 0) & (std < 0.5)).all()


def test_more_draws_raise_the_best_Q_and_not_the_mean(world: World, checkpoints: Path) -> None:
    asked = options(world)

    def Q(draws: int, best: bool) -> float:
        return float(QValueConfig(checkpoints, draws, best).create(EstimatorContext(world)).estimate(asked).mean())

    assert Q(64, best=True) > Q(4, best=True) > Q(4, best=False)
    assert abs(Q(64, best=False) - Q(256, best=False)) < (Q(64, best=True) - Q(64, best=False)) / 2


def test_the_mean_of_the_critics_of_P_is_P(world: World) -> None:
    configs = (PScoreConfig(draws=1024), QValueConfig(draws=1024), QValueConfig(draws=1024, critics="estimator"))
    P, of_Q, of_P = (config.create(EstimatorContext(world)).estimate(options(world)) for config in configs)
    np.testing.assert_allclose(of_P, P, atol=0.01)
    assert np.abs(of_Q - P).max() > 0.02


def plans(world: World, steps: int) -> list[tuple[Configuration, Skeleton]]:
    """Options whose first steps differ in skill, followed by `steps` further steps, the same in all."""
    rest = [Action("pick", ("cyan_box", "table")), Action("place", ("cyan_box", "red_box"))] * steps
    return [(c, option(c, *plan.actions, *rest[:steps])[1]) for c, plan in options(world)]


def test_a_plan_of_one_step_is_worth_that_step(world: World, checkpoints: Path) -> None:
    step, plan = (
        QValueConfig(checkpoints, 4, horizon=horizon).create(EstimatorContext(world)) for horizon in ("step", "plan")
    )
    np.testing.assert_array_equal(step.estimate(options(world)), plan.estimate(options(world)))
    np.testing.assert_array_equal(step.estimate(plans(world, 3)), step.estimate(options(world)))


@pytest.mark.parametrize("best", [False, True])
def test_no_further_step_makes_a_plan_likelier(best: bool, world: World, checkpoints: Path) -> None:
    estimator = QValueConfig(checkpoints, 8, best, horizon="plan").create(EstimatorContext(world))
    values = [estimator.estimate(plans(world, steps)) for steps in range(5)]
    for shorter, longer in pairwise(values):
        assert ((longer > 0) & (longer < shorter)).all()


def test_refinements_find_better_k_and_never_worse_ones(world: World, checkpoints: Path) -> None:
    asked = plans(world, 2)

    def value(refinements: int) -> FloatArray:
        config = QValueConfig(checkpoints, 32, best=True, horizon="plan", refinements=refinements)
        return config.create(EstimatorContext(world)).estimate(asked)

    values = [value(refinements) for refinements in (0, 1, 5)]
    for fewer, more in pairwise(values):
        assert (more >= fewer - 1e-6).all()
    assert (values[-1] > values[0]).all()


def test_optimized_parameters_are_those_of_the_greatest_product(world: World, checkpoints: Path) -> None:
    asked = [*plans(world, 0)[:2], *plans(world, 2)]  # plans of two lengths
    estimator = QValueConfig(checkpoints, 16, best=True, horizon="plan", refinements=2).create(EstimatorContext(world))
    found = estimator.optimize(asked, generator(Stream.EVALUATION, world.spec.seed))
    assert [value for value, _ in found] == estimator.estimate(asked).tolist()
    skills, dynamics = ({each: load(checkpoints, each) for each in SKILLS} for load in (load_skill, load_dynamics))
    imagination = Imagination(Observer(world.spec), skills, dynamics)
    for (value, k), (c, plan) in zip(found, asked, strict=True):
        assert k.shape == (len(plan), 4)
        again = imagination.run([(c, plan)], 1, np.random.default_rng(0), k[None, None])
        assert again.product.item() == pytest.approx(value, rel=1e-4)


def test_the_plan_needs_dynamics_and_the_step_does_not(world: World, tmp_path: Path) -> None:
    write_untrained(tmp_path)
    for horizon in ("step", "plan"):
        QValueConfig(tmp_path, horizon=horizon).check()
    (tmp_path / "place_dynamics.safetensors").unlink()
    QValueConfig(tmp_path).check()
    assert QValueConfig(tmp_path).create(EstimatorContext(world)).estimate(options(world)).shape == (6,)
    ahead = QValueConfig(tmp_path, horizon="plan")
    for ask in (ahead.check, partial(ahead.create, EstimatorContext(world))):
        with refusal(Code.NOT_FOUND, file=tmp_path / "place_dynamics.safetensors"):
            ask()


def test_mistakes_are_refused(config: Config, world: World, tmp_path: Path) -> None:
    with refusal(Code.NOT_FOUND):
        config(tmp_path).create(EstimatorContext(world))
    with refusal(Code.OUT_OF_RANGE, "estimators.q-value.draws", value=0):
        QValueConfig(draws=0)
    with refusal(Code.CONFLICT, "estimators.q-value.refinements", value=1):
        QValueConfig(refinements=1)
