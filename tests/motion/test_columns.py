"""Quick refusals of places, compared with the slow ones."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from pydrake.math import RigidTransform, RotationMatrix

from ictamp_drake.motion.columns import Columns
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.scenes.spec import ArmSpec, BoxSpec, SceneSpec, SupportSpec
from ictamp_drake.skills.base import imagine
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World
from tests.panda import GRIPPER, PANDA

DOWN = RotationMatrix.MakeXRotation(np.pi)
FAR = {"pebble": BoxSpec((0.03, 0.03, 0.03), (5.0, 5.0, 0.5))}
SPEC = SceneSpec(
    arm=ArmSpec((0.1, -0.2, 0.05), 40.0),
    supports={
        "board": SupportSpec("table", (0.5, 0.1, 0.3), 25.0, (0.3, 0.2, 0.02)),
        "rack": SupportSpec("rack", (0.35, -0.5, 0.25), -10.0, (0.3, 0.25, 0.2)),
    },
    boxes=FAR,
    goal="(on pebble board)",
)
places = st.tuples(st.floats(0.2, 0.8), st.floats(-0.7, 0.4), st.floats(0.0, 0.4))


@cache
def columns() -> tuple[World, ArmKinematics, Columns]:
    world = World(SPEC)
    arm = ArmKinematics(PANDA, to_transform(SPEC.arm.X_WB))
    return world, arm, Columns(world, arm)


@settings(max_examples=300, deadline=None)
@given(places, st.floats(-np.pi, np.pi), st.floats(0.0, 0.08))
def test_the_hand_touches_an_obstacle_that_is_named_at_any_yaw_and_opening(
    place: tuple[float, float, float], yaw: float, width: float
) -> None:
    world, arm, found = columns()
    (name,) = found.find_obstacles(np.array([place]))
    postures = arm.turning_postures(RigidTransform(DOWN, place))
    if not name or not len(postures):
        return
    q = postures[0].copy()
    q[6] -= yaw
    c = imagine(GRIPPER, world.initial_configuration(), q=q, width=width, held=None)
    assert name in [contact.other for contact in found.hand.contacts(c, q)]


@settings(max_examples=200, deadline=None)
@given(places)
def test_no_place_within_reach_is_too_far(place: tuple[float, float, float]) -> None:
    _, arm, found = columns()
    if len(arm.turning_postures(RigidTransform(DOWN, place))):
        assert found.is_within_reach(np.array([place]))[0]


@pytest.mark.parametrize("turn", [-2.0, 0.5])
def test_the_last_joint_turns_a_hand_that_points_down_the_other_way(turn: float) -> None:
    _, arm, _ = columns()
    q = arm.turning_postures(RigidTransform(DOWN, (0.5, 0.1, 0.2)))[0].copy()
    q[6] -= turn
    expected = RotationMatrix.MakeZRotation(turn) @ DOWN
    np.testing.assert_allclose(arm.forward(q).rotation().matrix(), expected.matrix(), atol=1e-9)
