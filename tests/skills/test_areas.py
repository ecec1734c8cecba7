"""k of placements in regions, at poses, and on supports that have them."""

from dataclasses import replace
from itertools import islice

import numpy as np
import pytest

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.scenes.regions import PoseSpec, RegionSpec
from ictamp_drake.skills.areas import AreaSampler
from ictamp_drake.skills.config import OptimizationConfig, PolicyConfig, UniformConfig
from ictamp_drake.skills.context import SamplerConfig, SamplerContext
from ictamp_drake.skills.geometric import GeometricSampler
from ictamp_drake.skills.geometry import level_pose
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World
from tests.panda import PANDA
from tests.skills.rig import KINEMATIC, place, rig
from tests.world.scenes import far_boxes, hold_box, scene

SPEC = replace(
    scene(far_boxes()),
    regions={
        "near": RegionSpec("table", (0.3, 0.1), (0.1, 0.0), yaw=20.0),
        "narrow": RegionSpec("table", (0.02, 0.03), (0.2, -0.2)),
    },
    poses={"spot": PoseSpec("table", (0.1, -0.15), yaw=30.0)},
)
SAMPLERS: dict[str, SamplerConfig] = {
    "uniform": UniformConfig(),
    "optimization": OptimizationConfig(),
    "policy": PolicyConfig(),
}


@pytest.mark.parametrize("config", SAMPLERS.values(), ids=SAMPLERS)
@pytest.mark.parametrize("where", ["near", "narrow", "spot", "table"])
def test_the_box_would_be_in_the_place_of_the_action(config: SamplerConfig, where: str) -> None:
    world = World(SPEC)
    context = SamplerContext(world, ArmKinematics(PANDA, to_transform(SPEC.arm.X_WB)))
    sampler = AreaSampler(world, config.create(context), UniformConfig().create(context))
    c = hold_box(world, "yellow_box")
    size = world.upright_frame(c, "yellow_box").size
    draws = sampler.draws(c, place("yellow_box", where), np.random.default_rng(0))
    for k in islice(draws, 8):
        assert not isinstance(k, Failure)
        assert world.area_at(where, world.X_WT(c, where) @ level_pose(k), size) == where


def test_a_region_smaller_than_the_box_is_used_up_to_its_border() -> None:
    """What lies in its middle may leave room beside it."""
    small = RegionSpec("table", (0.02, 0.03), (0.1, 0.2))
    world = World(replace(SPEC, regions={"small": small}))
    sampler = GeometricSampler(world, ArmKinematics(PANDA, to_transform(SPEC.arm.X_WB)))
    draws = sampler.draws(hold_box(world, "yellow_box"), place("yellow_box", "small"), np.random.default_rng(0))
    used = np.ptp(np.array(list(islice(draws, 40)))[:, :2], axis=0)
    assert np.all(used > 0.7 * np.array(small.size))


def test_the_free_part_of_a_region_beneath_a_rack_is_found_at_once() -> None:
    """The policy has not learned what a region is."""
    region = RegionSpec("table", (0.25, 0.2), (0.15, -0.25))
    spec = replace(
        SPEC,
        boxes={"yellow_box": SPEC.boxes["yellow_box"]},
        regions={"far": region},
        poses={},
        goal="(on yellow_box far)",
    )
    scene_rig = rig(spec, PolicyConfig())
    held = hold_box(scene_rig.world, "yellow_box")
    attempts = [scene_rig.attempt(held, place("yellow_box", "far"), seed) for seed in range(4)]
    assert not any(attempt.failure in KINEMATIC for attempt in attempts)


def test_a_support_without_room_beside_its_regions_ends_the_draws() -> None:
    spec = replace(SPEC, regions={"all": RegionSpec("table", SPEC.supports["table"].size[:2])}, poses={})
    world = World(spec)
    uniform = UniformConfig().create(SamplerContext(world, ArmKinematics(PANDA, to_transform(spec.arm.X_WB))))
    sampler = AreaSampler(world, uniform, uniform)
    draws = sampler.draws(hold_box(world, "yellow_box"), place("yellow_box", "table"), np.random.default_rng(0))
    assert list(draws) == [Failure.GOAL_IN_COLLISION]


@pytest.mark.parametrize("where", ["near", "spot"])
def test_a_placement_reaches_the_state_that_it_promises(where: str) -> None:
    scene_rig = rig(replace(SPEC, boxes={"red_box": SPEC.boxes["red_box"]}, goal=f"(on red_box {where})"))
    c = scene_rig.start
    for action in (Action("pick", ("red_box", "table")), place("red_box", where), Action("pick", ("red_box", where))):
        attempts = (scene_rig.attempt(c, action, seed) for seed in range(10))
        attempt = next(attempt for attempt in attempts if attempt.succeeded)
        assert attempt.successor is not None
        c = attempt.successor
