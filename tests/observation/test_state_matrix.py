"""Content of the primitive state matrix, and its invariances."""

import json
from dataclasses import replace

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.math import RigidTransform, RotationMatrix

from ictamp_drake.core.types import Action, Configuration, FloatArray
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.observation.state_matrix import ROWS, SCHEMA, Observation, Observer
from ictamp_drake.scenes.packing import make_problem
from ictamp_drake.scenes.regions import PoseSpec, RegionSpec
from ictamp_drake.scenes.spec import ArmSpec, BoxSpec, SceneSpec
from ictamp_drake.scenes.training import training_scene
from ictamp_drake.world.frames import upright_frame
from ictamp_drake.world.poses import to_pose, to_transform
from ictamp_drake.world.world import World
from tests.panda import PANDA
from tests.world.scenes import RACK, TABLE, build_tower, hold_box, scene

TOWER = scene(build_tower("red_box", "blue_box") | build_tower("cyan_box", x=0.5, y=-0.1, yaws=(30.0,)))
PICK = Action("pick", ("blue_box", "red_box"))
PLACE = Action("place", ("cyan_box", "rack"))

numbers = st.integers(0, 63)
angles = st.floats(-np.pi, np.pi)
shifts = st.floats(-3.0, 3.0)


def resting_configuration(spec: SceneSpec) -> Configuration:
    """The boxes at their specified poses, and the arm somewhere."""
    q = np.array([0.1, -0.6, 0.2, -2.2, 0.1, 1.6, 0.5])
    return Configuration(q, np.full(2, 0.04), {name: box.X_WO for name, box in spec.boxes.items()})


def actions(spec: SceneSpec) -> list[Action]:
    """A pick and two placements of the first box, useful or not."""
    box = min(spec.boxes)
    others = [*spec.supports, *sorted(set(spec.boxes) - {box})]
    return [Action("pick", (box, others[0])), Action("place", (box, others[-1])), Action("place", (box, others[0]))]


def quantity(observation: Observation, row: int, *names: str) -> FloatArray:
    """Entries of a row in their units."""
    at = [SCHEMA.index(name) for name in names]
    return observation.matrix[row, at]


def quantities(observation: Observation, rows: slice, *names: str) -> FloatArray:
    """Entries of some rows in their units."""
    at = [SCHEMA.index(name) for name in names]
    return observation.matrix[rows][:, at]


def roles(observation: Observation) -> list[str]:
    """Role of each row that is present."""
    names = ("grasped", "held", "place", "other")
    at = [SCHEMA.index(f"is_{name}") for name in names]
    assert np.all(observation.matrix[observation.mask][:, at].sum(axis=1) == 1)
    return [names[int(np.argmax(row[at]))] if there else "" for row, there in zip(*observation, strict=True)]


def assert_same(one: Observation, other: Observation) -> None:
    np.testing.assert_array_equal(one.mask, other.mask)
    np.testing.assert_allclose(one.matrix, other.matrix, atol=2e-5)


def move_scene(spec: SceneSpec, c: Configuration, X: RigidTransform, degrees: float) -> tuple[SceneSpec, Configuration]:
    """The whole scene moved by X: a shift, and a turn by the angle about the vertical."""

    def position(of: tuple[float, float, float]) -> tuple[float, float, float]:
        x, y, z = X @ np.array(of)
        return float(x), float(y), float(z)

    arm = ArmSpec(position(spec.arm.position), spec.arm.yaw + degrees)
    supports = {
        name: replace(each, position=position(each.position), yaw=(each.yaw + degrees + 180) % 360 - 180)
        for name, each in spec.supports.items()
    }
    poses = {name: to_pose(X @ to_transform(pose)) for name, pose in c.poses.items()}
    return replace(spec, arm=arm, supports=supports), Configuration(c.q, c.fingers, poses, c.held, c.gripper)


@given(numbers, angles, shifts, shifts)
def test_the_place_of_the_whole_scene_in_the_world_does_not_matter(number: int, yaw: float, x: float, y: float) -> None:
    spec = training_scene(number)
    X = RigidTransform(RotationMatrix.MakeZRotation(yaw), [x, y, 0.3])
    there, c = move_scene(spec, resting_configuration(spec), X, float(np.degrees(yaw)))
    for action in actions(spec):
        assert_same(Observer(spec).observe(resting_configuration(spec), action), Observer(there).observe(c, action))


@given(numbers, st.randoms(use_true_random=False))
def test_names_do_not_matter(number: int, random: object) -> None:
    spec = training_scene(number)
    names = [*spec.boxes, *spec.supports]
    new = [f"thing_{index}" for index in range(len(names))]
    random.shuffle(new)  # type: ignore[attr-defined]
    called = dict(zip(names, new, strict=True))
    renamed = replace(
        spec,
        boxes={called[name]: box for name, box in spec.boxes.items()},
        supports={called[name]: support for name, support in spec.supports.items()},
    )
    for name, (box, place) in actions(spec):
        action = Action(name, (called[box], called[place]))
        one, other = Observer(spec).observe(resting_configuration(spec), Action(name, (box, place))), Observer(renamed)
        assert_same(one, other.observe(resting_configuration(renamed), action))


@given(numbers, st.floats(0.02, 0.3))
def test_moving_the_base_alone_changes_no_target_column(number: int, shift: float) -> None:
    spec = training_scene(number)
    there = replace(spec, arm=ArmSpec((shift, -shift, 0.0), 40.0))
    for action in actions(spec)[:1]:
        one, other = (
            Observer(spec).observe(resting_configuration(spec), action),
            Observer(there).observe(resting_configuration(spec), action),
        )
        target = SCHEMA.group("target")
        np.testing.assert_allclose(one.matrix[:3, target], other.matrix[:3, target], atol=2e-5)
        assert not np.allclose(one.matrix[0, :2], other.matrix[0, :2], atol=1e-3)


def test_changing_another_box_changes_its_own_row_only() -> None:
    observer, c = Observer(TOWER), resting_configuration(TOWER)
    elsewhere = Configuration(
        c.q, c.fingers, {**c.poses, "cyan_box": c.poses["cyan_box"] + [0, 0, 0, 0, 0.01, 0.0, 0.0]}
    )
    before, after = observer.observe(c, PICK), observer.observe(elsewhere, PICK)
    different = np.flatnonzero(np.any(before.matrix != after.matrix, axis=1))
    assert [roles(before)[row] for row in different] == ["other"]


def test_rows_of_a_pick_and_of_a_placement() -> None:
    observer, c = Observer(TOWER), resting_configuration(TOWER)
    assert roles(observer.observe(c, PICK)) == ["grasped", "", "place", "other", "other", "other", "", ""]
    assert roles(observer.observe(c, PLACE)) == ["", "held", "place", "other", "other", "other", "", ""]
    assert not observer.observe(c, PLACE).matrix[0].any()


def test_values_in_the_frames_of_base_and_target() -> None:
    pick = Observer(TOWER).observe(resting_configuration(TOWER), PICK)
    np.testing.assert_allclose(quantity(pick, 0, "base_x", "base_y", "base_z"), [0.5, 0.1, 0.118 + 0.053], atol=1e-6)
    np.testing.assert_allclose(quantity(pick, 0, "target_x", "target_y", "target_z"), 0.0, atol=1e-6)
    np.testing.assert_allclose(quantity(pick, 2, "target_x", "target_y", "target_z"), [0, 0, -0.112], atol=1e-6)
    np.testing.assert_allclose(quantity(pick, 2, "box_x", "box_y", "box_z"), [0.05, 0.05, 0.118], atol=1e-6)
    place = Observer(TOWER).observe(resting_configuration(TOWER), PLACE)
    np.testing.assert_allclose(quantity(place, 2, "support_x", "support_y", "support_z"), RACK.size, atol=1e-6)
    np.testing.assert_allclose(quantity(place, 2, "target_x", "target_y", "target_z"), [0, 0, -0.08], atol=1e-6)
    np.testing.assert_allclose(quantity(place, 2, "base_r00", "base_r10"), [0, 1], atol=1e-6)  # turned by 90 deg


def test_tipped_boxes_are_marked_and_lie_as_they_lie() -> None:
    tipped = BoxSpec((0.05, 0.06, 0.1), (0.5, 0.0, 0.03), (90.0, 0.0, 20.0))
    spec = scene({"red_box": tipped})
    seen = Observer(spec).observe(resting_configuration(spec), Action("pick", ("red_box", "table")))
    assert quantity(seen, 0, "is_tipped") == 1
    lying = upright_frame(tipped.X_WO, tipped.size)
    np.testing.assert_allclose(quantity(seen, 0, "box_x", "box_y", "box_z"), lying.size, atol=1e-6)
    columns = [f"base_r{row}{column}" for column in "01" for row in "012"]
    np.testing.assert_allclose(quantity(seen, 0, *columns), lying.X_WU.rotation().matrix()[:, :2].T.ravel(), atol=1e-6)


@pytest.mark.parametrize("rotation", [(180.0, 0.0, 20.0), (0.0, 180.0, 200.0)])
def test_a_box_on_its_head_looks_like_one_that_stands(rotation: tuple[float, float, float]) -> None:
    action, size, position = Action("pick", ("red_box", "table")), (0.05, 0.06, 0.1), (0.5, 0.0, 0.05)
    specs = [scene({"red_box": BoxSpec(size, position, turns)}) for turns in ((0.0, 0.0, 20.0), rotation)]
    standing, turned = (Observer(spec).observe(resting_configuration(spec), action).matrix for spec in specs)
    np.testing.assert_allclose(turned, standing, atol=1e-6)


def test_every_box_lies_as_frames_say() -> None:
    for number in range(24):
        spec = training_scene(number)
        for name, box in spec.boxes.items():
            seen = Observer(spec).observe(resting_configuration(spec), Action("pick", (name, "table")))
            lying = upright_frame(box.X_WO, box.size)
            np.testing.assert_allclose(quantity(seen, 0, "box_x", "box_y", "box_z"), lying.size, atol=1e-6)
            p_WU, x_W = lying.X_WU.translation(), lying.X_WU.rotation().matrix()[:, 0]
            np.testing.assert_allclose(quantity(seen, 0, "base_x", "base_y", "base_z"), p_WU, atol=1e-6)
            np.testing.assert_allclose(quantity(seen, 0, "base_r00", "base_r10", "base_r20"), x_W, atol=1e-6)


@pytest.mark.parametrize("roll", [0.0, 90.0])
def test_how_the_held_box_is_held(roll: float) -> None:
    spec = scene(build_tower("red_box"))
    world = World(spec)
    c = hold_box(world, "red_box", roll, drop=0.02)
    seen = Observer(spec).observe(c, Action("place", ("red_box", "table")))
    X_WG = ArmKinematics(PANDA, to_transform(spec.arm.X_WB)).forward(c.q)
    X_GU = X_WG.inverse() @ world.upright_frame(c, "red_box").X_WU
    np.testing.assert_allclose(quantity(seen, 1, "hand_x", "hand_y", "hand_z"), X_GU.translation(), atol=1e-6)
    columns = [f"hand_r{row}{column}" for column in "01" for row in "012"]
    np.testing.assert_allclose(quantity(seen, 1, *columns), X_GU.rotation().matrix()[:, :2].T.ravel(), atol=1e-6)
    hand = SCHEMA.group("hand")
    assert not np.delete(seen.matrix, 1, axis=0)[:, hand].any()


def test_the_nearest_stay_when_there_are_too_many() -> None:
    spots = [(0.35 + 0.1 * (i % 4), -0.3 + 0.15 * (i // 4)) for i in range(16)]
    boxes = {f"box_{i}": BoxSpec((0.04, 0.04, 0.06), (x, y, 0.03)) for i, (x, y) in enumerate(spots)}
    spec = SceneSpec(supports={"table": TABLE}, boxes=boxes, goal="(on box_0 table)")
    seen = Observer(spec).observe(resting_configuration(spec), Action("pick", ("box_0", "box_1")))
    assert seen.mask.tolist() == [True, False, *6 * [True]]  # no box is held
    nearby = sorted(min(np.hypot(x - x0, y - y0) for x0, y0 in spots[:2]) for x, y in spots[2:])
    found = quantities(seen, slice(3, ROWS), "base_x", "base_y")
    distances = [min(np.hypot(x - x0, y - y0) for x0, y0 in spots[:2]) for x, y in found[1:]]
    np.testing.assert_allclose(sorted(distances), nearby[:4], atol=1e-5)  # found[0] is the table below


def test_all_at_once_is_the_same_as_one_by_one() -> None:
    observer, c = Observer(TOWER), resting_configuration(TOWER)
    tilted = Configuration(c.q, c.fingers, {**c.poses, "cyan_box": c.poses["red_box"]})
    options = [(c, PICK), (tilted, PLACE), (c, PLACE), (tilted, PICK)]
    together = observer.observe_all(options)
    for number, option in enumerate(options):
        alone = observer.observe(*option)
        np.testing.assert_array_equal(together.matrix[number], alone.matrix)
        np.testing.assert_array_equal(together.mask[number], alone.mask)


@given(numbers, angles, shifts)
def test_where_a_box_went_is_told_in_the_target_frame(number: int, yaw: float, x: float) -> None:
    spec = training_scene(number)
    observer, c, box = Observer(spec), resting_configuration(spec), min(spec.boxes)
    lying = upright_frame(c.poses[box], spec.boxes[box].size)
    turn = RigidTransform(RotationMatrix.MakeZRotation(yaw), [x, 0.2, 0.04])
    for action, X_WK in (
        (Action("pick", (box, "table")), lying.X_WU),
        (Action("place", (box, "table")), to_transform(spec.supports["table"].X_WT)),
    ):
        X_WO = X_WK @ turn @ lying.X_WU.inverse() @ to_transform(c.poses[box])
        found = observer.measure_moved_box([(c, action)], to_pose(X_WO)[None])[0]
        np.testing.assert_allclose(found[:3], [x, 0.2, 0.04], atol=1e-9)
        np.testing.assert_allclose(np.exp(1j * found[3]), np.exp(1j * yaw), atol=1e-9)


def test_scaled_numbers_are_about_one() -> None:
    for level in ("easy", "medium", "hard"):
        for number in range(10):
            spec = make_problem(level, number)
            together = Observer(spec).observe_all([(resting_configuration(spec), action) for action in actions(spec)])
            assert together.matrix.dtype == np.float32
            scaled = together.matrix / SCHEMA.scales
            seen = scaled[together.mask][:, : SCHEMA.group("hand").start]
            assert np.abs(seen).max() < 5
            assert np.quantile(np.abs(seen), 0.9) < 1.2


def test_the_schema_names_every_column_once_and_is_json() -> None:
    names = [column.name for column in SCHEMA.columns]
    assert len(set(names)) == SCHEMA.width
    assert json.loads(json.dumps(SCHEMA.as_dict()))["version"] == SCHEMA.version
    assert [names[index] for index in range(*SCHEMA.group("box").indices(SCHEMA.width))] == ["box_x", "box_y", "box_z"]


def test_a_region_is_seen_as_the_place_of_an_action_only() -> None:
    """There it reads as a support of its size in its frame, and its own support is left out."""
    region = RegionSpec("table", (0.2, 0.1), (0.2, 0.1), yaw=30.0)
    spec = replace(TOWER, regions={"near": region}, poses={"spot": PoseSpec("table", (0.2, -0.2))})
    c, plain, divided = resting_configuration(TOWER), Observer(TOWER), Observer(spec)
    for action in (PICK, PLACE):
        for one, other in zip(plain.observe(c, action), divided.observe(c, action), strict=True):
            np.testing.assert_array_equal(one, other)
    seen = divided.observe(c, Action("place", ("cyan_box", "near")))
    before = plain.observe(c, Action("place", ("cyan_box", "table")))
    assert seen.mask.sum() == before.mask.sum()
    assert quantity(seen, 2, "support_x", "support_y") == pytest.approx([0.2, 0.1])
    assert quantity(seen, 2, "support_z") == quantity(before, 2, "support_z")
    assert quantity(seen, 2, "target_x", "target_y", "target_r00") == pytest.approx([0.0, 0.0, 1.0])
    assert quantity(seen, 2, "base_x", "base_y") == pytest.approx([TABLE.position[0] + 0.2, 0.1])
