"""Each robot that ships stacks boxes on a rack: solved, saved, loaded elsewhere, executed again, and looked at."""

from dataclasses import dataclass, replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest
import yaml
from pydrake.math import RigidTransform

import ictamp_drake as ict
from ictamp_drake.core.errors import Code
from ictamp_drake.core.types import Configuration
from ictamp_drake.robots.robot import find_robot
from ictamp_drake.robots.spec import DEFAULT, find_file
from ictamp_drake.scenes.levels import ARM_OFFSETS
from ictamp_drake.tamp.replay import Replay
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import ROBOT, World
from tests.refusals import refusal
from tests.robots import small

ROBOTS = (DEFAULT, "iiwa14_wsg50", "ur5e_2f85")
SCENE = ict.Scene(
    supports={
        "table": ict.Support(kind="table", position=(0.3, 0.0, 0.0)),
        "rack": ict.Support(kind="rack", position=(0.44, -0.33, 0.16), yaw=90),
    },
    boxes={
        "red_box": ict.Box(size=(0.05, 0.05, 0.08), position=(0.5, 0.15, 0.04)),
        "blue_box": ict.Box(size=(0.05, 0.06, 0.06), position=(0.45, 0.0, 0.03)),
    },
    goal="(and (on red_box rack) (on blue_box red_box))",
)
DEEPEST = 0.001
"""Depth to which a part of the robot may cut into a box [m]; measured are 0.2 mm, by the pads."""
FARTHEST = 0.003
"""Distance by which a box may creep in the hand from grasp to release [m]; measured are 1.4 mm."""


@dataclass(frozen=True)
class Case:
    """A plan that was read back in another folder, and its execution there."""

    found: ict.Plan
    plan: ict.Plan
    replay: Replay


@pytest.fixture(scope="module", params=ROBOTS)
def case(request: pytest.FixtureRequest, tmp_path_factory: pytest.TempPathFactory) -> Case:
    """The scene with each robot."""
    if request.param == "ur5e_2f85":
        pytest.importorskip("airo_models")
    spec = replace(SCENE, robot=request.param, arm=ict.Arm(position=ARM_OFFSETS.get(request.param, (0.0, 0.0, 0.0))))
    found = ict.solve(ict.load(spec), sampler="geometric", estimator="constant", time_limit=250).plan
    assert found is not None
    file = tmp_path_factory.mktemp("plans") / "plan.yaml"
    found.save(file)
    plan = ict.Plan.load(file)
    return Case(found, plan, plan.replay())


def test_the_plan_read_back_reaches_the_goal_bit_for_bit(case: Case) -> None:
    assert case.replay.reached
    assert case.plan.actions == case.found.actions
    assert [outcome.c for outcome in case.replay.outcomes] == [attempt.successor for attempt in case.found.attempts]


def test_torques_and_outputs_have_a_value_for_each_joint(case: Case) -> None:
    count = len(find_robot(case.plan.spec.robot).joints)
    assert case.plan.torque_shares.shape == (len(case.plan), count)
    assert 0 < case.plan.torque_shares.max() < 1
    assert case.plan.trajectory().rows() == count
    assert case.plan.system().GetOutputPort("desired_state").size() == 2 * count


def test_no_part_of_the_robot_cuts_through_anything(case: Case) -> None:
    world = World(case.plan.spec)
    physics = PhysicsConfig().create(world)
    for outcome in case.replay.outcomes:
        assert outcome.recording is not None
        for frame in physics.frames(outcome.recording)[::4]:
            for touch in world.touches(frame.c, 0.0):
                assert touch.distance > -DEEPEST or not {touch.a, touch.b} & ROBOT, touch


def test_held_boxes_stay_in_the_hand(case: Case) -> None:
    world = World(case.plan.spec)
    physics, gripper = PhysicsConfig().create(world), world.robot.gripper
    for picked, placed in zip(case.replay.outcomes[::2], case.replay.outcomes[1::2], strict=True):
        assert picked.c.held is not None
        assert placed.recording is not None
        width = gripper.width(picked.c.fingers)
        frames = [frame.c for frame in physics.frames(placed.recording)]
        last = next(c for c, after in pairwise(frames) if gripper.width(after.fingers) > width + 0.001)
        moved = pose_in_hand(world, picked.c, picked.c.held).inverse() @ pose_in_hand(world, last, picked.c.held)
        assert np.linalg.norm(moved.translation()) < FARTHEST


def pose_in_hand(world: World, c: Configuration, box: str) -> RigidTransform:
    X_WB = to_transform(world.spec.arm.X_WB)
    X_WG = X_WB @ RigidTransform(world.robot.forward(c.q[None])[0])
    return X_WG.inverse() @ to_transform(c.poses[box])


def test_a_plan_takes_its_robot_file_along(tmp_path: Path) -> None:
    """The path in a plan may be relative to the plan, wherever the program runs."""
    (tmp_path / "own.yaml").write_text(find_file(DEFAULT).read_text())
    spec = replace(SCENE, goal="(in-hand red_box)", robot=str(tmp_path / "own.yaml"))
    solution = ict.solve(ict.load(spec), time_limit=250)
    assert solution.plan is not None
    solution.plan.save(tmp_path / "plan.yaml")
    text = (tmp_path / "plan.yaml").read_text()
    assert f"robot: {tmp_path / 'own.yaml'}" in text
    (tmp_path / "plan.yaml").write_text(text.replace(f"robot: {tmp_path / 'own.yaml'}", "robot: own.yaml"))
    assert ict.Plan.load(tmp_path / "plan.yaml").replay().reached
    (tmp_path / "own.yaml").unlink()
    with refusal(Code.NOT_READABLE, file=tmp_path / "own.yaml"):
        ict.Plan.load(tmp_path / "plan.yaml")


@pytest.mark.parametrize(
    ("addition", "field", "code"),
    [
        ("touching: [[panda_link0, tail]]", "touching[0]", Code.UNKNOWN_CHOICE),
        ("collision: {tail: []}", "collision.tail", Code.UNKNOWN_CHOICE),
        ("kinematics: closed-form", "kinematics", Code.CONFLICT),
        ("home: [9, 0, 1.6, 0, 1, 0]", "home[0]", Code.OUT_OF_RANGE),
    ],
)
def test_a_mistake_in_a_robot_file_is_told_with_that_file(
    tmp_path: Path, addition: str, field: str, code: Code
) -> None:
    key = addition.partition(":")[0]
    file = small.write(tmp_path, {**small.content(), key: yaml.safe_load(addition)[key]})
    with refusal(code, field, file=file):
        ict.solve(ict.load(SCENE, robot=str(file)), max_steps=1)


def test_a_hand_weaker_than_the_usual_grip_uses_all_its_force(tmp_path: Path) -> None:
    content = {**yaml.safe_load(find_file(DEFAULT).read_text())}
    content["gripper"]["force"] = 10
    (tmp_path / "weak.yaml").write_text(yaml.safe_dump(content))
    task = ict.load(replace(SCENE, goal="(in-hand red_box)"), robot=str(tmp_path / "weak.yaml"))
    plan = ict.solve(task, sampler="geometric", estimator="constant", time_limit=250).plan
    assert plan is not None
    assert plan.attempts[0].motion[-1].gripper.force == 10


def test_a_model_that_was_edited_is_read_again(tmp_path: Path) -> None:
    file = str(small.write(tmp_path))
    robot = find_robot(file)
    assert find_robot(file) is robot
    model = (tmp_path / "small.urdf").read_text()
    (tmp_path / "small.urdf").write_text(model.replace('velocity="2"', 'velocity="1.5"'))
    assert (set(robot.velocity), set(find_robot(file).velocity)) == ({2.0}, {1.5})
    (tmp_path / "small.urdf").unlink()
    with refusal(Code.NOT_READABLE, file=tmp_path / "small.urdf"):
        find_robot(file)
