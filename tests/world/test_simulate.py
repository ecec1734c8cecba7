"""Physics: deterministic, at rest when it says so, firm grips, towers that stand, and an arm within its limits."""

import numpy as np
import pytest
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.systems.framework import Context, EventStatus

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.types import Configuration, FloatArray, GripperCommand, Motion, Segment
from ictamp_drake.models.constants import ARM_LIMITS, HOME, MAX_GRIP_FORCE
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, SupportSpec
from ictamp_drake.world.poses import to_pose, to_transform
from ictamp_drake.world.simulate import Frame, Physics, PhysicsConfig
from ictamp_drake.world.world import FINGERS, World
from tests.world.scenes import RACK, SIZES, TABLE, arranged, box, p_GO, pose, scene, standing, stay, way

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
    """Close the hand on the thing, carry it up and away."""
    grip = GripperCommand(SIDE, force)
    up = np.array(HOME) + [0.0, -0.12, 0.0, 0.05, 0.0, 0.05, 0.0]
    return (
        stay(c, 0.6, grip, "grasp"),
        way("lift", c.q[:7], up, 0.8, grip),
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
    ("name", "value", "sentence"),
    [
        ("time_step", 0.0, r"physics\.time-step is 0, but must be between 1e-05 and 0\.1"),
        ("settle_check", 0.0, r"physics\.settle-check is 0, but"),  # would wait for ever
        ("min_pad_force", 0.0, r"physics\.min-pad-force is 0, but"),  # all that is there would be held
        ("arm_stiffness", (100.0, 200.0), r"physics\.arm-stiffness is \[100\.0, 200\.0\], but must be seven numbers"),
        ("arm_damping", (-1.0,) * 7, r"physics\.arm-damping is .*, but each number must be between 0 and 1e\+09"),
    ],
)
def test_physics_that_makes_no_sense_is_refused(name: str, value: object, sentence: str) -> None:
    with pytest.raises(IctampError, match=sentence):
        PhysicsConfig(**{name: value})


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
    """A box on its edge, all but balanced, is slow at first: it must not count as standing."""
    angle = np.arctan2(0.025, 0.059) + 1e-3
    height = 0.059 * np.cos(angle) + 0.025 * np.sin(angle)
    spec = scene(standing("red_box"))
    c = arranged(World(spec), {"red_box": pose(0.5, 0.1, height, pitch=np.degrees(angle))})
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
    assert np.all(outcome.c.q[7:] < SIDE / 2 + 1e-4)
    np.testing.assert_allclose(outcome.c.q[7:], SIDE / 2, atol=5e-4)
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
    c = arranged(world, {"thing": pose(0.6, 0.2, TALL / 2)})
    outcome = physics.run(c, grip_and_carry(c, 30.0)[:1])
    assert outcome.c.held is None
    assert outcome.c.q[7] < SIDE / 2 - 0.01


def test_a_box_that_one_finger_presses_is_not_held() -> None:
    spec = pedestal(mass=3.0)
    world = World(spec)
    c = world.initial_configuration()
    aside = c.poses["thing"] + [0.0, 0.0, 0.0, 0.0, 0.0, 0.01, 0.0]
    start = arranged(world, {"thing": aside})
    outcome = PhysicsConfig().create(World(spec)).run(start, (stay(start, 0.6, GripperCommand(SIDE + 0.016)),))
    touching = {touch.a for touch in world.touches(outcome.c, 5e-4) if touch.b == "thing"}
    touching |= {touch.b for touch in world.touches(outcome.c, 5e-4) if touch.a == "thing"}
    assert len(touching & set(FINGERS)) == 1
    assert outcome.c.held is None


# the arm


def _efforts(physics: Physics, c: Configuration, motion: Motion) -> FloatArray:
    """Largest effort of each of the 9 joints during a motion, shape (9,)."""
    plant, largest = physics._scene.plant, np.zeros(9)
    port, context = plant.get_net_actuation_output_port(physics._scene.bodies.arm), physics._scene.context

    def look(_: Context) -> EventStatus:
        np.maximum(largest, np.abs(port.Eval(context)), out=largest)
        return EventStatus.DidNothing()

    physics._scene.simulator.set_monitor(look)
    physics.run(c, motion)
    physics._scene.simulator.clear_monitor()
    return largest


def test_pushing_into_a_heavy_obstacle_takes_no_more_than_the_effort_limits() -> None:
    spec = SceneSpec(supports={"table": TABLE, "rack": RACK}, boxes=standing("red_box"), goal="(on red_box rack)")
    physics = PhysicsConfig(record_period=0.004).create(World(spec))
    c = World(spec).initial_configuration()
    through_the_table = np.array([0.0, 1.3, 0.0, -1.2, 0.0, 2.0, 0.8])
    efforts = _efforts(physics, c, (way("push", c.q[:7], through_the_table, 1.5, OPEN), stay(c, 0.2)))
    limits = np.array([limit.effort for limit in ARM_LIMITS])
    assert np.all(efforts[:7] <= limits * (1 + 1e-9))
    assert efforts[1] == pytest.approx(limits[1])  # it did push as hard as it may
    blocked = physics.run(c, (way("push", c.q[:7], through_the_table, 1.5, OPEN),))
    assert np.abs(blocked.c.q[:7] - through_the_table).max() > 0.1


def test_fingers_press_no_harder_than_they_can(world: World) -> None:
    c = world.initial_configuration()
    efforts = _efforts(
        PhysicsConfig(record_period=0.004).create(World(pedestal())), c, (stay(c, 1.0, GripperCommand(0.0, 70.0)),)
    )
    assert np.all(efforts[7:] <= MAX_GRIP_FORCE * (1 + 1e-9))


def test_the_arm_follows_a_motion(world: World, physics: Physics) -> None:
    """Within 2 mrad at the end of each segment, with and without a box in the hand."""
    c = world.initial_configuration()
    motion = grip_and_carry(c, 30.0)
    errors = []

    def watch(segment: Segment, running: Physics) -> bool:
        errors.append(np.abs(running.configuration().q[:7] - segment.control_points[-1]).max())
        return True

    outcome = physics.run(c, motion, watch=watch)
    assert len(errors) == len(motion)
    assert max(errors) < 2e-3
    np.testing.assert_allclose(outcome.c.q[:7], AWAY, atol=5e-4)


# watching, recording, locking


@pytest.mark.parametrize("last", [0, 1, 2])
def test_a_watcher_ends_the_simulation(world: World, physics: Physics, last: int) -> None:
    c = world.initial_configuration()
    motion = grip_and_carry(c, 30.0)
    outcome = physics.run(c, motion, watch=lambda segment, _: segment is not motion[last])
    assert outcome.stopped_after == motion[last].label
    assert not outcome.settled
    np.testing.assert_allclose(outcome.c.q[:7], motion[last].control_points[-1], atol=2e-3)


def test_frames_come_once_a_period(world: World) -> None:
    physics = PhysicsConfig(record_period=0.04).create(World(pedestal()))
    c = world.initial_configuration()
    motion = grip_and_carry(c, 30.0)
    outcome = physics.run(c, motion)
    frames = physics.frames(outcome.recording)
    gaps = np.diff([frame.time for frame in frames])
    assert frames[0] == Frame(0.0, Configuration(c.q, c.poses))
    assert gaps.max() <= 0.04 + 1e-9
    assert np.sum(gaps < 0.04 - 1e-9) <= len(outcome.motion), "only the end of a segment comes sooner"
    assert frames[-1].time == pytest.approx(sum(segment.duration for segment in outcome.motion))
    assert frames[-1].c == Configuration(outcome.c.q, outcome.c.poses)
    assert len(physics.run(c, motion, record=False).recording.times) == 1


def test_physics_is_the_same_everywhere_in_the_plane() -> None:
    """A box that falls and topples ends in the same way when the whole scene is turned and moved."""
    spec = scene({"red_box": box("red_box", (0.5, 0.1, 0.1), (40.0, 0.0, 10.0))})
    X = RigidTransform(RotationMatrix.MakeZRotation(0.7), [0.05, -0.03, 0.0])
    physics, world = PhysicsConfig().create(World(spec)), World(spec)
    c = world.initial_configuration()
    moved = arranged(world, {"red_box": to_pose(X @ to_transform(c.poses["red_box"]))})
    ends = [to_transform(physics.run(start, ()).c.poses["red_box"]) for start in (c, moved)]
    assert (X @ ends[0]).IsNearlyEqualTo(ends[1], 1e-3)
