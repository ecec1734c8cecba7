"""Opening of the hand in a pick: as wide as the box needs and its neighbors allow, in time, without touching them."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Configuration, GripperCommand, Motion
from ictamp_drake.motion.planner import MotionPlanner, Refusal
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, load_scene
from ictamp_drake.skills.config import CLEARANCES, PickConfig
from ictamp_drake.skills.context import SkillContext
from ictamp_drake.skills.geometry import grasp_pose, needed_opening
from ictamp_drake.world.commands import gripper_time, obedience_time
from ictamp_drake.world.world import ARM, FINGERS, World
from tests.panda import GRIPPER, MAX_OPENING
from tests.skills.rig import pick, rig
from tests.world.scenes import build_tower, scene

BETWEEN = load_scene(Path(__file__).parents[1] / "scenes" / "cases" / "neighbours-8-mm.yaml")
WANTED = pick("wanted", "table")
ACROSS = np.array([0.0, 0.0, 0.036, 0.0])
"""A grasp in the middle of the wanted box, with the fingers above its low neighbors."""

FREE = World(scene({**build_tower("yellow_box", y=-0.05), **build_tower("red_box", y=0.3)}))
PLANNER = MotionPlanner(FREE)


def plan_pick(
    world: World, box: str, k: np.ndarray, c: Configuration | None = None, config: PickConfig | None = None
) -> Motion | Refusal:
    skill = (config or PickConfig()).create(SkillContext(world, MotionPlanner(world) if world is not FREE else PLANNER))
    c = c or world.initial_configuration()
    return skill.plan(c, pick(box, "table"), k, np.random.default_rng(0))


def commands_by_label(motion: Motion | Refusal) -> dict[str, GripperCommand]:
    assert not isinstance(motion, Refusal), motion
    return {segment.label: segment.gripper for segment in motion}


@settings(max_examples=25)
@given(
    box=st.sampled_from(["red_box", "yellow_box"]),
    across=st.floats(-0.008, 0.008),
    askew=st.floats(-0.1, 0.1),
    quarter=st.integers(-1, 1),
    before=st.sampled_from([0.0, 0.05, 0.08]),
)
def test_the_hand_comes_down_open_wide_enough(
    box: str, across: float, askew: float, quarter: int, before: float
) -> None:
    yaw = quarter * np.pi / 2 + askew
    height = FREE.sizes[box][2] / 2 - 0.02
    k = np.array([-across * np.sin(yaw), across * np.cos(yaw), height, yaw])
    c = replace(FREE.initial_configuration(), gripper=GripperCommand(before))
    motion = plan_pick(FREE, box, k, c)
    commands = commands_by_label(motion)
    assert not isinstance(motion, Refusal)
    needed = needed_opening(FREE, c, box, grasp_pose(FREE, c, box, k))
    assert commands["lower"].width == pytest.approx(min(needed + 2 * CLEARANCES[0], MAX_OPENING))
    assert commands["approach"] == commands["lower"]
    assert commands["lower"].force == 0
    assert commands["grasp"].width <= needed
    labels = [segment.label for segment in motion]
    ready = motion[: labels.index("lower")]
    assert obedience_time(c.gripper, ready, GRIPPER.speed) <= sum(segment.duration for segment in ready) + 1e-9
    assert obedience_time(c.gripper, motion, GRIPPER.speed) <= sum(segment.duration for segment in motion) + 1e-9


def test_a_hand_that_has_no_time_on_its_way_opens_before_it() -> None:
    k = np.array([0.0, 0.0, 0.03, 0.0])
    first = plan_pick(FREE, "red_box", k)
    assert not isinstance(first, Refusal)
    near = first[1].control_points[0] + 0.01  # close to the place from which the hand is lowered
    start = FREE.initial_configuration()
    closed = Configuration(near, np.zeros(2), start.poses, None, GripperCommand(0.0))
    motion = plan_pick(FREE, "red_box", k, closed)
    assert not isinstance(motion, Refusal)
    adjust, approach, lower = motion[:3]
    assert [adjust.label, approach.label, lower.label] == ["adjust", "approach", "lower"]
    assert adjust.gripper == approach.gripper == lower.gripper
    assert approach.duration < gripper_time(closed.gripper, lower.gripper, GRIPPER.speed) <= adjust.duration
    np.testing.assert_array_equal(adjust.control_points, [closed.commanded])


def test_neighbours_make_the_hand_open_less() -> None:
    world = World(BETWEEN)
    commands = commands_by_label(plan_pick(world, "wanted", ACROSS))
    assert commands["lower"].width == pytest.approx(0.05 + 2 * CLEARANCES[-1], abs=1e-6)
    wide = plan_pick(world, "wanted", ACROSS, config=PickConfig(clearances=CLEARANCES[:-1]))
    assert isinstance(wide, Refusal)
    assert wide.failure is Failure.GOAL_IN_COLLISION
    assert wide.obstacle in {"left_back", "right_back"}


def test_a_pick_between_neighbours_touches_none_of_them() -> None:
    """Checked at each step of physics with everything awake; the neighbors do not move."""
    setup = rig(BETWEEN)
    attempt = setup.attempt(setup.start, WANTED, k=ACROSS)
    assert attempt.failure is None, attempt.detail
    assert attempt.successor is not None
    others = sorted(set(BETWEEN.boxes) - {"wanted"})
    physics = replace(setup.physics.config, sleep=False, record_period=setup.physics.config.time_step).create(
        World(BETWEEN)
    )
    outcome = physics.run(setup.start, attempt.motion)
    assert outcome.recording is not None
    for frame in physics.frames(outcome.recording):
        for touch in setup.world.touches(frame.c, 0.0):
            bodies = {touch.a, touch.b}
            assert not (bodies & {ARM, *FINGERS, "wanted"} and bodies & {*others}), bodies
    for end in (attempt.successor, outcome.c):
        for name in others:
            np.testing.assert_allclose(end.poses[name], setup.start.poses[name], atol=1e-4)


def _well(depth: float) -> SceneSpec:
    """A small box between two higher walls."""
    size, gap = (0.035, 0.035, 0.06), 0.032
    y = size[1] / 2 + gap + 0.02
    walls = {
        side: BoxSpec((0.03, 0.04, depth), (0.5, 0.1 + sign * y, depth / 2)) for side, sign in (("a", 1), ("b", -1))
    }
    return scene({"small": BoxSpec(size, (0.5, 0.1, size[2] / 2)), **walls})


def test_a_hand_too_wide_for_where_it_is_lowered_closes_a_little_before_it_sets_out() -> None:
    world = World(_well(0.085))
    motion = plan_pick(world, "small", np.array([0.0, 0.0, 0.021, 0.0]))
    commands = commands_by_label(motion)
    assert list(commands)[:3] == ["adjust", "approach", "lower"]
    assert commands["adjust"] == commands["lower"]
    shallow = plan_pick(World(_well(0.06)), "small", np.array([0.0, 0.0, 0.021, 0.0]))
    assert "adjust" not in commands_by_label(shallow)
