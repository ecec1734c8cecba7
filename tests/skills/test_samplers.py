"""The contract of every sampler of k, and the further promises of the optimization-based one.

A new sampler is tested by adding its configuration to SAMPLERS.
"""

import dataclasses

import numpy as np
import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.core.failures import Failure
from ictamp_drake.core.protocols import Sampler
from ictamp_drake.core.types import Action, Configuration, FloatArray
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.scenes.spec import SupportSpec
from ictamp_drake.skills.config import OptimizationConfig, UniformConfig
from ictamp_drake.skills.context import SamplerConfig, SamplerContext
from ictamp_drake.skills.geometry import grasp_pose, held_bottom, placement_pose
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World
from tests.panda import PANDA
from tests.refusals import refusal
from tests.skills.rig import pick, place
from tests.world.scenes import RACK_TOP, SIZES, arrange, far_boxes, hold_box, pose, scene

SAMPLERS: dict[str, SamplerConfig] = {"uniform": UniformConfig(), "optimization": OptimizationConfig()}
CONFIG = OptimizationConfig()
FAR = SupportSpec("table", (5.0, 0.0, 0.0))


@pytest.mark.parametrize(
    ("config", "name"),
    [(UniformConfig(), "yaw"), (CONFIG, "depth"), (CONFIG, "height"), (CONFIG, "reach")],
)
def test_a_range_that_ends_before_it_begins_is_refused(config: SamplerConfig, name: str) -> None:
    with refusal(Code.OUT_OF_RANGE, value=(2.0, 1.0)):
        dataclasses.replace(config, **{name: (2.0, 1.0)})


def test_boxes_without_width_are_not_gripped() -> None:
    with refusal(Code.OUT_OF_RANGE, "samplers.optimization.max-width", value=0.0):
        OptimizationConfig(max_width=0.0)


@pytest.fixture(scope="module")
def world() -> World:
    spec = scene(far_boxes())
    return World(dataclasses.replace(spec, supports={**spec.supports, "far": FAR}))


@pytest.fixture(scope="module")
def arm(world: World) -> ArmKinematics:
    return ArmKinematics(PANDA, to_transform(world.spec.arm.X_WB))


def situations(world: World) -> dict[str, tuple[Configuration, Action]]:
    """Queries to a sampler: picks from everywhere, places on everything."""
    c = world.initial_configuration()
    tipped = arrange(world, {"red_box": pose(0.5, -0.1, 0.025, roll=90.0, yaw=25.0)})
    on_rack = arrange(world, {"blue_box": pose(0.44, -0.33, RACK_TOP + 0.053, yaw=10.0)})
    held, held_tipped = hold_box(world, "yellow_box"), hold_box(world, "yellow_box", 90.0)
    return {
        "pick from the table": (c, pick("cyan_box", "table")),
        "pick what is tipped": (tipped, pick("red_box", "table")),
        "pick from the rack": (on_rack, pick("blue_box", "rack")),
        "place on the table": (held, place("yellow_box", "table")),
        "place on the rack": (held, place("yellow_box", "rack")),
        "place on a box": (held, place("yellow_box", "cyan_box")),
        "place what is tipped": (held_tipped, place("yellow_box", "rack")),
    }


SITUATIONS = ("pick from the table", "pick what is tipped", "pick from the rack") + (
    "place on the table",
    "place on the rack",
    "place on a box",
    "place what is tipped",
)


def draws(
    sampler: Sampler[Configuration], c: Configuration, action: Action, count: int, seed: int = 0
) -> list[FloatArray | Failure]:
    rng = np.random.default_rng(seed)
    return [k for k, _ in zip(sampler.draws(c, action, rng), range(count), strict=False)]


# every sampler


@pytest.mark.parametrize("situation", SITUATIONS)
@pytest.mark.parametrize("name", SAMPLERS)
def test_k_is_four_finite_numbers(world: World, arm: ArmKinematics, name: str, situation: str) -> None:
    c, action = situations(world)[situation]
    before = c.poses["red_box"].copy()
    found = [
        k for k in draws(SAMPLERS[name].create(SamplerContext(world, arm)), c, action, 5) if not isinstance(k, Failure)
    ]
    assert found
    for k in found:
        assert k.shape == (4,)
        assert k.dtype == np.float64
        assert np.all(np.isfinite(k))
    np.testing.assert_array_equal(c.poses["red_box"], before)


@pytest.mark.parametrize("situation", SITUATIONS)
@pytest.mark.parametrize("name", SAMPLERS)
def test_the_same_seed_gives_the_same_k(world: World, arm: ArmKinematics, name: str, situation: str) -> None:
    """This holds whatever the sampler drew in between, and for a separate sampler."""
    c, action = situations(world)[situation]
    sampler = SAMPLERS[name].create(SamplerContext(world, arm))
    first = draws(sampler, c, action, 3)
    for other_c, other_action in situations(world).values():
        next(sampler.draws(other_c, other_action, np.random.default_rng(99)))
    own = SAMPLERS[name].create(SamplerContext(world, ArmKinematics(PANDA, to_transform(world.spec.arm.X_WB))))
    for again in (draws(sampler, c, action, 3), draws(own, c, action, 3)):
        assert [isinstance(k, Failure) for k in again] == [isinstance(k, Failure) for k in first]
        for one, other in zip(first, again, strict=True):
            np.testing.assert_array_equal(one, other)


@pytest.mark.parametrize("situation", SITUATIONS)
@pytest.mark.parametrize("name", SAMPLERS)
def test_draws_differ(world: World, arm: ArmKinematics, name: str, situation: str) -> None:
    c, action = situations(world)[situation]
    found = [
        k for k in draws(SAMPLERS[name].create(SamplerContext(world, arm)), c, action, 8) if not isinstance(k, Failure)
    ]
    spread = np.ptp(np.array(found), axis=0)
    assert len(found) >= 4
    assert spread[:2].max() > 1e-3
    assert spread[3] > 1e-3


# the optimisation-based one


@pytest.fixture(scope="module")
def sampler(world: World, arm: ArmKinematics) -> Sampler[Configuration]:
    return CONFIG.create(SamplerContext(world, arm))


def pose_of_hand(world: World, arm: ArmKinematics, c: Configuration, action: Action, k: FloatArray) -> object:
    box, other = action.args
    if action.name == "pick":
        return grasp_pose(world, c, box, k)
    return placement_pose(world, c, other, held_bottom(world, c, box, arm.forward(c.q)), k)


@pytest.mark.parametrize("situation", SITUATIONS)
def test_optimized_k_can_be_reached(
    world: World, arm: ArmKinematics, sampler: Sampler[Configuration], situation: str
) -> None:
    c, action = situations(world)[situation]
    found = [k for k in draws(sampler, c, action, 6) if not isinstance(k, Failure)]
    assert len(found) >= 5
    for k in found:
        X_WG = pose_of_hand(world, arm, c, action, k)
        q = arm.solve(X_WG, c.q)
        assert q is not None
        assert arm.forward(q).IsNearlyEqualTo(X_WG, 1e-6)


@pytest.mark.parametrize("situation", [s for s in SITUATIONS if s.startswith("pick")])
def test_optimized_grasps_are_within_bounds(world: World, sampler: Sampler[Configuration], situation: str) -> None:
    c, action = situations(world)[situation]
    size = world.upright_frame(c, action.args[0]).size
    sides = set()
    for k in (k for k in draws(sampler, c, action, 8) if not isinstance(k, Failure)):
        quarter = round(k[3] / (np.pi / 2))
        assert abs(k[3] - quarter * np.pi / 2) <= CONFIG.turn + 1e-3
        across, along = np.abs(k[:2] if quarter % 2 == 0 else k[1::-1])
        assert across <= CONFIG.grip_offset[0] + 1e-4
        assert along <= CONFIG.grip_offset[1] + 1e-4
        assert size[1 - quarter % 2] <= PANDA.gripper.max_side
        assert size[2] / 2 - k[2] >= min(CONFIG.depth[0], size[2] - CONFIG.ground) - 1e-4
        assert size[2] / 2 - k[2] <= CONFIG.depth[1] + 1e-4
        assert k[2] + size[2] / 2 >= CONFIG.ground - 1e-4
        sides.add(quarter % 2)
    wide = [i for i in (0, 1) if size[1 - i] <= PANDA.gripper.max_side]
    assert sides <= set(wide)


@pytest.mark.parametrize("situation", [s for s in SITUATIONS if s.startswith("place")])
def test_optimized_placements_are_within_bounds(world: World, sampler: Sampler[Configuration], situation: str) -> None:
    c, action = situations(world)[situation]
    box, receptacle = action.args
    radius = np.linalg.norm(world.upright_frame(c, box).size[:2]) / 2
    on_box = receptacle in SIZES
    bound = np.full(2, CONFIG.overhang) if on_box else world.top_size(c, receptacle) / 2 - radius
    for k in (k for k in draws(sampler, c, action, 8) if not isinstance(k, Failure)):
        assert np.all(np.abs(k[:2]) <= bound + 1e-4)
        assert CONFIG.height[0] - 1e-4 <= k[2] <= CONFIG.height[1] + 1e-4
        if on_box:
            assert abs(k[3] - round(k[3] / (np.pi / 2)) * np.pi / 2) <= CONFIG.turn + 1e-3
            continue
        p_WB = (world.X_WT(c, receptacle).translation() + world.X_WT(c, receptacle).rotation() @ k[:3])[:2]
        for name, p in c.poses.items():
            if name != box and abs(p[6] - SIZES[name][2] / 2 - world.X_WT(c, receptacle).translation()[2]) < 0.01:
                needed = radius + min(SIZES[name][:2]) / 2
                assert np.linalg.norm(p[4:6] - p_WB) >= needed


@pytest.mark.parametrize(
    ("what", "action"),
    [
        ("a support out of reach", place("yellow_box", "far")),
        ("a box out of reach", place("yellow_box", "red_box")),
    ],
)
def test_there_is_no_k_for_an_impossible_place(
    world: World, sampler: Sampler[Configuration], what: str, action: Action
) -> None:
    c = hold_box(world, "yellow_box")
    far = arrange(world, {**c.poses, "red_box": pose(2.0, 0.0, 0.059)}, "yellow_box")
    assert next(sampler.draws(far, action, np.random.default_rng(0))) is Failure.NO_INVERSE_KINEMATICS, what


def test_there_is_no_k_for_a_box_out_of_reach(world: World, sampler: Sampler[Configuration]) -> None:
    far = arrange(world, {"red_box": pose(2.0, 0.0, 0.059)})
    assert next(sampler.draws(far, pick("red_box", "table"), np.random.default_rng(0))) is Failure.NO_INVERSE_KINEMATICS


def test_there_is_no_k_where_no_room_is_left(world: World, arm: ArmKinematics) -> None:
    """The rack is full: a box stands in its middle, and the rest is narrower than the held box needs."""
    c = hold_box(world, "yellow_box")
    crowd = {"cyan_box": (0.38, -0.33), "red_box": (0.5, -0.33), "blue_box": (0.44, -0.33)}
    poses = {name: pose(x, y, RACK_TOP + SIZES[name][2] / 2) for name, (x, y) in crowd.items()}
    full = arrange(world, {**c.poses, **poses}, "yellow_box")
    greedy = dataclasses.replace(CONFIG, clearance=0.1).create(SamplerContext(world, arm))
    assert next(greedy.draws(full, place("yellow_box", "rack"), np.random.default_rng(0))) is Failure.GOAL_IN_COLLISION
