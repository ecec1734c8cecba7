"""Opening of the hand in a placement: as wide as the neighbors allow, or refused before its motion is planned."""

from dataclasses import replace

import numpy as np
import pytest

from ictamp_drake.core.types import Configuration, GripperCommand, Motion, Parameter
from ictamp_drake.motion.planner import MotionPlanner, Refusal
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec
from ictamp_drake.skills.config import CLEARANCES, PlaceConfig
from ictamp_drake.skills.context import SkillContext
from ictamp_drake.world.commands import obedience_time
from ictamp_drake.world.world import ARM, FINGERS, World
from tests.panda import GRIPPER
from tests.skills.rig import pick, place, rig
from tests.world.scenes import scene

SIDE = 0.05
GRASP = np.array([0.0, 0.0, 0.03, 0.0])
HERE = np.array([0.2, -0.1, 0.002, 0.0])
"""Placement on the table, at (0.5, -0.1) in W, with the fingers along y."""


def _between(gap: float) -> SceneSpec:
    """A box elsewhere, and room for it between two others, at these distances from its sides along y [m]."""
    y = SIDE / 2 + gap + 0.03
    walls = {
        side: BoxSpec((0.06, 0.06, 0.08), (0.5, -0.1 + sign * y, 0.04)) for side, sign in (("left", 1), ("right", -1))
    }
    return scene({"moved": BoxSpec((SIDE, SIDE, 0.1), (0.5, 0.2, 0.05)), **walls})


class Counting(MotionPlanner):
    """A motion planner that counts the transfers that it plans."""

    transfers = 0

    def transfer(self, *arguments: object) -> object:  # type: ignore[override]
        self.transfers += 1
        return super().transfer(*arguments)  # type: ignore[arg-type]


def carry_box(spec: SceneSpec) -> Configuration:
    """The box in the hand."""
    setup = rig(spec)
    picked = setup.attempt(setup.start, pick("moved", "table"), k=GRASP)
    assert picked.succeeded, picked.detail
    assert picked.successor is not None
    return picked.successor


@pytest.fixture(scope="module")
def held() -> Configuration:
    return carry_box(_between(0.1))


def hold_in_scene(spec: SceneSpec, held: Configuration) -> Configuration:
    """The same box in the hand, in a scene with other neighbors."""
    poses = {**World(spec).initial_configuration().poses, "moved": held.poses["moved"]}
    return replace(held, poses=poses, x=None)


def plan_placement(
    spec: SceneSpec, held: Configuration, k: Parameter = HERE, config: PlaceConfig | None = None
) -> tuple[Motion | Refusal, int]:
    """Plan a placement: the motion or the reason why there is none, and the number of planned transfers."""
    world = World(spec)
    planner = Counting(world)
    skill = (config or PlaceConfig()).create(SkillContext(world, planner))
    motion = skill.plan(hold_in_scene(spec, held), place("moved", "table"), k, np.random.default_rng(0))
    return motion, planner.transfers


@pytest.mark.parametrize(("gap", "clearance"), [(0.1, CLEARANCES[0]), (0.023, CLEARANCES[1]), (0.020, CLEARANCES[2])])
def test_neighbours_make_the_hand_open_less(held: Configuration, gap: float, clearance: float) -> None:
    motion, _ = plan_placement(_between(gap), held)
    assert not isinstance(motion, Refusal), motion
    commands = {segment.label: segment.gripper for segment in motion}
    assert commands["transfer"] == commands["lower"] == held.gripper
    assert commands["release"] == commands["retreat"]
    assert commands["release"].force == 0
    assert commands["release"].width == pytest.approx(SIDE + 2 * clearance, abs=1e-3)
    assert commands["release"].width >= SIDE + 2 * clearance - 1e-4
    before_retreat = motion[:-1]
    duration = sum(segment.duration for segment in before_retreat)
    assert obedience_time(held.gripper, before_retreat, GRIPPER.speed) <= duration


def test_where_the_fingers_have_no_room_to_open_nothing_dear_is_planned(held: Configuration) -> None:
    """The closed fingers fit between the neighbors, but cannot let go there."""
    for spec, expected in ((_between(0.017), 0), (_between(0.1), 1)):
        motion, transfers = plan_placement(spec, held)
        assert transfers == expected
        assert isinstance(motion, Refusal) == (expected == 0)
        if isinstance(motion, Refusal):
            assert motion.obstacle in {"left", "right"}
    motion, _ = plan_placement(_between(0.017), held, config=PlaceConfig(clearances=(0.0005,)))
    assert not isinstance(motion, Refusal)


def test_a_placement_between_neighbours_touches_none_of_them() -> None:
    spec = _between(0.020)
    setup = rig(spec)
    c = carry_box(spec)
    attempt = setup.attempt(c, place("moved", "table"), k=HERE)
    assert attempt.failure is None, attempt.detail
    assert attempt.successor is not None
    assert attempt.successor.gripper.width < SIDE + 2 * CLEARANCES[-2]
    assert attempt.recording is not None
    for frame in setup.physics.frames(attempt.recording):
        for touch in setup.world.touches(frame.c, 0.0):
            bodies = {touch.a, touch.b}
            assert not (bodies & {ARM, *FINGERS, "moved"} and bodies & {"left", "right"}), bodies
    for side in ("left", "right"):
        np.testing.assert_allclose(attempt.successor.poses[side], setup.start.poses[side], atol=1e-4)


def test_the_next_pick_starts_from_the_opening_that_the_placement_left() -> None:
    spec = _between(0.020)
    setup = rig(spec)
    c = carry_box(spec)
    placed = setup.attempt(c, place("moved", "table"), k=HERE).successor
    assert placed is not None
    assert isinstance(placed.gripper, GripperCommand)
    np.testing.assert_allclose(2 * placed.fingers, placed.gripper.width, atol=5e-4)
    again = setup.attempt(placed, pick("moved", "table"), k=GRASP)
    assert again.failure is None, again.detail
    assert again.motion[0].label == "approach"
    assert again.motion[0].gripper.width == pytest.approx(placed.gripper.width, abs=1e-3)
