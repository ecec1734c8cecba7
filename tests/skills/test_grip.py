"""Heavy and smooth boxes: gripped as hard as they need, carried as slowly, and refused beyond the hand's limit."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import yaml

import ictamp_drake as ict
from benchmarks.grip import BOX, METHOD, Measured, Slide, make_scene, measure
from ictamp_drake.core.errors import Code
from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Configuration
from ictamp_drake.models.panda import ARM_JOINTS
from ictamp_drake.motion.config import CarryingConfig, MotionConfig
from ictamp_drake.robots.grip import LEAST_FORCE
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec
from ictamp_drake.skills.config import PickConfig, SkillsConfig
from ictamp_drake.tamp.samples import ros_yaml, sample
from tests.panda import MAX_GRIP_FORCE
from tests.refusals import refusal
from tests.skills.rig import pick, rig
from tests.world.scenes import RACK, TABLE

CASE = Path(__file__).parents[1] / "scenes" / "cases" / "05-heavy-and-smooth.yaml"
TALL = BoxSpec((0.06, 0.062, 0.13), (0.5, 0.3, 0.065), (0.0, 0.0, 10.0))
AS_BEFORE = METHOD.with_options(
    skills=SkillsConfig(
        pick=PickConfig(safety=0.0), motion=MotionConfig(carrying=CarryingConfig(reserve=1e-3, slide=1.0))
    )
)
"""30 N for every box, and every motion at full speed."""


def carried(mass: float, friction: float) -> Measured:
    """The tall box with a mass and friction, picked up off its center, held and carried to the rack."""
    return measure(ict.load(make_scene(TALL, mass, friction), METHOD), METHOD, seed=1)


@pytest.mark.parametrize(
    ("mass", "friction"), [(0.05, 0.05), (0.5, 0.05), (1.0, 0.2), (1.8, 0.2), (1.8, 0.35), (1.8, 1.0), (2.9, 0.35)]
)
def test_a_box_stays_where_it_is_in_the_fingers(mass: float, friction: float) -> None:
    found = carried(mass, friction)
    assert not found.dropped
    assert LEAST_FORCE <= found.force <= MAX_GRIP_FORCE
    assert found.held.center < 10
    assert found.carried.pads < 2


def test_with_the_least_force_and_at_full_speed_a_heavy_and_smooth_box_is_lost() -> None:
    """The test above is worth something."""
    assert measure(ict.load(make_scene(TALL, 1.8, 0.35), AS_BEFORE), AS_BEFORE, seed=1).dropped


def test_heavier_and_smoother_boxes_are_gripped_harder() -> None:
    def force(mass: float, friction: float) -> float:
        motion = rig(make_scene(TALL, mass, friction)).attempt(start, pick(BOX, "table"), k=k).motion
        return motion[-1].gripper.force

    start, k = rig(make_scene(TALL, 0.1, 0.6)).start, np.array([0.0, 0.0, 0.05, 0.0])
    assert force(0.1, 0.6) == LEAST_FORCE
    assert LEAST_FORCE < force(1.8, 0.35) < force(1.8, 0.3) < force(1.9, 0.3) < MAX_GRIP_FORCE


@pytest.fixture(scope="module")
def plan() -> ict.Plan:
    plan = ict.solve(ict.load(CASE), time_limit=250).plan
    assert plan is not None
    return plan


def test_a_heavy_and_smooth_box_is_carried_at_the_first_attempt(plan: ict.Plan) -> None:
    assert [str(action) for action in plan.actions] == [
        "pick(ingot, table)",
        "place(ingot, rack)",
        "pick(cork, table)",
        "place(cork, ingot)",
    ]
    picked, placed = plan.attempts[0].successor, plan.attempts[1]
    assert picked is not None
    physics = ict.load(CASE).physics
    transfer = physics.run(picked, placed.motion[:1])
    assert transfer.c.held == "ingot"
    assert Slide.between(picked, transfer.c, "ingot").center < 2


def test_plan_file_and_export_carry_the_force(plan: ict.Plan, tmp_path: Path) -> None:
    plan.save(tmp_path / "plan.yaml")
    read = ict.Plan.load(tmp_path / "plan.yaml")
    forces = [
        {segment.gripper.force for segment in attempt.motion if segment.gripper.force} for attempt in read.attempts
    ]
    ingot, cork = forces[0], forces[2]
    assert len(ingot) == 1
    assert LEAST_FORCE < min(ingot) < MAX_GRIP_FORCE
    assert (forces[1], cork, forces[3]) == (ingot, {LEAST_FORCE}, {LEAST_FORCE})
    goals = [
        entry["gripper"]["force"]
        for entry in yaml.safe_load(ros_yaml(sample(read, 50.0), ARM_JOINTS))
        if "gripper" in entry
    ]
    assert list(dict.fromkeys(force for force in goals if force)) == [*ingot, LEAST_FORCE]


# beyond the limit of the hand


def anvil(goal: str) -> SceneSpec:
    """A box that the hand cannot hold, and one that it can."""
    boxes = {"anvil": replace(TALL, mass=3.0, friction=0.2), "cork": BoxSpec((0.05,) * 3, (0.55, 0.0, 0.025))}
    return SceneSpec(supports={"table": TABLE, "rack": RACK}, boxes=boxes, goal=goal)


def test_a_goal_that_moves_what_the_hand_cannot_hold_is_refused_at_once() -> None:
    with refusal(Code.TOO_HEAVY, "boxes.anvil.mass", file="the scene", value=3.0):
        ict.load(anvil("(and (on cork table) (on anvil rack))"))
    with_less = PickConfig(safety=1.5)
    method = METHOD.with_options(skills=replace(METHOD.skills, pick=with_less))
    assert ict.load(anvil("(on anvil rack)"), method).goal


@pytest.mark.parametrize("goal", ["(on cork rack)", "(on cork anvil)", "(and (on anvil table) (on cork rack))"])
def test_a_box_that_need_not_move_may_be_as_heavy_as_it_likes(goal: str) -> None:
    solution = ict.solve(ict.load(anvil(goal)), time_limit=100)
    assert solution.plan is not None
    assert len(solution.plan) == 2


def test_a_pick_of_what_the_hand_cannot_hold_says_so() -> None:
    setup = rig(anvil("(on cork rack)"))
    attempt = setup.attempt(setup.start, pick("anvil", "table"))
    assert attempt.failure is Failure.TOO_HEAVY
    assert not attempt.motion


def test_a_heavy_box_gripped_far_off_its_center_is_not_carried() -> None:
    """However slow, it would turn in the fingers."""
    bar = replace(TALL, size=(0.05, 0.2, 0.06), position=(0.5, 0.2, 0.03), mass=1.5, friction=0.35)
    setup = rig(make_scene(bar, 1.5, 0.35))
    middle, end = (
        setup.attempt(setup.start, pick(BOX, "table"), k=np.array([0.0, y, 0.0, np.pi / 2])) for y in (0.0, 0.08)
    )
    assert middle.succeeded
    assert end.failure is Failure.TOO_HEAVY


def observe(c: Configuration) -> ict.Start:
    """The start that an observer would describe."""
    return ict.Start(joints=c.q, held=c.held or "", poses=c.poses)


def test_a_box_held_at_the_start_is_gripped_as_hard() -> None:
    spec = make_scene(TALL, 1.8, 0.35)
    setup = rig(spec)
    picked = setup.attempt(setup.start, pick(BOX, "table"), k=np.array([0.0, 0.0, 0.05, 0.0])).successor
    assert picked is not None
    task = ict.load(spec, start=observe(picked))
    assert task.c.gripper.force == pytest.approx(picked.gripper.force, abs=0.5)
    with refusal(Code.TOO_HEAVY, f"boxes.{BOX}.mass"):
        ict.load(make_scene(TALL, 3.0, 0.2), start=observe(picked))
