"""Imagined situations look like the configurations that they predict."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from pydrake.math import RigidTransform, RotationMatrix

from ictamp_drake.core.types import Action, Configuration, FloatArray
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.observation.situations import ABSENT, LIFT, Situations
from ictamp_drake.observation.state_matrix import Observation, Observer
from ictamp_drake.scenes.training import training_scene
from ictamp_drake.skills.config import PickConfig
from ictamp_drake.skills.geometry import grasp_parameter, grasp_pose, raise_pose
from ictamp_drake.world.poses import to_pose, to_transform
from ictamp_drake.world.world import World
from tests.panda import PANDA
from tests.world.scenes import far_boxes, hold_box, scene

WORLD = World(scene(far_boxes()))
OBSERVER = Observer(WORLD.spec)
PLACE = Action("place", ("red_box", "cyan_box"))
PICK = Action("pick", ("red_box", "table"))
K = np.array([0.004, -0.006, 0.01, 0.4])

angles = st.floats(-np.pi, np.pi)
shifts = st.floats(-0.2, 0.2)


def imagine(c: Configuration, action: Action, k: FloatArray, after: Configuration) -> Situations:
    """c after the action, when its box ends where it is in another configuration."""
    moved = OBSERVER.measure_moved_box([(c, action)], after.poses[action.args[0]][None])
    return OBSERVER.situations([c]).predict_after(OBSERVER.steps([action]), k[None], moved)


def assert_seen_alike(situations: Situations, c: Configuration) -> None:
    places = [PLACE, Action("place", ("red_box", "rack"))]
    for action in places if c.held else [PICK, Action("pick", ("blue_box", "red_box"))]:
        foretold, seen = OBSERVER.see(situations, OBSERVER.steps([action])), OBSERVER.observe_all([(c, action)])
        np.testing.assert_array_equal(foretold.mask, seen.mask)
        np.testing.assert_allclose(foretold.matrix, seen.matrix, atol=2e-5)


def turn_box(c: Configuration, box: str, p_W: FloatArray, yaw: float, held: str | None) -> Configuration:
    """c with one box shifted, and turned about the vertical through its center."""
    X_WO = to_transform(c.poses[box])
    rotation = RotationMatrix.MakeZRotation(yaw) @ X_WO.rotation()
    pose = to_pose(RigidTransform(rotation, X_WO.translation() + p_W))
    return Configuration(c.q, c.fingers, {**c.poses, box: pose}, held, c.gripper)


def test_a_picked_box_is_held_as_the_grasp_says() -> None:
    held = hold_box(WORLD, "red_box", drop=0.01)
    X_WG = ArmKinematics(PANDA, to_transform(WORLD.spec.arm.X_WB)).forward(held.q)
    before = turn_box(held, "red_box", np.array([0.002, 0.001, -LIFT]), 0.1, None)
    k = grasp_parameter(WORLD, before, "red_box", raise_pose(X_WG, -LIFT))
    assert_seen_alike(imagine(before, PICK, k, held), held)


def test_the_hand_rises_with_the_box_from_the_grasp() -> None:
    c = WORLD.initial_configuration()
    situations = imagine(c, PICK, K, c)
    X_WB = to_transform(WORLD.spec.arm.X_WB)
    expected = raise_pose(grasp_pose(WORLD, c, "red_box", K), PickConfig().lift)
    np.testing.assert_allclose(X_WB.GetAsMatrix4() @ situations.X_BG[0], expected.GetAsMatrix4(), atol=1e-9)


@given(shifts, shifts, angles)
def test_a_placed_box_is_seen_where_it_went(x: float, y: float, yaw: float) -> None:
    held = hold_box(WORLD, "red_box", drop=0.01)
    put = turn_box(held, "red_box", np.array([x, y, -0.2]), yaw, None)
    assert_seen_alike(imagine(held, PLACE, K, put), put)


def test_the_hand_lets_go_where_it_holds_the_box() -> None:
    held = hold_box(WORLD, "red_box", drop=0.01)
    put = turn_box(held, "red_box", np.array([0.1, 0.05, -0.2]), 0.7, None)
    before, after = OBSERVER.situations([held]), imagine(held, PLACE, K, put)
    box = OBSERVER.steps([PLACE]).box[0]
    assert after.held[0] == ABSENT
    np.testing.assert_allclose(
        np.linalg.inv(after.X_BG[0]) @ after.X_BU[0, box],
        np.linalg.inv(before.X_BG[0]) @ before.X_BU[0, box],
        atol=1e-9,
    )


@given(st.integers(0, 63), angles, shifts)
def test_nothing_else_moves(number: int, yaw: float, x: float) -> None:
    spec = training_scene(number)
    observer, box = Observer(spec), min(spec.boxes)
    c = Configuration(np.zeros(7), np.zeros(2), {name: each.X_WO for name, each in spec.boxes.items()})
    steps = observer.steps([Action("pick", (box, "table")), Action("place", (box, "table"))])
    before = observer.situations([c, c])
    after = before.predict_after(steps, np.tile(K, (2, 1)), np.array([[x, 0.0, 0.1, yaw]] * 2))
    others = np.delete(np.arange(before.X_BU.shape[1]), steps.box[0])
    np.testing.assert_array_equal(after.X_BU[:, others], before.X_BU[:, others])
    assert (after.X_BU[:, steps.box[0]] != before.X_BU[:, steps.box[0]]).any()
    assert after.held.tolist() == [steps.box[0], ABSENT]


def test_situations_can_be_repeated() -> None:
    c, held = WORLD.initial_configuration(), hold_box(WORLD, "red_box")
    situations = OBSERVER.situations([c, held]).select(np.array([1, 0, 1]))
    seen = OBSERVER.see(situations, OBSERVER.steps([PLACE, PICK, PLACE]))
    for number, option in enumerate([(held, PLACE), (c, PICK), (held, PLACE)]):
        expected = OBSERVER.observe(*option)
        assert isinstance(expected, Observation)
        np.testing.assert_array_equal(seen.matrix[number], expected.matrix)
        np.testing.assert_array_equal(seen.mask[number], expected.mask)
