"""Sleeping boxes: which bodies are awake together, and that executions end as if everything had been awake."""

from collections.abc import Collection
from dataclasses import replace

import numpy as np
import pytest

from ictamp_drake.core.types import Configuration, FloatArray, GripperCommand, Motion, Segment
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, SupportSpec
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.outcome import Outcome
from ictamp_drake.world.simulate import Physics, Watcher
from ictamp_drake.world.sleep import NEAR
from ictamp_drake.world.world import World
from tests.panda import HOME
from tests.world.scenes import TABLE, arrange, pose, stay, way
from tests.world.test_simulate import G_HEIGHT, G_X, OPEN, SIDE, TALL

CUBE = 0.05
TOP = G_HEIGHT - TALL / 2 - 0.01
"""Height of the support of a box that is between the fingers of the arm at home [m]."""
AWAKE = PhysicsConfig(sleep=False)


class Counted(Physics):
    """A simulator that remembers for each execution of a motion whether boxes were allowed to sleep."""

    def __init__(self, world: World, config: PhysicsConfig) -> None:
        super().__init__(world, config)
        self.executions: list[bool] = []

    def _execute(self, motion: Motion, watch: Watcher | None, record: bool, *, sleep: bool) -> Outcome:  # type: ignore[override]
        self.executions.append(sleep)
        return super()._execute(motion, watch, record, sleep=sleep)


def allow_touches(segment: Segment, *names: str) -> Segment:
    """The segment, during which only these bodies may be touched."""
    return replace(segment, touches=frozenset(names))


def turned_arm(angle: float) -> FloatArray:
    """The arm at home, turned about the vertical [rad]."""
    return np.array(HOME) + [angle, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0]


# who is awake


def cubes(*places: tuple[float, float, float]) -> SceneSpec:
    """Boxes a, b, c, ... with their centers at these places."""
    boxes = {name: BoxSpec((CUBE,) * 3, place) for name, place in zip("abcdef", places, strict=False)}
    return SceneSpec(supports={"table": TABLE}, boxes=boxes, goal="(on a table)")


def awake(spec: SceneSpec, touched: Collection[str], c: Configuration | None = None) -> set[str]:
    """Boxes that are awake at the end of a motion during which some may be touched."""
    world = World(spec)
    physics = PhysicsConfig().create(world)
    c = c or physics.run(world.initial_configuration(), ()).c
    physics.run(c, (allow_touches(stay(c, 0.02), *touched),))
    return set(spec.boxes) - physics._sleepers.asleep


TOWER = cubes((0.5, 0.1, 0.025), (0.5, 0.1, 0.075), (0.5, 0.1, 0.125), (0.5, 0.3, 0.025))


@pytest.mark.parametrize("touched", ["a", "b", "c"])
def test_a_tower_wakes_as_a_whole(touched: str) -> None:
    assert awake(TOWER, [touched]) == {"a", "b", "c"}


def test_what_stands_alone_wakes_nobody() -> None:
    assert awake(TOWER, ["d"]) == {"d"}
    assert awake(TOWER, ["table"]) == set()
    assert awake(TOWER, ["d", "nowhere"]) == {"d"}
    assert awake(TOWER, []) == set()


@pytest.mark.parametrize(("gap", "together"), [(0.5 * NEAR, True), (2 * NEAR, False)])
def test_boxes_side_by_side_are_awake_together(gap: float, together: bool) -> None:
    spec = cubes((0.5, 0.1, 0.025), (0.5, 0.1 + CUBE + gap, 0.025), (0.5, 0.1 + 2 * (CUBE + gap), 0.025))
    assert awake(spec, ["a"]) == ({"a", "b", "c"} if together else {"a"})


@pytest.mark.parametrize("touched", ["plank", "post"])
def test_a_box_that_leans_is_awake_with_what_it_leans_on(touched: str) -> None:
    boxes = {
        "post": BoxSpec((0.06, 0.06, 0.06), (0.5, 0.1, 0.03), mass=2.0),
        "plank": BoxSpec((0.02, 0.02, 0.12), (0.42, 0.1, 0.058), rotation=(0.0, 20.0, 0.0), friction=1.0),
        "far": BoxSpec((CUBE,) * 3, (0.5, 0.3, 0.025)),
    }
    spec = SceneSpec(supports={"table": TABLE}, boxes=boxes, goal="(on far table)")
    world = World(spec)
    c = PhysicsConfig().create(world).run(world.initial_configuration(), ()).c
    tilt = 2 * np.degrees(np.arccos(abs(c.poses["plank"][0])))
    assert 5 < tilt < 60, "it leans"
    assert awake(spec, [touched], c) == {"post", "plank"}


@pytest.mark.parametrize("seed", range(3))
def test_a_sleeping_box_never_carries_an_awake_one(seed: int) -> None:
    """At any moment of a motion, everything near an awake box is awake."""
    rng = np.random.default_rng(seed)
    places = [(0.4 + 0.1 * (i // 2) + rng.uniform(0, 0.02), 0.1, 0.025 + CUBE * (i % 2)) for i in range(6)]
    spec = cubes(*places)
    world = World(spec)
    physics = PhysicsConfig().create(world)
    c = physics.run(world.initial_configuration(), ()).c
    mixed = 0

    def watch(_: Segment, running: Physics) -> bool:
        nonlocal mixed
        asleep = running._sleepers.asleep
        mixed += 0 < len(asleep) < len(spec.boxes)
        for touch in world.touches(running.configuration(), 0.5 * NEAR):
            pair = {touch.a, touch.b} & set(spec.boxes)
            assert len(pair) < 2 or pair <= asleep or not pair & asleep
        return True

    physics.run(c, [allow_touches(stay(c, 0.1), name) for name in rng.permutation(list(spec.boxes))], watch=watch)
    assert mixed == len(spec.boxes)


def test_nothing_sleeps_while_a_box_overhangs() -> None:
    """Drake 1.51 reads out of bounds when a joint is locked and a shape of the world, such as a rim, is touched."""
    supports = {"block": SupportSpec("table", (0.5, 0.1, 0.1), size=(0.06, 0.06, 0.1)), "table": TABLE}
    boxes = {"a": BoxSpec((0.08, 0.06, 0.06), (0.5, 0.1, 0.13)), "b": BoxSpec((CUBE,) * 3, (0.5, 0.3, 0.025))}
    spec = SceneSpec(supports=supports, boxes=boxes, goal="(on a block)")
    assert awake(spec, ["b"]) == {"a", "b"}


# the guard


def course(angle: float) -> SceneSpec:
    """A box between the fingers of the arm at home and another one in its path, both on shelves."""
    x, y = G_X * np.cos(angle), G_X * np.sin(angle)
    shelf = (0.1, 0.1, 0.02)
    supports = {
        "slab": SupportSpec("table", (G_X, 0.0, TOP), size=shelf),
        "shelf": SupportSpec("table", (x, y, TOP), size=shelf),
        "floor": TABLE,
    }
    places = {"thing": (G_X, 0.0, TOP + TALL / 2), "other": (x, y, TOP + TALL / 2)}
    boxes = {name: BoxSpec((SIDE, SIDE, TALL), place, mass=0.1) for name, place in places.items()}
    return SceneSpec(supports=supports, boxes=boxes, goal="(on thing floor)")


def run_both(world: World, c: Configuration, motion: Motion) -> tuple[Outcome, Outcome, list[bool]]:
    """Run with sleep and with the whole scene awake; also return the executions of the former."""
    physics = Counted(world, PhysicsConfig())
    return physics.run(c, motion), AWAKE.create(world).run(c, motion), physics.executions


@pytest.mark.parametrize("duration", [0.4, 1.2])
def test_an_arm_that_sweeps_a_sleeping_box_away_wakes_it(duration: float) -> None:
    world = World(course(0.45))
    c = arrange(world, {"thing": pose(0.5, -0.3, TALL / 2)})
    motion = (allow_touches(way("sweep", turned_arm(0.0), turned_arm(0.9), duration, OPEN)),)
    outcome, reference, executions = run_both(world, c, motion)
    assert executions == [True, False, False], "with sleep, awake, and with the rim over which the box is pushed"
    assert outcome.c == reference.c
    assert outcome.settled == reference.settled
    np.testing.assert_array_equal(outcome.recording.states, reference.recording.states)
    assert np.linalg.norm(outcome.c.poses["other"][4:] - c.poses["other"][4:]) > 0.1


def test_a_held_box_that_is_pushed_into_a_sleeping_one_wakes_it() -> None:
    world = World(course(0.45))
    c = world.initial_configuration()
    grip = GripperCommand(SIDE, 30.0)
    up = turned_arm(0.0) + [0.0, -0.005, 0.0, 0.002, 0.0, 0.002, 0.0]
    motion = (
        allow_touches(stay(c, 0.6, grip), "thing"),
        allow_touches(way("lift", turned_arm(0.0), up, 0.4, grip), "thing"),
        allow_touches(way("transfer", up, up + turned_arm(0.35) - turned_arm(0.0), 1.0, grip), "thing"),
    )
    outcome, reference, executions = run_both(world, c, motion)
    assert executions == [True, False]
    assert outcome.c == reference.c
    assert outcome.c.held == "thing"
    assert np.linalg.norm(outcome.c.poses["other"][4:] - c.poses["other"][4:]) > 0.01


def test_fingers_that_close_on_a_sleeping_box_wake_it() -> None:
    world = World(course(0.45))
    c = world.initial_configuration()
    outcome, reference, executions = run_both(world, c, (allow_touches(stay(c, 0.6, GripperCommand(SIDE, 30.0))),))
    assert executions == [True, False]
    assert outcome.c == reference.c
    assert outcome.c.held == "thing"


def test_the_guard_goes_on_from_where_the_motion_began() -> None:
    """This also holds after earlier skills without a reset."""
    world = World(course(0.45))
    away = arrange(world, {"thing": pose(0.5, -0.3, TALL / 2)})
    physics = Counted(world, PhysicsConfig())
    before = physics.run(away, (allow_touches(way("aside", turned_arm(0.0), turned_arm(-0.3), 0.5, OPEN)),)).c
    sweep = (allow_touches(way("sweep", turned_arm(-0.3), turned_arm(0.9), 0.8, OPEN)),)
    outcome = physics.proceed(sweep)
    assert physics.executions == [True, True, False, False]
    assert outcome.c == AWAKE.create(world).run(before, sweep).c


def test_a_motion_that_touches_nothing_wakes_nobody() -> None:
    world = World(course(0.9))
    c = PhysicsConfig().create(world).run(arrange(world, {"thing": pose(0.5, -0.3, TALL / 2)}), ()).c
    motion = (allow_touches(way("aside", turned_arm(0.0), turned_arm(0.3), 0.8, OPEN)),)
    outcome, reference, executions = run_both(world, c, motion)
    assert executions == [True]
    np.testing.assert_allclose(outcome.c.q, reference.c.q, rtol=0, atol=1e-12)
    np.testing.assert_allclose(outcome.c.fingers, reference.c.fingers, rtol=0, atol=1e-12)
    for name in c.poses:
        assert outcome.c.poses[name].tobytes() == c.poses[name].tobytes()
        np.testing.assert_allclose(outcome.c.poses[name], reference.c.poses[name], atol=1e-4)


# what begins to topple


@pytest.mark.parametrize(("ahead", "slow"), [(-0.002, True), (-0.001, False)])
def test_a_box_that_begins_to_topple_when_it_is_released_does_not_sleep(ahead: float, slow: bool) -> None:
    """It is nearly balanced on its support, and as slow as a box at rest when the hand is about to leave.

    The slab begins at this distance behind the box's center [m]; a box that is 2.03 mm inside stays. The slow one falls
    only because a box that gains speed is not put to sleep.
    """
    slab = SupportSpec("table", (G_X + 0.05 + ahead, 0.0, TOP), size=(0.1, 0.1, 0.02))
    thing = BoxSpec((SIDE, SIDE, TALL), (G_X, 0.0, TOP + TALL / 2), mass=0.1)
    spec = SceneSpec(supports={"slab": slab, "floor": TABLE}, boxes={"thing": thing}, goal="(on thing floor)")
    world = World(spec)
    closed, grip = np.full(2, SIDE / 2), GripperCommand(SIDE, 30.0)
    start = Configuration(HOME, closed, world.initial_configuration().poses, "thing", grip)
    c = PhysicsConfig().create(world).run(start, (allow_touches(stay(start, 0.3), "thing"),)).c
    assert c.held == "thing"
    up = turned_arm(0.0) + [0.0, -0.12, 0.0, 0.05, 0.0, 0.05, 0.0]
    motion = (
        allow_touches(stay(c, 0.16, OPEN, "release"), "thing", "slab"),
        allow_touches(way("retreat", turned_arm(0.0), up, 0.7, OPEN)),
    )
    speeds = []

    def watch(_: Segment, running: Physics) -> bool:
        speeds.append(len(running._find_moving()))
        return True

    PhysicsConfig().create(world).run(c, motion[:1], watch=watch)
    assert speeds == [0 if slow else 1], "whether it counts as moving after the release"
    outcome, reference, _ = run_both(world, c, motion)
    assert reference.c.poses["thing"][6] < TOP, "it falls"
    np.testing.assert_allclose(outcome.c.poses["thing"], reference.c.poses["thing"], atol=1e-4)
    assert outcome.settled == reference.settled
