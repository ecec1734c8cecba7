"""Out of reach and joint limits are told apart where a refusal is reported, and not while it is made."""

from pathlib import Path

import numpy as np
import pytest
from pydrake.math import RigidTransform

import ictamp_drake as ict
from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import FloatArray
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.motion.planner import MotionPlanner, Refusal
from ictamp_drake.motion.reach import OUT_OF_REACH, Reach
from ictamp_drake.robots.robot import find_robot
from ictamp_drake.runs.records import append, read_records, record_of
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, SupportSpec
from ictamp_drake.world.poses import to_pose
from ictamp_drake.world.world import World
from tests.robots import small

ELBOW = np.array([0.2, 0.3, 0.4, 0.1, 0.6, 0.2])
"""Postures with this bend of the elbow, or the opposite one, are the only ones for their pose."""


def far_scene(robot: str) -> SceneSpec:
    """A cup that no arm reaches."""
    supports = {"table": SupportSpec("table", (0.0, 3.0, 0.1), size=(0.2, 0.2, 0.02))}
    box = BoxSpec((0.05, 0.05, 0.05), (0.0, 3.0, 0.125))
    return SceneSpec(supports=supports, boxes={"cup": box}, goal="(in-hand cup)", robot=robot)


@pytest.fixture(scope="module")
def stiff(tmp_path_factory: pytest.TempPathFactory) -> str:
    """File of a small arm whose elbow turns from 1 to 2 rad."""
    model = small.urdf()
    start = model.index('name="elbow"')
    model = model[:start] + model[start:].replace('lower="-2.9" upper="2.9"', 'lower="1.0" upper="2.0"', 1)
    return str(small.write(tmp_path_factory.mktemp("stiff"), model=model))


def pose(robot: str, q: FloatArray) -> RigidTransform:
    return ArmKinematics(find_robot(robot), RigidTransform()).forward(q)


def test_a_pose_is_out_of_reach_or_beyond_the_limits_of_a_joint_or_neither(stiff: str) -> None:
    reach = Reach(far_scene(stiff))
    far = RigidTransform([5.0, 0.0, 0.2])
    bent = ELBOW + [0.0, 0.0, 1.0, 0.0, 0.0, 0.0]
    poses = [to_pose(X) for X in (far, pose(stiff, ELBOW), pose(stiff, bent))]
    assert [reach.blame(each) for each in poses] == [OUT_OF_REACH, "elbow", None]
    assert reach.count(poses + poses[:1]) == {OUT_OF_REACH: 2, "elbow": 1}
    assert list(reach.count(poses[::-1] + poses[:1])) == [OUT_OF_REACH, "elbow"]
    words = [reach.describe(each) for each in poses]
    assert len(set(words)) == 3
    assert "elbow" in words[1]
    assert words[2] == ""


def test_of_many_poses_some_are_looked_at(stiff: str) -> None:
    reach = Reach(far_scene(stiff))
    assert 0 < reach.count([to_pose(RigidTransform([5.0, 0.0, 0.2]))] * 1000).total() < 100
    assert not reach.count([])


def test_the_planner_keeps_the_pose_that_it_refuses(stiff: str) -> None:
    world = World(far_scene(stiff))
    planner, c = MotionPlanner(world), world.initial_configuration()
    X_WG = pose(stiff, ELBOW)
    refusal = planner.posture(c, X_WG, world.robot.home)
    assert isinstance(refusal, Refusal)
    assert refusal.failure is Failure.NO_INVERSE_KINEMATICS
    assert refusal.unreached is not None
    assert refusal.unreached.IsExactlyEqualTo(X_WG)
    assert Reach(world.spec).blame(to_pose(refusal.unreached)) == "elbow"


def search_in_vain() -> ict.Solution:
    """A search for a plan that grasps what no arm reaches."""
    task = ict.load(far_scene("panda"))
    return ict.solve(task, sampler="uniform", sweep=False, max_steps=2, estimator="constant")


def test_an_explanation_says_that_a_box_is_out_of_reach() -> None:
    solution = search_in_vain()
    explanation = solution.explain()
    (blocked,) = explanation.blocked
    assert set(blocked.beyond) == {OUT_OF_REACH}
    assert sum(blocked.beyond.values()) == blocked.refusals[Failure.NO_INVERSE_KINEMATICS]
    assert "out of reach" in blocked.refused


def test_records_hold_what_explanations_say(tmp_path: Path) -> None:
    solution = ict.solve(
        ict.load(far_scene("panda")), sampler="uniform", sweep=False, max_steps=2, estimator="constant"
    )
    append(record_of("far", "", None, 0, solution), tmp_path / "records.jsonl")
    (record,) = read_records(tmp_path / "records.jsonl").values()
    assert record.explanation.blocked == solution.explain().blocked


def test_a_sweep_tells_out_of_reach_from_limits_of_joints(stiff: str) -> None:
    far = ict.solve(ict.load(far_scene("panda"))).explain()
    near = SceneSpec(
        supports={"table": SupportSpec("table", (0.3, 0.0, 0.0))},
        boxes={"cup": BoxSpec((0.05, 0.05, 0.05), (0.57, 0.0, 0.025))},
        goal="(in-hand cup)",
        robot=stiff,
    )
    limited = ict.solve(ict.load(near)).explain()
    for explanation, cause in ((far, OUT_OF_REACH), (limited, "elbow")):
        (blocked,) = explanation.blocked
        assert blocked.swept
        assert set(blocked.beyond) == {cause}
        assert cause in blocked.refused
