"""Executions in changed worlds: what changes, and that moved stacks are at rest in the same symbolic state."""

from dataclasses import replace

import numpy as np
import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.core.types import Atom, Configuration
from ictamp_drake.tamp import changes as module
from ictamp_drake.tamp.changes import Changes, find_stacks
from ictamp_drake.tamp.plan import Plan
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.start import find_overlaps
from ictamp_drake.world.world import World
from tests.refusals import refusal
from tests.runs.plans import small_plan

POSE = np.array([1.0, 0, 0, 0, 0, 0, 0])


@pytest.fixture(scope="module")
def plan() -> Plan:
    return small_plan()


@pytest.fixture(scope="module")
def moved(plan: Plan) -> Plan:
    return Changes(noise=(0.01, 6.0)).apply(plan)


def test_without_changes_the_plan_stays_as_it_is(plan: Plan) -> None:
    same = Changes().apply(plan)
    assert same.spec == plan.spec
    assert same.c == plan.c
    for before, after in zip(plan.attempts, same.attempts, strict=True):
        assert [segment.gripper for segment in before.motion] == [segment.gripper for segment in after.motion]
    assert Changes().physics(PhysicsConfig()) == PhysicsConfig()


def test_factors_are_those_of_boxes_hand_and_controllers(plan: Plan) -> None:
    changes = Changes(friction=0.5, mass=2.0, grip_force=0.25, stiffness=0.5, time_step=0.001)
    changed = changes.apply(plan)
    for name, box in plan.spec.boxes.items():
        expected = replace(box, mass=2 * box.mass, friction=0.5 * box.friction)
        assert changed.spec.boxes[name] == expected
    forces = [
        [segment.gripper.force for attempt in each.attempts for segment in attempt.motion] for each in (plan, changed)
    ]
    assert max(forces[0]) > 0
    np.testing.assert_allclose(forces[1], 0.25 * np.array(forces[0]))
    physics = changes.physics(PhysicsConfig())
    np.testing.assert_allclose(physics.arm_stiffness, 0.5 * np.array(PhysicsConfig().arm_stiffness))
    assert physics.time_step == 0.001


def test_noise_moves_boxes_upright_and_the_scene_is_one_to_start_in(plan: Plan, moved: Plan) -> None:
    world = World(plan.spec)
    abstraction = SceneAbstraction(world)
    assert abstraction(moved.c) == abstraction(plan.c)
    assert find_overlaps(world, moved.c) == []
    for name, pose in plan.c.poses.items():
        X = to_transform(pose).inverse() @ to_transform(moved.c.poses[name])
        assert 0.0005 < np.linalg.norm(X.translation()[:2]) < 0.05
        assert abs(X.translation()[2]) < 5e-4
        assert X.rotation().matrix()[2, 2] == pytest.approx(1.0, abs=1e-4), "turned about the vertical only"


def test_a_seed_gives_the_same_start_and_another_seed_another(plan: Plan, moved: Plan) -> None:
    assert Changes(noise=(0.01, 6.0)).apply(plan).c == moved.c
    assert Changes(noise=(0.01, 6.0), seed=1).apply(plan).c != moved.c


def test_the_noise_has_the_given_size(plan: Plan) -> None:
    changes, rng = Changes(noise=(0.003, 2.0)), np.random.default_rng(0)
    draws = [changes._draw([["red_box"]], plan.c, rng).poses["red_box"] for _ in range(500)]
    X = [to_transform(plan.c.poses["red_box"]).inverse() @ to_transform(pose) for pose in draws]
    np.testing.assert_allclose(np.std([each.translation()[:2] for each in X], axis=0), 0.003, rtol=0.15)
    yaws = [np.degrees(np.arctan2(*each.rotation().matrix()[[1, 0], [0, 0]])) for each in X]
    assert np.std(yaws) == pytest.approx(2.0, rel=0.15)


def test_boxes_that_carry_each_other_move_together() -> None:
    c = Configuration(np.zeros(7), np.zeros(2), dict.fromkeys("abcdef", POSE), held="f")
    on = {("a", "table"), ("b", "a"), ("c", "table"), ("d", "rack"), ("e", "d"), ("e", "c")}
    stacks = list(find_stacks(frozenset(Atom("on", pair) for pair in on), c))
    assert [sorted(stack) for stack in stacks] == [["a", "b"], ["c", "d", "e"]]


def test_a_stack_keeps_its_shape(plan: Plan) -> None:
    poses = {"red_box": plan.c.poses["red_box"], "blue_box": plan.c.poses["red_box"] + [0, 0, 0, 0, 0.004, 0, 0.09]}
    c = replace(plan.c, poses=poses, x=None)
    moved = Changes(noise=(0.01, 20.0))._draw([["red_box", "blue_box"]], c, np.random.default_rng(0))
    before, after = (
        to_transform(each.poses["red_box"]).inverse() @ to_transform(each.poses["blue_box"]) for each in (c, moved)
    )
    np.testing.assert_allclose(after.GetAsMatrix4(), before.GetAsMatrix4(), atol=1e-12)


def test_noise_that_leaves_no_start_is_refused(plan: Plan, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(module, "DRAWS", 0)
    with refusal(Code.OVERLAP, "noise"):
        Changes(noise=(0.01, 6.0)).apply(plan)


def test_a_mass_beyond_its_range_is_refused_with_the_name_of_the_box(plan: Plan) -> None:
    with refusal(Code.OUT_OF_RANGE, "boxes.red_box.mass"):
        Changes(mass=50.0).apply(plan)


@pytest.mark.parametrize(
    ("options", "field"),
    [
        ({"noise": (-0.001, 2.0)}, "noise[0]"),
        ({"noise": (0.001, float("nan"))}, "noise[1]"),
        ({"grip_force": 0.0}, "grip-force"),
        ({"seed": -1}, "seed"),
        ({"time_step": 1.0}, "physics.time-step"),
    ],
)
def test_changes_out_of_range_are_refused(options: dict[str, object], field: str) -> None:
    with refusal(Code.OUT_OF_RANGE, field):
        Changes(**options)  # type: ignore[arg-type]
