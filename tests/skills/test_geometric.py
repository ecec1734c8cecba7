"""Grasps and placements from geometry, and where the policy gives way to them."""

from dataclasses import dataclass
from itertools import islice
from pathlib import Path

import numpy as np
import pytest

from ictamp_drake.core.types import Action, Configuration, FloatArray
from ictamp_drake.learning.clearance import PALM
from ictamp_drake.scenes.levels import LEVELS, problem_files
from ictamp_drake.scenes.spec import SceneSpec, load_scene
from ictamp_drake.skills.context import SamplerContext
from ictamp_drake.skills.geometric import LEAST_COVER, GeometricSampler
from ictamp_drake.skills.geometry import grasp_pose
from ictamp_drake.skills.neighbours import is_covered, neighbours
from ictamp_drake.skills.policy import LEARNED_SIDES, LEARNED_TOP
from ictamp_drake.world.world import World
from tests.panda import MAX_SIDE, PAD_HALF_HEIGHT
from tests.skills.rig import Rig, pick, place, rig

CASES = Path(__file__).parents[1] / "scenes" / "cases"
FLAT = {"plate": ("f4-flat-plate", pick("plate", "table")), "die": ("dice", pick("red", "table"))}


@dataclass(frozen=True)
class Geometric:
    """Chooses the geometric sampler."""

    def create(self, context: SamplerContext) -> GeometricSampler:
        """The sampler for one scene."""
        return GeometricSampler(context.world, context.arm)


def setup(case: str) -> Rig:
    return rig(load_scene(CASES / f"{case}.yaml"), Geometric())


def draw(setup: Rig, c: Configuration, action: Action, count: int = 40) -> FloatArray:
    return np.array(list(islice(setup.skills.sampler.draws(c, action, np.random.default_rng(0)), count)))


@pytest.mark.parametrize(("case", "action"), FLAT.values(), ids=FLAT)
def test_flat_boxes_are_gripped_above_the_ground_and_with_cover(case: str, action: Action) -> None:
    here = setup(case)
    lying = here.world.upright_frame(here.start, action.args[0])
    k = draw(here, here.start, action)
    assert len(k) == 40
    assert np.all(k[:, 2] + lying.size[2] / 2 >= PAD_HALF_HEIGHT)  # the box stands on the ground
    assert np.all(lying.size[2] / 2 - (k[:, 2] - PAD_HALF_HEIGHT) >= LEAST_COVER)
    for x, y, _, yaw in k:
        quarter = round(yaw / (np.pi / 2))
        assert abs(yaw - quarter * np.pi / 2) < 0.1
        assert lying.size[1 - quarter % 2] <= MAX_SIDE
        assert (x, y)[1 - quarter % 2] == 0
        assert abs((x, y)[quarter % 2]) <= lying.size[quarter % 2] / 2


def test_grasps_are_all_along_the_side_and_the_middle_comes_first() -> None:
    here = setup("f4-flat-plate")
    k = draw(here, here.start, pick("plate", "table"), 200)
    across = np.abs(k[np.abs(k[:, 1]) > 0][:, 1])
    assert across.max() > 0.04
    firsts = [np.linalg.norm(draw(here, here.start, pick("plate", "table"), 1)[0, :2])]
    assert max(firsts) < 0.01


def test_only_the_free_end_of_a_covered_bar_is_gripped() -> None:
    here = setup("half-covered-bar")
    action = pick("bar", "table")
    board = next(each for each in neighbours(here.world, here.start, {"bar"}, 0.1) if each.top > 0.1)
    k = draw(here, here.start, action)
    assert len(k) == 40
    p_WG = np.array([grasp_pose(here.world, here.start, "bar", each).translation() for each in k])
    assert np.all(board.distance(p_WG) >= PALM[0] - 1e-3)
    attempts = [here.attempt(here.start, action, seed, k[seed]) for seed in range(8)]
    assert sum(attempt.failure is None for attempt in attempts) >= 5


def test_a_die_is_put_on_a_die_and_on_the_tray() -> None:
    here = setup("dice")
    held = here.attempt(here.start, pick("red", "table")).successor
    assert held is not None
    for action in (place("red", "green"), place("red", "tray")):
        half = here.world.top_size(held, action.args[1]) / 2
        k = draw(here, held, action)
        assert len(k) == 40
        assert np.all(np.abs(k[:, :2]) <= half)
        assert any(here.attempt(held, action, seed).failure is None for seed in range(3))


def test_there_is_no_k_beyond_reach() -> None:
    spec = load_scene(CASES / "f4-flat-plate.yaml")
    here = rig(spec, Geometric())
    far = Configuration(here.start.q, here.start.fingers, {"plate": here.start.poses["plate"] + [0, 0, 0, 0, 2, 0, 0]})
    assert len(draw(here, far, pick("plate", "table"))) == 0


@pytest.mark.parametrize("level", LEVELS)
def test_the_policy_applies_to_the_levels(level: str) -> None:
    """Their searches are those of the policy alone."""
    for spec in map(load_scene, problem_files(level)):
        sides = [side for box in spec.boxes.values() for side in box.size]
        assert LEARNED_SIDES[0] <= min(sides)
        assert max(sides) <= LEARNED_SIDES[1]
        assert min(min(support.size[:2]) for support in spec.supports.values()) >= LEARNED_TOP


def test_what_is_below_a_support_is_covered() -> None:
    assert covered("half-covered-bar", "bar")
    assert not covered("f4-flat-plate", "plate")


def covered(case: str, box: str) -> bool:
    spec: SceneSpec = load_scene(CASES / f"{case}.yaml")
    world = World(spec)
    return is_covered(world, world.initial_configuration(), box)
