"""Shares of the torque limits that a plan uses."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pydrake.math import RigidTransform

from ictamp_drake.core.types import Action, Attempt, Configuration, FloatArray, GripperCommand, Segment
from ictamp_drake.robots.robot import find_robot
from ictamp_drake.runs.records import Record, append, read_records
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, SupportSpec
from ictamp_drake.tamp.plan import Plan
from ictamp_drake.tamp.torque_use import TorqueUse
from ictamp_drake.world.poses import to_pose
from ictamp_drake.world.world import World
from tests.robots import small
from tests.runs.plans import small_plan

GRAVITY, LIMIT = 9.81, 80.0
STRETCHED = np.array([0.0, np.pi / 2, 0.0, 0.0, 0.0, 0.0])
LEVERS = {0.11: 0.5, 0.34: 0.5, 0.49: 0.5, 0.615: 0.5, 0.695: 0.5, 0.73: 0.5, 0.785: 0.1}
"""Distances of the parts' centers from the shoulder when the arm is stretched out [m], and their masses [kg]."""
PICK = Action("pick", ("cup", "table"))


@pytest.fixture(scope="module")
def spec(tmp_path_factory: pytest.TempPathFactory) -> SceneSpec:
    """A cup of 0.3 kg and the small arm."""
    robot = str(small.write(tmp_path_factory.mktemp("robot")))
    supports = {"table": SupportSpec("table", (0.3, 0.0, 0.0))}
    boxes = {"cup": BoxSpec((0.05, 0.06, 0.07), (0.4, 0.0, 0.035), mass=0.3)}
    return SceneSpec(supports=supports, boxes=boxes, goal="(in-hand cup)", robot=robot)


def still(q: FloatArray, force: float = 0.0) -> Segment:
    return Segment("stand", 0.5, GripperCommand(0.06, force), 1, np.array([0.0, 0.5]), q[None])


def swing(start: FloatArray, end: FloatArray, duration: float) -> Segment:
    """A smooth motion from rest to rest."""
    knots = duration * np.concatenate([np.zeros(4), [0.25, 0.5, 0.75], np.ones(4)])
    points = start + np.array([0.0, 0.0, 0.15, 0.5, 0.85, 1.0, 1.0])[:, None] * (end - start)
    return Segment("swing", duration, GripperCommand(0.08), 4, knots, points)


def plan(spec: SceneSpec, *segments: Segment, held: Configuration | None = None) -> Plan:
    """A plan with a step for each segment."""
    c = World(spec).initial_configuration()
    return Plan(spec, c, tuple(Attempt(PICK, None, held, motion=(segment,)) for segment in segments))


def test_an_arm_that_stands_still_bears_its_weight(spec: SceneSpec) -> None:
    shares = plan(spec, still(STRETCHED), still(np.zeros(6))).torque_shares
    expected = GRAVITY * sum(lever * mass for lever, mass in LEVERS.items()) / LIMIT
    assert shares.shape == (2, 6)
    assert shares[0, 1] == pytest.approx(expected, rel=1e-9)
    assert shares[0, 0] == pytest.approx(0.0, abs=1e-12)
    np.testing.assert_allclose(shares[1], 0.0, atol=1e-12)


def test_a_held_box_weighs_where_it_is_held(spec: SceneSpec) -> None:
    c = World(spec).initial_configuration()
    X_WG = find_robot(spec.robot).forward(STRETCHED[None])[0]
    X_WO = np.eye(4)
    X_WO[:3, 3] = X_WG[:3, 3] + 0.01 * X_WG[:3, 2]  # 1 cm further out
    held = replace(c, q=STRETCHED, held="cup", poses={"cup": to_pose(RigidTransform(X_WO))})
    empty = plan(spec, still(STRETCHED)).torque_shares[0, 1]
    known = plan(spec, still(STRETCHED, 20.0), held=held).torque_shares[0, 1]
    assert known - empty == pytest.approx(GRAVITY * 0.3 * 0.815 / LIMIT, rel=1e-9)
    guessed = plan(spec, still(STRETCHED, 20.0)).torque_shares[0, 1]
    assert guessed - empty == pytest.approx(GRAVITY * 0.3 * 0.805 / LIMIT, rel=1e-9)
    released = plan(spec, still(STRETCHED), held=held).torque_shares[0, 1]
    assert released == empty


def test_a_motion_twice_as_fast_takes_four_times_the_torque_that_accelerates(spec: SceneSpec) -> None:
    end = np.array([1.5, 0.0, 0.0, 0.0, 0.0, 0.0])
    slow, fast = (plan(spec, swing(STRETCHED, STRETCHED + end, time)).torque_shares[0] for time in (2.0, 1.0))
    assert fast[0] == pytest.approx(4 * slow[0], rel=1e-2)
    assert fast[0] > 0.1


def test_the_largest_share_is_named_with_joint_and_step(spec: SceneSpec) -> None:
    made = plan(spec, still(np.zeros(6)), still(STRETCHED))
    assert made.torque is not None
    assert (made.torque.joint, made.torque.step) == ("shoulder", 2)
    assert made.torque.share == pytest.approx(made.torque_shares.max(), abs=1e-4)
    assert Plan(spec, made.c, ()).torque is None


def test_a_share_beyond_the_limit_is_said(spec: SceneSpec) -> None:
    folder = Path(spec.robot).parent / "weak"
    folder.mkdir()
    weak = small.write(folder, {**small.content(), "effort": [10]})
    made = plan(replace(spec, robot=str(weak)), still(STRETCHED))
    assert made.torque is not None
    assert made.torque.share > 1
    within = TorqueUse(share=0.9, joint="shoulder", step=1)
    assert "beyond" in str(made.torque)
    assert "beyond" not in str(within)


def test_a_plan_that_is_read_back_needs_the_same(tmp_path: Path) -> None:
    made = small_plan()
    made.save(tmp_path / "plan.yaml")
    read = Plan.load(tmp_path / "plan.yaml")
    assert made.torque is not None
    assert 0.1 < made.torque.share < 1.0
    assert read.torque == made.torque


def test_records_keep_it(tmp_path: Path) -> None:
    use = TorqueUse(share=0.63, joint="panda_joint2", step=3)
    record = Record(problem="a", level=None, seed=0, stop_reason="SOLVED", planning_time_s=1.0, torque=use)
    append(record, tmp_path / "records.jsonl")
    assert read_records(tmp_path / "records.jsonl")["a"].torque == use
