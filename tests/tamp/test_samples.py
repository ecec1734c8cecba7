"""Sampled trajectories: complete, continuous, from rest to rest, with true derivatives, and as files."""

import csv
import io
from itertools import pairwise

import numpy as np
import pytest
import yaml

from ictamp_drake.models.panda import ARM_JOINTS
from ictamp_drake.tamp.plan import Plan
from ictamp_drake.tamp.samples import Part, gripper_csv, joints_csv, ros_yaml, sample
from tests.runs.plans import small_plan

RATE = 200.0


@pytest.fixture(scope="module")
def plan() -> Plan:
    return small_plan()


@pytest.fixture(scope="module")
def parts(plan: Plan) -> list[Part]:
    return sample(plan, RATE)


def test_a_part_begins_where_the_command_to_the_hand_changes(plan: Plan, parts: list[Part]) -> None:
    segments = [segment for attempt in plan.attempts for segment in attempt.motion]
    changes = sum(before.gripper != after.gripper for before, after in pairwise(segments))
    assert len(parts) == changes + 1 >= 3
    assert all(before.gripper != after.gripper for before, after in pairwise(parts))


def test_parts_cover_the_whole_plan(plan: Plan, parts: list[Part]) -> None:
    assert parts[0].start == 0
    for before, after in pairwise(parts):
        assert after.start == pytest.approx(before.start + before.times[-1])
        np.testing.assert_allclose(after.q[0], before.q[-1], rtol=0, atol=1e-9)
    assert parts[-1].start + parts[-1].times[-1] == pytest.approx(plan.duration)


def test_samples_are_those_of_the_trajectory_at_the_rate(plan: Plan, parts: list[Part]) -> None:
    trajectory = plan.trajectory()
    for part in parts:
        assert np.all(np.diff(part.times) > 0)
        np.testing.assert_allclose(np.diff(part.times)[:-1], 1 / RATE)
        for time, q in zip(part.start + part.times[::20], part.q[::20], strict=True):
            np.testing.assert_allclose(q, trajectory.value(time)[:, 0], atol=1e-6)


def test_velocities_and_accelerations_are_derivatives_and_zero_at_the_ends(parts: list[Part]) -> None:
    for part in parts:
        for rate, value in ((part.v, part.q), (part.a, part.v)):
            assert rate.shape == value.shape == (len(part.times), 7)
            np.testing.assert_allclose(rate[[0, -1]], 0.0, atol=1e-6)
            steps = np.diff(part.times)[:, None]
            trapezoids = value[0] + np.cumsum((rate[1:] + rate[:-1]) / 2 * steps, axis=0)
            np.testing.assert_allclose(trapezoids, value[1:], atol=2e-3 * max(1.0, abs(value).max()))


def test_the_tables_have_a_row_per_sample_and_per_command(parts: list[Part]) -> None:
    rows = list(csv.DictReader(io.StringIO(joints_csv(parts, ARM_JOINTS))))
    assert len(rows) == sum(len(part.times) for part in parts)
    last = parts[-1]
    assert float(rows[-1]["time"]) == pytest.approx(last.start + last.times[-1])
    assert rows[-1]["part"] == str(len(parts) - 1)
    for number, joint in enumerate(ARM_JOINTS):
        assert float(rows[-1][joint]) == pytest.approx(last.q[-1, number], abs=1e-8)
        assert float(rows[10][f"{joint}_velocity"]) == pytest.approx(parts[0].v[10, number], abs=1e-8)
        assert float(rows[10][f"{joint}_acceleration"]) == pytest.approx(parts[0].a[10, number], abs=1e-8)
    goals = list(csv.DictReader(io.StringIO(gripper_csv(parts))))
    assert [float(goal["force"]) for goal in goals] == [part.gripper.force for part in parts]
    assert [float(goal["time"]) for goal in goals] == pytest.approx([part.start for part in parts])


def test_messages_have_the_fields_of_a_joint_trajectory(parts: list[Part]) -> None:
    entries = yaml.safe_load(ros_yaml(parts, ARM_JOINTS))
    assert [set(entry) for entry in entries] == [{"time", "gripper"}, {"time", "joint_trajectory"}] * len(parts)
    for part, goal, motion in zip(parts, entries[::2], entries[1::2], strict=True):
        assert goal["gripper"] == {"width": part.gripper.width, "force": part.gripper.force}
        assert goal["time"] == motion["time"] == pytest.approx(part.start)
        message = motion["joint_trajectory"]
        assert set(message) == {"header", "joint_names", "points"}
        assert set(message["header"]) == {"stamp", "frame_id"}
        assert message["joint_names"] == list(ARM_JOINTS)
        fields = {"positions", "velocities", "accelerations", "effort", "time_from_start"}
        assert {frozenset(point) for point in message["points"]} == {frozenset(fields)}
        times = [
            point["time_from_start"]["sec"] + 1e-9 * point["time_from_start"]["nanosec"] for point in message["points"]
        ]
        np.testing.assert_allclose(times, part.times, atol=1e-9)
        assert all(0 <= point["time_from_start"]["nanosec"] < 10**9 for point in message["points"])
        np.testing.assert_allclose([point["positions"] for point in message["points"]], part.q, atol=1e-8)


def test_a_plan_without_steps_has_no_parts(plan: Plan) -> None:
    parts = sample(Plan(plan.spec, plan.c, ()), RATE)
    assert parts == []
    assert yaml.safe_load(ros_yaml(parts, ARM_JOINTS)) == []
    assert joints_csv(parts, ARM_JOINTS).count("\n") == gripper_csv(parts).count("\n") == 1
