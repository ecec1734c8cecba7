"""Joints that can turn more than once: postures are turned to where the arm is, and keep away from the limits."""

from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.math import RigidTransform

import ictamp_drake as ict
from ictamp_drake.core.types import FloatArray
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.robots.chain import is_within, turn_near
from ictamp_drake.robots.robot import find_robot
from ictamp_drake.scenes.spec import BoxSpec, SupportSpec
from tests.robots import small
from tests.robots.arms import PANDA, SIX

TURN = 2 * np.pi
shares = st.lists(st.floats(0.0, 1.0), min_size=6, max_size=6).map(np.array)


@pytest.fixture(scope="module")
def arm(tmp_path_factory: pytest.TempPathFactory) -> ArmKinematics:
    """A small arm whose joints turn almost twice."""
    model = small.urdf().replace('lower="-2.9" upper="2.9"', 'lower="-6.2" upper="6.2"')
    return ArmKinematics(find_robot(str(small.write(tmp_path_factory.mktemp("arm"), model=model))), RigidTransform())


@given(shares, shares, st.floats(0.0, 1.0))
def test_joints_are_turned_to_the_aim_and_keep_away_from_their_limits(
    share: FloatArray, aim_share: FloatArray, spare: float
) -> None:
    q, aim = (np.pi * (2 * share - 1), SIX.limits[0] + aim_share * np.ptp(SIX.limits, axis=0))
    near = turn_near(q, aim, SIX.limits, spare)
    assert is_within(near, SIX.limits + [[spare], [-spare]]).all()
    turns = (near - q) / TURN
    np.testing.assert_allclose(turns, np.round(turns), atol=1e-9)
    for turn in (-TURN, TURN):
        there = is_within((near + turn)[:, None], (SIX.limits + [[spare], [-spare]])[:, :1])
        assert np.all(~there | (np.abs(near - aim) <= np.abs(near + turn - aim) + 1e-9))


def test_joints_with_less_than_a_turn_stay() -> None:
    q = np.random.default_rng(0).uniform(*PANDA.limits, (50, 7))
    np.testing.assert_array_equal(turn_near(q, PANDA.limits[1], PANDA.limits), q)


def test_a_joint_without_limits_is_turned_as_far_as_the_aim() -> None:
    limits = np.array([[-np.inf], [np.inf]])
    np.testing.assert_allclose(turn_near(np.array([0.1]), np.array([50.0]), limits, 0.5), 0.1 + 8 * TURN)


def test_the_arm_does_not_unwind_to_reach_a_pose_near_by(arm: ArmKinematics) -> None:
    for wound in (4.0, -4.0, 5.0):
        q = np.array([wound, 0.3, 1.2, 0.2, 1.3, -wound])
        found = arm.solve(arm.forward(q), q + 0.01)
        assert found is not None
        np.testing.assert_allclose(found, q, atol=1e-6)
        assert arm.travel_times(arm.forward(q).GetAsMatrix4()[None], q)[0] < 1e-6


def test_an_arm_that_is_almost_wound_up_unwinds(arm: ArmKinematics) -> None:
    q = np.array([6.1, 0.3, 1.2, 0.2, 1.3, 0.0])
    found = arm.solve(arm.forward(q), q)
    assert found is not None
    assert is_within(found, np.array([arm.lower + 0.4, arm.upper - 0.4]))


def test_a_line_across_half_a_turn_goes_on(arm: ArmKinematics) -> None:
    q = np.array([np.pi - 0.05, 0.3, 1.2, 0.2, 1.3, 0.0])
    start = arm.solve(arm.forward(q), q)
    assert start is not None
    X_WG = arm.forward(q + 0.1 * np.eye(6)[0])
    path = arm.line(start, X_WG)
    assert path is not None
    assert path[-1, 0] > np.pi
    again = arm.solve(X_WG, path[-1])
    assert again is not None
    np.testing.assert_allclose(again, path[-1], atol=1e-3)


def test_a_plan_of_an_arm_without_limits_is_read_back(tmp_path: Path) -> None:
    model = small.urdf().replace('type="revolute"', 'type="continuous"', 1).replace('lower="-2.9" upper="2.9" ', "", 1)
    table = SupportSpec("table", (0.35, 0.0, 0.0), size=(0.5, 0.7, 0.05))
    box = BoxSpec((0.04, 0.04, 0.06), (0.35, 0.15, 0.03))
    robot = str(small.write(tmp_path, model=model))
    scene = ict.Scene(robot=robot, supports={"table": table}, boxes={"cup": box}, goal="(on cup table)")
    plan = ict.solve(ict.load(scene)).plan
    assert plan is not None
    plan.save(tmp_path / "plan.yaml")
    assert ict.Plan.load(tmp_path / "plan.yaml").c == plan.c
