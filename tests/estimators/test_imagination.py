"""Imagined plans: each step starts where the previous one ends."""

import numpy as np
import pytest

from ictamp_drake.core.types import Action, Configuration, FloatArray, Skeleton
from ictamp_drake.estimators.imagination import Imagination, Rollouts, refine
from ictamp_drake.learning.checkpoint import SKILLS
from ictamp_drake.learning.models import DynamicsModel, SkillModel, load_dynamics, load_skill
from ictamp_drake.observation.state_matrix import Observer
from ictamp_drake.world.world import World
from tests.learning.synthetic import write_untrained
from tests.world.scenes import far_boxes, hold_box, scene

WORLD = World(scene(far_boxes()))
OBSERVER = Observer(WORLD.spec)
PICK, PLACE = Action("pick", ("red_box", "table")), Action("place", ("red_box", "cyan_box"))
Option = tuple[Configuration, Skeleton]


@pytest.fixture(scope="module")
def learned(tmp_path_factory: pytest.TempPathFactory) -> tuple[dict[str, SkillModel], dict[str, DynamicsModel]]:
    folder = write_untrained(tmp_path_factory.mktemp("checkpoints"))
    return {each: load_skill(folder, each) for each in SKILLS}, {each: load_dynamics(folder, each) for each in SKILLS}


@pytest.fixture(scope="module")
def imagination(learned: tuple[dict[str, SkillModel], dict[str, DynamicsModel]]) -> Imagination:
    return Imagination(OBSERVER, *learned)


def option(c: Configuration, *actions: Action) -> Option:
    return c, Skeleton((frozenset(),) * (len(actions) + 1), actions)


def options() -> list[Option]:
    """Plans of unequal lengths that begin with either skill."""
    c, held = WORLD.initial_configuration(), hold_box(WORLD, "red_box")
    return [option(c, PICK, PLACE, PICK), option(held, PLACE), option(held, PLACE, PICK), option(c, PICK)]


def run(imagination: Imagination, asked: list[Option], runs: int, given: FloatArray | None = None) -> Rollouts:
    return imagination.run(asked, runs, np.random.default_rng(0), given)


def test_every_step_is_judged_where_the_one_before_left_its_box(
    imagination: Imagination, learned: tuple[dict[str, SkillModel], dict[str, DynamicsModel]]
) -> None:
    skills, dynamics = learned
    k, product = run(imagination, options(), 2)
    for number, (c, plan) in enumerate(options()):
        for rollout in range(2):
            situations, expected = OBSERVER.situations([c]), 1.0
            for action, chosen in zip(plan.actions, k[number, rollout], strict=False):
                seen, steps = OBSERVER.see(situations, OBSERVER.steps([action])), OBSERVER.steps([action])
                expected *= skills[action.name].Q(seen, chosen[None, None])[0, 0]
                moved = dynamics[action.name].predict(seen, chosen[None])
                situations = situations.predict_after(steps, chosen[None], moved)
            np.testing.assert_allclose(product[number, rollout], expected, rtol=1e-4)


def test_runs_of_a_plan_differ_and_k_is_zero_after_its_end(imagination: Imagination) -> None:
    k, product = run(imagination, options(), 3)
    assert k.shape == (4, 3, 3, 4)
    assert product.shape == (4, 3)
    assert all(len(set(products.tolist())) == 3 for products in product)
    lengths = [len(plan) for _, plan in options()]
    assert all(k[number, :, :length].all() for number, length in enumerate(lengths))
    assert not any(k[number, :, length:].any() for number, length in enumerate(lengths))


def test_the_same_k_again_have_the_same_product_whatever_else_is_run(imagination: Imagination) -> None:
    k, product = run(imagination, options(), 3)
    np.testing.assert_allclose(run(imagination, options(), 3, k).product, product, rtol=1e-5)
    for number, asked in enumerate(options()):
        given = k[number : number + 1, :, : len(asked[1])]
        np.testing.assert_allclose(run(imagination, [asked], 3, given).product[0], product[number], rtol=1e-4)


def test_a_depth_of_one_sees_the_first_step_only(
    imagination: Imagination, learned: tuple[dict[str, SkillModel], dict[str, DynamicsModel]]
) -> None:
    first = [option(c, plan.actions[0]) for c, plan in options()]
    shallow = run(Imagination(OBSERVER, learned[0], {}, depth=1), options(), 2)
    np.testing.assert_array_equal(shallow.product, run(imagination, first, 2).product)


def test_refinement_keeps_the_best_and_gathers_around_them() -> None:
    rng = np.random.default_rng(0)
    k = rng.normal(size=(3, 400, 2, 4))
    wanted = np.array([0.5, -0.5, 0.2, 1.0])
    product = np.exp(-np.square(k - wanted).sum(axis=(2, 3)))
    new = refine(Rollouts(k, product), rng)
    assert new.shape == k.shape
    np.testing.assert_array_equal(new[:, 0], k[np.arange(3), product.argmax(axis=1)])
    assert np.exp(-np.square(new - wanted).sum(axis=(2, 3))).mean() > 2 * product.mean()


def test_yaws_on_both_sides_of_a_half_turn_are_neighbours() -> None:
    rng = np.random.default_rng(0)
    k = np.zeros((1, 64, 1, 4))
    k[..., 3] = np.pi - 0.1 * rng.random((1, 64, 1))
    k[:, ::2, :, 3] *= -1
    yaw = refine(Rollouts(k, rng.random((1, 64))), rng)[..., 3]
    assert (np.abs(yaw) > np.pi - 0.4).all()
    assert (np.abs(yaw) <= np.pi).all()
