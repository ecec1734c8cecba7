"""What a sweep refuses, the skill refuses, too; what the skill can do, no sweep refuses."""

from dataclasses import replace
from itertools import islice
from pathlib import Path

import numpy as np
import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from ictamp_drake.core.types import Action
from ictamp_drake.motion.config import KinematicsConfig, MotionConfig
from ictamp_drake.motion.planner import MotionPlanner, Refusal
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, SupportSpec, load_scene
from ictamp_drake.skills.config import PickConfig, PlaceConfig, UniformConfig
from ictamp_drake.skills.context import SkillContext
from ictamp_drake.skills.grid import Face
from ictamp_drake.skills.sweep import Sweep
from ictamp_drake.skills.uniform import UniformSampler
from ictamp_drake.world.start import find_overlaps
from ictamp_drake.world.world import World
from tests.robots import small

SHELF = load_scene(Path(__file__).parents[1] / "scenes" / "cases" / "07-wholly-under-a-shelf.yaml")
UNIFORM = UniformConfig(yaw=(-np.pi, np.pi))


def sweep(world: World) -> Sweep:
    return Sweep(world, MotionConfig(), PickConfig(), PlaceConfig())


def with_board(position: tuple[float, float, float]) -> World:
    """The box and a board somewhere."""
    board = replace(SHELF.supports["board"], position=position)
    return World(replace(SHELF, supports={**SHELF.supports, "board": board}))


@pytest.mark.parametrize("height", [0.2, 0.3, 0.4])
def test_no_grasp_of_a_box_under_a_board(height: float) -> None:
    world = with_board((0.6, 0.05, height))
    refused = sweep(world).refuse_grasps(world.initial_configuration(), "jar")
    assert refused is not None
    assert set(refused) == {"board"}


@pytest.mark.parametrize("position", [(0.6, 0.05, 0.55), (0.6, 0.32, 0.2), (0.83, 0.05, 0.2)])
def test_a_grasp_beside_a_board_or_far_below_it(position: tuple[float, float, float]) -> None:
    world = with_board(position)
    assert sweep(world).refuse_grasps(world.initial_configuration(), "jar") is None


@pytest.mark.parametrize(("height", "is_refused"), [(0.2, True), (0.55, False)])
def test_placements_below_a_board(height: float, is_refused: bool) -> None:
    world = with_board((0.42, -0.27, height))
    c = world.initial_configuration()
    face = Face(world.X_WT(c, "tray"), world.top_size(c, "tray") / 2)
    refused = sweep(world).refuse_placements(c, "jar", face)
    assert (refused is not None) is is_refused
    assert not is_refused or max(refused, key=refused.__getitem__) == "board"


@pytest.mark.parametrize("distance", [0.95, 3.0])
def test_what_is_far_away_is_out_of_reach(distance: float) -> None:
    supports = {"table": SupportSpec("table", (0.0, distance, 0.1), size=(0.2, 0.2, 0.02))}
    box = BoxSpec((0.05, 0.05, 0.05), (0.0, distance, 0.125))
    world = World(SceneSpec(supports=supports, boxes={"cup": box}, goal="(on cup table)"))
    c = world.initial_configuration()
    face = Face(world.X_WT(c, "table"), world.top_size(c, "table") / 2)
    for refused in (sweep(world).refuse_grasps(c, "cup"), sweep(world).refuse_placements(c, "cup", face)):
        assert refused is not None
        assert set(refused) == {""}
        assert refused.total() > 0


def test_boxes_are_not_in_the_way() -> None:
    wall = {f"wall_{i}": BoxSpec((0.05, 0.05, 0.3), (0.57 + dx, 0.05, 0.15)) for i, dx in enumerate((-0.06, 0.06))}
    supports = {"table": SHELF.supports["table"]}
    world = World(replace(SHELF, supports=supports, boxes={**SHELF.boxes, **wall}))
    assert sweep(world).refuse_grasps(world.initial_configuration(), "jar") is None


def test_a_box_in_a_pit_that_is_too_narrow_for_the_fingers() -> None:
    walls = [(0.055, 0.0, (0.05, 0.16, 0.1)), (-0.055, 0.0, (0.05, 0.16, 0.1)), (0.0, 0.055, (0.06, 0.05, 0.1))]
    sides = {f"side_{i}": SupportSpec("table", (0.5 + x, y, 0.1), size=size) for i, (x, y, size) in enumerate(walls)}
    box = BoxSpec((0.055, 0.055, 0.09), (0.5, 0.0, 0.045))
    supports = {"table": SupportSpec("table", (0.3, 0.0, 0.0)), **sides}
    world = World(SceneSpec(supports=supports, boxes={"jar": box}, goal="(on jar table)"))
    refused = sweep(world).refuse_grasps(world.initial_configuration(), "jar")
    assert refused is not None
    assert set(refused) == set(sides)


blocks = st.lists(
    st.tuples(
        st.floats(-0.2, 0.2),
        st.floats(-0.2, 0.2),
        st.floats(0.05, 0.45),
        st.floats(-180, 180),
        st.tuples(st.floats(0.03, 0.35), st.floats(0.03, 0.35), st.floats(0.02, 0.1)),
    ),
    min_size=1,
    max_size=3,
)


@settings(max_examples=15, deadline=None)
@given(st.floats(0.3, 0.9), st.floats(-0.3, 0.3), st.floats(-90, 90), blocks, st.integers(0, 2**32 - 1))
def test_the_skill_refuses_what_a_sweep_refuses(
    x: float, y: float, yaw: float, around: list[tuple[float, float, float, float, tuple[float, ...]]], seed: int
) -> None:
    supports = {
        f"block_{i}": SupportSpec("table", (x + dx, y + dy, z), turn, size)
        for i, (dx, dy, z, turn, size) in enumerate(around)
    }
    box = BoxSpec((0.045, 0.06, 0.08), (x, y, 0.04), (0.0, 0.0, yaw))
    floor = {"table": SupportSpec("table", (0.5, 0.0, 0.0))}
    world = World(SceneSpec(supports={**floor, **supports}, boxes={"jar": box}, goal="(on jar table)"))
    c = world.initial_configuration()
    assume(not find_overlaps(world, c))
    if sweep(world).refuse_grasps(c, "jar") is None:
        return
    planner, action, rng = MotionPlanner(world), Action("pick", ("jar", "table")), np.random.default_rng(seed)
    skill = PickConfig().create(SkillContext(world, planner))
    for k in islice(UniformSampler(world, UNIFORM).draws(c, action, rng), 6):
        assert isinstance(skill.plan(c, action, k, rng), Refusal)


def far_box(robot: str) -> World:
    """A cup that no arm reaches."""
    supports = {"table": SupportSpec("table", (0.0, 3.0, 0.1), size=(0.2, 0.2, 0.02))}
    box = BoxSpec((0.05, 0.05, 0.05), (0.0, 3.0, 0.125))
    return World(SceneSpec(supports=supports, boxes={"cup": box}, goal="(on cup table)", robot=robot))


def test_a_sweep_says_nothing_of_an_arm_whose_ends_do_not_turn_as_it_takes_for_granted(tmp_path: Path) -> None:
    spoiled = small.content()
    spoiled["gripper"]["grasp"]["position"] = [0.02, 0.0, 0.095]
    for name in "ab":
        (tmp_path / name).mkdir()
    plain, crooked = (small.write(tmp_path / name, content) for name, content in (("a", None), ("b", spoiled)))
    for file, is_known in ((plain, True), (crooked, False)):
        world = far_box(str(file))
        assert bool(world.robot.wrist and world.robot.waist) is is_known
        c = world.initial_configuration()
        face = Face(world.X_WT(c, "table"), world.top_size(c, "table") / 2)
        assert (sweep(world).refuse_grasps(c, "cup") is not None) is is_known
        assert (sweep(world).refuse_placements(c, "cup", face) is not None) is is_known


def test_a_sweep_says_nothing_where_postures_may_be_missed() -> None:
    world = far_box("panda")
    motion = MotionConfig(kinematics=KinematicsConfig(kind="numeric"))
    numeric = Sweep(world, motion, PickConfig(), PlaceConfig())
    assert numeric.refuse_grasps(world.initial_configuration(), "cup") is None
