"""Physics is deterministic and detects rest; grips are firm, towers stand, and the arm stays within its limits."""

import pickle
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.systems.framework import Context, EventStatus

from ictamp_drake.core.errors import Code
from ictamp_drake.core.types import Configuration, FloatArray, GripperCommand, Motion, Segment
from ictamp_drake.models.panda import ARM_LIMITS
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, SupportSpec
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.outcome import Frame
from ictamp_drake.world.poses import to_pose, to_transform
from ictamp_drake.world.simulate import Physics
from ictamp_drake.world.world import FINGERS, World
from tests.panda import HOME, MAX_GRIP_FORCE, PANDA
from tests.refusals import refusal
from tests.robots import small
from tests.world.scenes import RACK, SIZES, TABLE, arrange, box, build_tower, p_GO, pose, scene, stay, way

OPEN = GripperCommand(0.08)
G_HEIGHT = 0.4868821
"""Height of G above the base when the arm is at home [m]."""
G_X = 0.3068906
SIDE, TALL = 0.05, 0.08
AWAY: FloatArray = np.array(HOME) + [0.7, -0.25, 0.0, 0.05, 0.0, 0.1, 0.3]
AWAY.setflags(write=False)


def pedestal(mass: float = 0.1, friction: float = 0.6) -> SceneSpec:
    """A box on a slab, between the open fingers of the arm at home."""
    top = G_HEIGHT - TALL / 2 - 0.01
    supports = {"slab": SupportSpec("table", (G_X, 0.0, top), size=(0.1, 0.1, 0.02)), "floor": TABLE}
    thing = BoxSpec((SIDE, SIDE, TALL), (G_X, 0.0, top + TALL / 2), mass=mass, friction=friction)
    return SceneSpec(supports=supports, boxes={"thing": thing}, goal="(on thing floor)")


def grip_and_carry(c: Configuration, force: float) -> Motion:
    """Close the hand on the object, and carry it up and away."""
    grip = GripperCommand(SIDE, force)
    up = np.array(HOME) + [0.0, -0.12, 0.0, 0.05, 0.0, 0.05, 0.0]
    return (
        stay(c, 0.6, grip, "grasp"),
        way("lift", c.q, up, 0.8, grip),
        way("transfer", up, AWAY, 1.2, grip),
    )


@pytest.fixture(scope="module")
def world() -> World:
    return World(pedestal())


@pytest.fixture(scope="module")
def physics() -> Physics:
    return PhysicsConfig().create(World(pedestal()))


# constants


@pytest.mark.parametrize(
    ("name", "value", "code"),
    [
        ("time_step", 0.0, Code.OUT_OF_RANGE),
        ("settle_check", 0.0, Code.OUT_OF_RANGE),  # would wait forever
        ("min_pad_force", 0.0, Code.OUT_OF_RANGE),  # everything would be held
        ("arm_damping", (-1.0,) * 7, Code.OUT_OF_RANGE),
        ("finger_stiffness", 0.0, Code.OUT_OF_RANGE),  # nothing would be held
    ],
)
def test_physics_that_makes_no_sense_is_refused(name: str, value: object, code: Code) -> None:
    with refusal(code, f"physics.{name.replace('_', '-')}", value=value):
        PhysicsConfig(**{name: value})


def test_gains_of_another_number_of_joints_are_refused() -> None:
    with refusal(Code.WRONG_LENGTH, "physics.arm-stiffness", value=(100.0, 200.0)):
        PhysicsConfig(arm_stiffness=(100.0, 200.0)).gains(PANDA)


def test_a_solver_that_drops_what_couples_the_fingers_is_refused(tmp_path: Path) -> None:
    world = World(replace(pedestal(), robot=str(small.write_coupled(tmp_path))))
    with refusal(Code.CONFLICT, "physics.contact-approximation", value="tamsi"):
        PhysicsConfig(contact_approximation="tamsi").create(world)


def test_the_softest_and_the_stiffest_arm_can_be_built() -> None:
    for stiffness, damping, step in ((1e-3, 0.0, 1e-5), (1e9, 1e9, 0.1)):
        PhysicsConfig(
            step, "sap", (stiffness,) * 7, (damping,) * 7, finger_stiffness=stiffness, finger_damping=damping
        ).create(World(pedestal()))


# determinism


def test_the_same_start_and_motion_end_the_same_bit_for_bit(world: World, physics: Physics) -> None:
    c = world.initial_configuration()
    motion = grip_and_carry(c, 30.0)
    first = physics.run(c, motion)
    physics.run(first.c, (way("back", AWAY, np.array(HOME), 0.5, OPEN),))  # something else in between
    again = physics.run(c, motion)
    fresh = PhysicsConfig().create(World(pedestal())).run(c, motion)
    recorded = physics.run(c, motion, record=False)
    watched = physics.run(c, motion, watch=lambda *_: True)
    for outcome in (again, fresh, recorded, watched):
        assert outcome.c == first.c
        assert outcome.settled == first.settled
    assert first.c != c


def fresh() -> Physics:
    """An unused simulator of the pedestal."""
    return PhysicsConfig().create(World(pedestal()))


@pytest.mark.parametrize("sleep", [True, False])
def test_motions_one_by_one_are_one_execution_bit_for_bit(world: World, sleep: bool) -> None:
    """This also holds if a motion ends midway, with the box in the hand and the arm still following."""
    config, start = PhysicsConfig(sleep=sleep), world.initial_configuration()
    parts = [(segment,) for segment in grip_and_carry(start, 30.0)]
    at_once = config.create(world)
    whole = [at_once.run(start, parts[0]).c, *(at_once.proceed(part).c for part in parts[1:])]
    c = start
    for part, reached in zip(parts, whole, strict=True):
        c = config.create(World(pedestal())).run(c, part, record=False).c
        assert c == reached
    assert c.held == "thing"


def test_after_a_watcher_ended_an_execution_the_next_goes_on_from_there(world: World) -> None:
    c = world.initial_configuration()
    grasp, lift, transfer = grip_and_carry(c, 30.0)
    physics = fresh()
    stopped = physics.run(c, (grasp, lift), watch=lambda *_: False)
    assert stopped.stopped_after == grasp.label
    assert stopped.c == fresh().run(c, (grasp,), watch=lambda *_: False).c, "nothing after it was executed"
    assert stopped.c.commanded.tobytes() == grasp.control_points[-1].tobytes()
    assert physics.proceed((lift, transfer)).c == fresh().run(stopped.c, (lift, transfer)).c


def test_what_was_simulated_before_leaves_nothing_behind(world: World, physics: Physics) -> None:
    """No grip is remembered where only the arm moves, nor where nothing moves at all."""
    c = world.initial_configuration()
    carried = physics.run(c, grip_and_carry(c, 30.0)).c
    assert carried.held == "thing"
    empty = arrange(world, {"thing": pose(0.6, 0.2, TALL / 2)})
    alone = replace(way("aside", empty.q, AWAY, 1.0, OPEN), touches=frozenset())
    for motion in ((alone,), (stay(empty, 1e-9),)):
        physics.run(c, grip_and_carry(c, 30.0))
        outcome = physics.run(empty, motion)
        assert outcome.c.held is None
        assert outcome.c == fresh().run(empty, motion).c
    held = fresh().run(carried, (stay(carried, 1e-9),))
    assert held.c.held == "thing", "what c says, since no step was simulated"


def test_a_simulator_goes_on_after_the_solver_diverged(world: World, physics: Physics) -> None:
    c = world.initial_configuration()
    motion = grip_and_carry(c, 30.0)
    reference = physics.run(c, motion).c
    state = reference.x
    assert state is not None
    wild = np.append(state[:-3], np.full(3, np.nan))
    with pytest.raises(RuntimeError):
        physics.run(replace(reference, x=wild), motion)
    assert physics.run(c, motion).c == reference


def test_simulators_may_share_a_world(world: World) -> None:
    """Two of them execute each motion alternately, while the world answers other queries."""
    c = world.initial_configuration()
    motion = [replace(segment, touches=frozenset({"thing"})) for segment in grip_and_carry(c, 30.0)]
    reference = fresh().run(c, motion)
    one, other = (PhysicsConfig().create(world) for _ in range(2))
    aside = arrange(world, {"thing": pose(0.6, 0.2, TALL / 2)})

    def disturb(*_: object) -> bool:
        other.run(aside, (stay(aside, 0.05),))
        world.set_configuration(aside)
        return True

    assert one.run(c, motion, watch=disturb).c == reference.c


# the state of c


def test_a_configuration_that_was_reached_is_loaded_bit_for_bit(world: World, physics: Physics) -> None:
    c = world.initial_configuration()
    end = physics.run(c, grip_and_carry(c, 30.0)).c
    assert end.x is not None
    assert end.commanded.tobytes() == AWAY.tobytes()
    np.testing.assert_allclose(end.q, end.commanded, atol=5e-4)
    assert np.any(end.x[world.plant.num_positions() :] != 0), "velocities are part of it"
    loaded = pickle.loads(pickle.dumps(end))
    assert fresh().run(loaded, (stay(end, 0.2),)).c == physics.run(end, (stay(end, 0.2),)).c


@pytest.mark.parametrize(
    "change",
    [
        lambda c: {"poses": {"thing": c.poses["thing"] + [0, 0, 0, 0, 0, 0, 1e-9]}},
        lambda c: {"q": c.q + 1e-9},
        lambda c: {"fingers": c.fingers + 1e-9},
        lambda c: {"x": c.x[:-1]},
        lambda c: {"x": np.append(c.x, 0.0)},
        lambda c: {"x": c.x[:3]},
    ],
)
def test_a_state_that_belongs_to_something_else_is_refused(
    world: World, physics: Physics, change: Callable[[Configuration], dict[str, Any]]
) -> None:
    c = physics.run(world.initial_configuration(), ()).c
    with pytest.raises(ValueError, match="x of the configuration belongs to other positions"):
        physics.run(replace(c, **change(c)), ())


def test_boxes_may_move_where_a_motion_begins(world: World, physics: Physics) -> None:
    """A box in the air falls, although the arm touches nothing."""
    c = arrange(world, {"thing": pose(0.5, -0.3, 0.4)})
    state = physics.run(c, (stay(c, 1e-9),)).c.x
    assert state is not None
    rises = state.copy()
    rises[-1] = 1.0
    for start in (c, replace(c, q=c.q, poses=c.poses, x=rises)):
        alone = replace(way("aside", c.q, AWAY, 1.0, OPEN), touches=frozenset())
        outcome = physics.run(start, (replace(stay(c, 0.1), touches=frozenset({"thing"})), alone))
        reference = (
            PhysicsConfig(sleep=False)
            .create(world)
            .run(start, (replace(stay(c, 0.1), touches=frozenset({"thing"})), alone))
        )
        np.testing.assert_allclose(outcome.c.poses["thing"], reference.c.poses["thing"], atol=1e-4)
        assert outcome.c.poses["thing"][6] < 0.1


# time


@pytest.mark.parametrize("time_step", [0.001, 0.003, PhysicsConfig().time_step, 0.01])
def test_a_motion_that_was_executed_lasts_a_whole_number_of_steps(world: World, time_step: float) -> None:
    c = world.initial_configuration()
    odd = tuple(replace(segment, touches=None) for segment in (stay(c, 0.0123), stay(c, 0.0007), stay(c, 0.1)))
    outcome = PhysicsConfig(time_step=time_step).create(world).run(c, odd)
    steps = sum(segment.duration for segment in outcome.motion) / time_step
    assert steps == pytest.approx(round(steps), abs=1e-6)
    assert steps >= 0.113 / time_step - 1e-6
    assert outcome.recording.times[-1] == pytest.approx(time_step * round(steps))
    again = PhysicsConfig(time_step=time_step).create(world).run(c, outcome.motion)
    assert again.c == outcome.c, "with its wait for rest it ends the same"
    assert [segment.label for segment in again.motion] == [segment.label for segment in outcome.motion]


@given(steps=st.lists(st.integers(1, 500), min_size=1, max_size=40), time_step=st.sampled_from([0.001, 0.003, 0.004]))
def test_sums_of_durations_make_no_step_too_many(steps: list[int], time_step: float) -> None:
    elapsed = 0.0
    for count in steps:
        elapsed += count * time_step
    assert PhysicsConfig(time_step=time_step).steps(elapsed) == sum(steps)


def test_a_motion_shorter_than_a_step_takes_one(world: World, physics: Physics) -> None:
    c = physics.run(world.initial_configuration(), (stay(world.initial_configuration(), 1.0),)).c
    outcome = physics.run(c, (stay(c, 0.001), stay(c, 0.001)))
    assert sum(segment.duration for segment in outcome.motion) == pytest.approx(PhysicsConfig().time_step)


# rest


@pytest.mark.parametrize("drop", [0.01, 0.1])
@pytest.mark.parametrize(("roll", "height"), [(0.0, 0.059), (90.0, 0.025)])
def test_a_dropped_box_comes_to_rest_on_the_table(drop: float, roll: float, height: float) -> None:
    spec = scene({"red_box": box("red_box", (0.5, 0.1, height + drop), (roll, 0.0, 30.0))})
    outcome = PhysicsConfig().create(World(spec)).run(World(spec).initial_configuration(), ())
    assert outcome.settled
    np.testing.assert_allclose(outcome.c.poses["red_box"][4:], [0.5, 0.1, height], atol=2e-4)


def test_what_still_moves_has_not_settled() -> None:
    spec = scene({"red_box": box("red_box", (0.5, 0.1, 0.6))})
    outcome = PhysicsConfig(settle_time=0.2).create(World(spec)).run(World(spec).initial_configuration(), ())
    assert not outcome.settled
    assert outcome.stopped_after is None


def test_a_falling_tower_is_not_called_at_rest() -> None:
    """A box on its edge, nearly balanced, is slow at first; it must not count as standing."""
    angle = np.arctan2(0.025, 0.059) + 1e-3
    height = 0.059 * np.cos(angle) + 0.025 * np.sin(angle)
    spec = scene(build_tower("red_box"))
    c = arrange(World(spec), {"red_box": pose(0.5, 0.1, height, pitch=np.degrees(angle))})
    outcome = PhysicsConfig().create(World(spec)).run(c, ())
    assert outcome.settled
    assert outcome.c.poses["red_box"][6] == pytest.approx(0.025, abs=2e-4)


def test_poses_keep_unit_quaternions() -> None:
    spec = scene({"red_box": box("red_box", (0.5, 0.1, 0.15), (20.0, 30.0, 40.0))})
    physics = PhysicsConfig().create(World(spec))
    for frame in physics.frames(physics.run(World(spec).initial_configuration(), ()).recording):
        assert np.linalg.norm(frame.c.poses["red_box"][:4]) == pytest.approx(1.0, abs=1e-12)


@pytest.mark.parametrize("seed", range(4))
def test_a_tower_of_four_stands(seed: int) -> None:
    rng = np.random.default_rng(seed)
    boxes, top, place = {}, 0.0, np.array([0.5, 0.1])
    for name in ("cyan_box", "yellow_box", "red_box", "blue_box"):
        height = SIZES[name][2]
        boxes[name] = box(name, (*place, top + height / 2), (0.0, 0.0, rng.uniform(-180, 180)))
        top += height
        angle = rng.uniform(-np.pi, np.pi)
        place = place + 0.007 * np.array([np.cos(angle), np.sin(angle)])
    spec = scene(boxes)
    c = World(spec).initial_configuration()
    outcome = PhysicsConfig().create(World(spec)).run(c, (stay(c, 2.0),))
    assert outcome.settled
    for name in boxes:
        assert np.linalg.norm(outcome.c.poses[name][4:] - c.poses[name][4:]) < 1e-3


# grips


@pytest.mark.parametrize("time_step", [PhysicsConfig().time_step, 0.001])
@pytest.mark.parametrize("force", [30.0, MAX_GRIP_FORCE])
def test_fingers_stop_at_the_surface(world: World, force: float, time_step: float) -> None:
    c = world.initial_configuration()
    outcome = PhysicsConfig(time_step=time_step).create(World(pedestal())).run(c, grip_and_carry(c, force)[:1])
    assert np.all(outcome.c.fingers < SIDE / 2 + 1e-4)
    np.testing.assert_allclose(outcome.c.fingers, SIDE / 2, atol=5e-4)
    assert outcome.c.held == "thing"
    assert outcome.c.gripper == GripperCommand(SIDE, force)


@pytest.mark.parametrize("time_step", [PhysicsConfig().time_step, 0.001])
def test_a_carried_box_neither_slips_nor_drops(world: World, time_step: float) -> None:
    c = world.initial_configuration()
    physics = PhysicsConfig(time_step=time_step).create(World(pedestal()))
    motion = grip_and_carry(c, 30.0)
    gripped = physics.run(c, motion[:1]).c
    outcome = physics.run(c, motion)
    assert outcome.settled
    assert outcome.c.held == "thing"
    slip = np.linalg.norm(p_GO(world, outcome.c, "thing") - p_GO(world, gripped, "thing"))
    assert slip < 2e-3
    assert to_transform(outcome.c.poses["thing"]).translation()[2] > G_HEIGHT + 0.02
    later = physics.run(outcome.c, (stay(outcome.c, 5.0),))
    assert later.c.held == "thing"
    assert np.linalg.norm(p_GO(world, later.c, "thing") - p_GO(world, outcome.c, "thing")) < 1e-3


def test_a_grip_without_enough_friction_loses_the_box(world: World) -> None:
    c = world.initial_configuration()
    outcome = PhysicsConfig().create(World(pedestal(mass=1.5, friction=0.05))).run(c, grip_and_carry(c, 30.0))
    assert outcome.c.held is None
    assert to_transform(outcome.c.poses["thing"]).translation()[2] < G_HEIGHT


def test_a_hand_that_closes_on_nothing_holds_nothing(world: World, physics: Physics) -> None:
    c = arrange(world, {"thing": pose(0.6, 0.2, TALL / 2)})
    outcome = physics.run(c, grip_and_carry(c, 30.0)[:1])
    assert outcome.c.held is None
    assert outcome.c.fingers[0] < SIDE / 2 - 0.01


def test_a_box_that_one_finger_presses_is_not_held() -> None:
    spec = pedestal(mass=3.0)
    world = World(spec)
    c = world.initial_configuration()
    aside = c.poses["thing"] + [0.0, 0.0, 0.0, 0.0, 0.0, 0.01, 0.0]
    start = arrange(world, {"thing": aside})
    outcome = PhysicsConfig().create(World(spec)).run(start, (stay(start, 0.6, GripperCommand(SIDE + 0.016)),))
    touching = {touch.a for touch in world.touches(outcome.c, 5e-4) if touch.b == "thing"}
    touching |= {touch.b for touch in world.touches(outcome.c, 5e-4) if touch.a == "thing"}
    assert len(touching & set(FINGERS)) == 1
    assert outcome.c.held is None


# the arm


def _efforts(physics: Physics, c: Configuration, motion: Motion) -> FloatArray:
    """Largest effort of each of the 9 joints during a motion, shape (9,)."""
    plant, largest = physics._scene.plant, np.zeros(9)
    port, context = plant.get_net_actuation_output_port(physics._scene.robot.instances[0]), physics._scene.context

    def look(_: Context) -> EventStatus:
        np.maximum(largest, np.abs(port.Eval(context)), out=largest)
        return EventStatus.DidNothing()

    physics._scene.simulator.set_monitor(look)
    physics.run(c, motion)
    physics._scene.simulator.clear_monitor()
    return largest


def test_pushing_into_a_heavy_obstacle_takes_no_more_than_the_effort_limits() -> None:
    spec = SceneSpec(supports={"table": TABLE, "rack": RACK}, boxes=build_tower("red_box"), goal="(on red_box rack)")
    physics = PhysicsConfig(record_period=0.004).create(World(spec))
    c = World(spec).initial_configuration()
    through_the_table = np.array([0.0, 1.3, 0.0, -1.2, 0.0, 2.0, 0.8])
    efforts = _efforts(physics, c, (way("push", c.q, through_the_table, 1.5, OPEN), stay(c, 0.2)))
    limits = np.array([limit.effort for limit in ARM_LIMITS])
    assert np.all(efforts[:7] <= limits * (1 + 1e-9))
    assert efforts[1] == pytest.approx(limits[1])  # it pushed as hard as allowed
    blocked = physics.run(c, (way("push", c.q, through_the_table, 1.5, OPEN),))
    assert np.abs(blocked.c.q - through_the_table).max() > 0.1


def test_fingers_press_no_harder_than_they_can(world: World) -> None:
    c = world.initial_configuration()
    efforts = _efforts(
        PhysicsConfig(record_period=0.004).create(World(pedestal())), c, (stay(c, 1.0, GripperCommand(0.0, 70.0)),)
    )
    assert np.all(efforts[7:] <= MAX_GRIP_FORCE * (1 + 1e-9))


def test_the_arm_follows_a_motion(world: World, physics: Physics) -> None:
    """The error is at most 2 mrad at the end of each segment, with and without a box in the hand."""
    c = world.initial_configuration()
    motion = grip_and_carry(c, 30.0)
    errors = []

    def watch(segment: Segment, running: Physics) -> bool:
        errors.append(np.abs(running.configuration().q - segment.control_points[-1]).max())
        return True

    outcome = physics.run(c, motion, watch=watch)
    assert len(errors) == len(motion)
    assert max(errors) < 2e-3
    np.testing.assert_allclose(outcome.c.q, AWAY, atol=5e-4)


# watching, recording, locking


@pytest.mark.parametrize("last", [0, 1, 2])
def test_a_watcher_ends_the_simulation(world: World, physics: Physics, last: int) -> None:
    c = world.initial_configuration()
    motion = grip_and_carry(c, 30.0)
    outcome = physics.run(c, motion, watch=lambda segment, _: segment is not motion[last])
    assert outcome.stopped_after == motion[last].label
    assert not outcome.settled
    np.testing.assert_allclose(outcome.c.q, motion[last].control_points[-1], atol=2e-3)


def test_frames_come_once_a_period(world: World) -> None:
    physics = PhysicsConfig(record_period=0.04).create(World(pedestal()))
    c = world.initial_configuration()
    motion = grip_and_carry(c, 30.0)
    outcome = physics.run(c, motion)
    frames = physics.frames(outcome.recording)
    gaps = np.diff([frame.time for frame in frames])
    assert frames[0] == Frame(0.0, Configuration(c.q, c.fingers, c.poses))
    assert gaps.max() <= 0.04 + 1e-9
    assert np.sum(gaps < 0.04 - 1e-9) <= len(outcome.motion), "only the end of a segment comes sooner"
    assert frames[-1].time == pytest.approx(sum(segment.duration for segment in outcome.motion))
    assert frames[-1].c == Configuration(outcome.c.q, outcome.c.fingers, outcome.c.poses)
    assert len(physics.run(c, motion, record=False).recording.times) == 1


def test_physics_is_the_same_everywhere_in_the_plane() -> None:
    """A box that falls and topples ends in the same way if the whole scene is turned and moved."""
    spec = scene({"red_box": box("red_box", (0.5, 0.1, 0.1), (40.0, 0.0, 10.0))})
    X = RigidTransform(RotationMatrix.MakeZRotation(0.7), [0.05, -0.03, 0.0])
    physics, world = PhysicsConfig().create(World(spec)), World(spec)
    c = world.initial_configuration()
    moved = arrange(world, {"red_box": to_pose(X @ to_transform(c.poses["red_box"]))})
    ends = [to_transform(physics.run(start, ()).c.poses["red_box"]) for start in (c, moved)]
    assert (X @ ends[0]).IsNearlyEqualTo(ends[1], 1e-3)
