"""The learned policy as a sampler, with untrained networks."""

import dataclasses
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.core.types import Action, Configuration, FloatArray, Skeleton
from ictamp_drake.learning.models import load_skill
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.observation.state_matrix import Observation, Observer
from ictamp_drake.skills.config import PolicyConfig, UniformConfig
from ictamp_drake.skills.context import SamplerContext
from ictamp_drake.skills.geometry import hand_poses
from ictamp_drake.skills.policy import PolicySampler
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World
from tests.learning.synthetic import write_untrained
from tests.panda import PANDA
from tests.refusals import refusal
from tests.skills.rig import KINEMATIC, pick, place, rig
from tests.world.scenes import arrange, far_boxes, hold_box, pose, scene


@pytest.fixture(scope="module")
def world() -> World:
    return World(scene(far_boxes()))


@pytest.fixture(scope="module")
def checkpoints(tmp_path_factory: pytest.TempPathFactory) -> Path:
    return write_untrained(tmp_path_factory.mktemp("checkpoints"))


@pytest.fixture(scope="module")
def arm(world: World) -> ArmKinematics:
    return ArmKinematics(PANDA, to_transform(world.spec.arm.X_WB))


def situations(world: World) -> list[tuple[Configuration, Action]]:
    c, held = world.initial_configuration(), hold_box(world, "yellow_box")
    return [
        (c, pick("cyan_box", "table")),
        (held, place("yellow_box", "rack")),
        (held, place("yellow_box", "cyan_box")),
    ]


@pytest.mark.parametrize("candidates", [1, 16])
def test_k_is_four_finite_numbers_that_the_seed_decides(
    world: World, arm: ArmKinematics, checkpoints: Path, candidates: int
) -> None:
    sampler = PolicyConfig(checkpoints, candidates).create(SamplerContext(world, arm))
    for c, action in situations(world):
        rng, again = np.random.default_rng(0), np.random.default_rng(0)
        first = [next(sampler.draws(c, action, rng)) for _ in range(3)]
        other = PolicyConfig(checkpoints, candidates).create(SamplerContext(world, arm))
        second = [next(other.draws(c, action, again)) for _ in range(3)]
        np.testing.assert_array_equal(first, second)
        assert np.shape(first) == (3, 4)
        assert first[0].dtype == np.float64
        assert np.all(np.isfinite(first))
        assert not np.isclose(first[0], first[1]).any()


@pytest.mark.parametrize("haste", [0.0, 0.02, 1.0])
def test_the_best_of_the_candidates_that_are_near_come_first(
    world: World, arm: ArmKinematics, checkpoints: Path, haste: float
) -> None:
    sampler = PolicyConfig(checkpoints, 16, haste, trust=16).create(SamplerContext(world, arm))
    for c, action in situations(world):
        model, observation = load_skill(checkpoints, action.name), Observer(world.spec).observe_all([(c, action)])
        candidates = model.draw(observation, 16, np.random.default_rng(5))
        times = arm.travel_times(hand_poses(world, c, action, candidates[0], arm.forward(c.q)), c.q)
        there = np.isfinite(times) | (haste == 0)
        worth = model.Q(observation, candidates)[0, there] - (haste * times[there] if haste else 0.0)
        ranked = np.array(list(islice(sampler.draws(c, action, np.random.default_rng(5)), 16)))
        np.testing.assert_array_equal(ranked[: there.sum()], candidates[0, there][np.argsort(-worth)])


@pytest.mark.parametrize("belief", [0.0, 1.0])
def test_candidates_of_the_policy_and_random_ones_that_the_critics_believe_in_take_turns(
    world: World, arm: ArmKinematics, checkpoints: Path, belief: float
) -> None:
    sampler = PolicyConfig(checkpoints, 16, haste=0.0, trust=3, belief=belief).create(SamplerContext(world, arm))
    for c, action in situations(world):
        model, observation = load_skill(checkpoints, action.name), Observer(world.spec).observe_all([(c, action)])
        rng, expected = np.random.default_rng(5), list[FloatArray]()
        for _ in range(2):
            learned = model.draw(observation, 16, rng)[0]
            uniform = np.array(
                list(islice(UniformConfig().create(SamplerContext(world, arm)).draws(c, action, rng), 16))
            )
            for k in (learned, uniform) if belief == 0 else (learned,):
                expected += list(k[np.argsort(-model.Q(observation, k[None])[0], kind="stable")][:3])
        found = islice(sampler.draws(c, action, np.random.default_rng(5)), len(expected))
        np.testing.assert_array_equal(list(found), expected)


def test_when_the_critics_believe_in_no_random_candidate_the_policy_goes_on(
    world: World, arm: ArmKinematics, checkpoints: Path
) -> None:
    sampler = PolicyConfig(checkpoints, 16, haste=0.05, trust=2, belief=1.0).create(SamplerContext(world, arm))
    for c, action in situations(world):
        found = np.array(list(islice(sampler.draws(c, action, np.random.default_rng(5)), 6)))
        assert found.shape == (6, 4)
        assert len(np.unique(found, axis=0)) == 6


class Noted(PolicySampler):
    """Records its calls."""

    def __init__(self, sampler: PolicySampler) -> None:
        vars(self).update(vars(sampler))
        self.asked: list[int] = []

    def _best(
        self, c: Configuration, action: Action, observation: Observation, k: FloatArray, least: float = 0.0
    ) -> FloatArray:
        self.asked.append(len(k))
        return super()._best(c, action, observation, k, least)


@pytest.mark.parametrize(
    ("candidates", "draws", "asked"), [(16, 4, [16]), (16, 8, [16, 16]), (4, 8, [4, 4]), (1, 3, [1])]
)
def test_candidates_are_drawn_when_those_before_are_refused(
    world: World, checkpoints: Path, candidates: int, draws: int, asked: list[int]
) -> None:
    far, action = arrange(world, {"red_box": pose(2.0, 0.0, 0.059)}), pick("red_box", "table")
    skills = rig(world.spec, PolicyConfig(checkpoints, candidates, belief=0.0), draws).skills
    assert isinstance(skills.sampler, PolicySampler)
    noted, step = Noted(skills.sampler), Skeleton((frozenset(), frozenset()), (action,))
    attempt = dataclasses.replace(skills, sampler=noted).attempt(far, step, np.random.default_rng(0))
    assert attempt.failure in KINEMATIC
    assert len(attempt.rejections) == draws - 1
    assert noted.asked == asked
    if candidates == 16:
        ranked = skills.sampler.draws(far, action, np.random.default_rng(0))
        np.testing.assert_array_equal(attempt.k, next(islice(ranked, draws - 1, None)))


def test_one_candidate_is_the_policys_plain_draw(world: World, arm: ArmKinematics, checkpoints: Path) -> None:
    c, action = situations(world)[0]
    observation = Observer(world.spec).observe_all([(c, action)])
    draw = load_skill(checkpoints, "pick").draw(observation, 1, np.random.default_rng(2))[0, 0]
    sampler = PolicyConfig(checkpoints, 1).create(SamplerContext(world, arm))
    np.testing.assert_array_equal(next(sampler.draws(c, action, np.random.default_rng(2))), draw)


def test_mistakes_are_refused(world: World, arm: ArmKinematics, tmp_path: Path) -> None:
    with refusal(Code.NOT_FOUND, file=tmp_path / "pick_policy.safetensors"):
        PolicyConfig(tmp_path).create(SamplerContext(world, arm))
    with refusal(Code.OUT_OF_RANGE, "samplers.policy.candidates", value=0):
        PolicyConfig(candidates=0)
    with refusal(Code.OUT_OF_RANGE, "samplers.policy.haste", value=-0.1):
        PolicyConfig(haste=-0.1)
    with refusal(Code.OUT_OF_RANGE, "samplers.policy.trust", value=0):
        PolicyConfig(trust=0)
    with refusal(Code.OUT_OF_RANGE, "samplers.policy.belief", value=1.5):
        PolicyConfig(belief=1.5)
