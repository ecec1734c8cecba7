"""Commands over time: continuous; the hand grips after its fingers arrive, and releases before it opens."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.trajectories import Trajectory

from ictamp_drake.core.types import FloatArray, GripperCommand, Segment
from ictamp_drake.models.panda import MAX_FINGER_SPEED
from ictamp_drake.world import commands
from ictamp_drake.world.commands import FORCE_RAMP, command_motion
from tests.panda import GRIPPER, HOME
from tests.world.scenes import way

OPEN = GripperCommand(0.08)
GRIP = GripperCommand(0.05, 30.0)
q0, q1 = np.array(HOME), np.array(HOME) + [0.3, -0.2, 0.1, 0.2, -0.1, 0.2, 0.1]


BOTH = (True, True)


def desired_positions(q: FloatArray, before: GripperCommand, segments: list[Segment], end: float) -> Trajectory:
    return command_motion(GRIPPER, q, before, segments, end).positions(BOTH)


def feedforward(before: GripperCommand, segments: list[Segment], end: float) -> Trajectory:
    return command_motion(GRIPPER, q0, before, segments, end).efforts(BOTH)


def gripper_time(before: GripperCommand, after: GripperCommand) -> float:
    return commands.gripper_time(before, after, GRIPPER.speed)


def obedience_time(before: GripperCommand, segments: list[Segment]) -> float:
    return commands.obedience_time(before, segments, GRIPPER.speed)


def still(label: str, q: FloatArray, duration: float, gripper: GripperCommand) -> Segment:
    return Segment(label, duration, gripper, 1, np.array([0.0, duration]), q[None])


def pick_and_place() -> list[Segment]:
    return [
        way("approach", q0, q1, 0.7, OPEN),
        still("grasp", q1, 0.6, GRIP),
        way("lift", q1, q0, 0.31, GRIP),
        still("release", q0, 0.6, OPEN),
        way("retreat", q0, q1, 0.7, OPEN),
    ]


def sample_commands(segments: list[Segment], times: FloatArray) -> tuple[FloatArray, FloatArray]:
    """Desired positions, shape (m, 9), and grip force of the left finger, shape (m,)."""
    end = sum(segment.duration for segment in segments) + 1.0
    positions = desired_positions(q0, OPEN, segments, end)
    forces = feedforward(OPEN, segments, end)
    return np.array([positions.value(t)[:, 0] for t in times]), np.array([-forces.value(t)[7, 0] for t in times])


def test_fingers_arrive_before_they_press_and_let_go_before_they_open() -> None:
    times = np.arange(0.0, 3.9, 0.001)
    positions, force = sample_commands(pick_and_place(), times)
    width = 2 * positions[:, 7]
    np.testing.assert_array_equal(positions[:, 7], positions[:, 8])
    pressing = force > 1e-9
    assert pressing.any()
    np.testing.assert_allclose(width[pressing], GRIP.width, atol=1e-9)
    assert force.max() == pytest.approx(GRIP.force)
    arrival = 0.7 + (OPEN.width - GRIP.width) / 2 / MAX_FINGER_SPEED
    assert times[pressing].min() == pytest.approx(arrival, abs=0.0015)
    assert times[pressing].max() == pytest.approx(0.7 + 0.6 + 0.31 + FORCE_RAMP, abs=0.0015)
    held = (times > arrival + FORCE_RAMP) & (times < 0.7 + 0.6 + 0.31)
    np.testing.assert_allclose(force[held], GRIP.force)
    assert np.abs(np.diff(width)).max() / 0.001 / 2 <= MAX_FINGER_SPEED * (1 + 1e-6)
    np.testing.assert_allclose(width[[0, -1]], OPEN.width)


def test_the_hand_needs_as_long_as_gripper_time_says() -> None:
    for before, after in ((OPEN, GRIP), (GRIP, OPEN), (GRIP, GripperCommand(0.05, 60.0)), (OPEN, GripperCommand(0.02))):
        needed = gripper_time(before, after)
        arguments = (before, [still("change", q0, 2.0, after)], 3.0)
        positions, forces = desired_positions(q0, *arguments), feedforward(*arguments)
        for t in (needed, 2.5):
            assert 2 * positions.value(t)[7, 0] == pytest.approx(after.width)
            assert -forces.value(t)[8, 0] == pytest.approx(after.force)
        early = (2 * positions.value(0.9 * needed)[7, 0], -forces.value(0.9 * needed)[8, 0])
        assert early != pytest.approx((after.width, after.force))
    assert gripper_time(GRIP, GRIP) == 0.0


def test_only_the_fingers_are_fed_forward() -> None:
    forces = feedforward(GRIP, pick_and_place(), 5.0)
    for t in np.linspace(0, 5, 20):
        np.testing.assert_array_equal(forces.value(t)[:7], 0.0)
        assert forces.value(t)[7, 0] == forces.value(t)[8, 0]


durations = st.lists(st.floats(0.05, 3.0), min_size=1, max_size=6)


@given(lengths=durations, seed=st.integers(0, 100))
def test_the_arm_goes_on_where_it_is(lengths: list[float], seed: int) -> None:
    """Positions and velocities are continuous across segments, however their durations are rounded."""
    rng = np.random.default_rng(seed)
    segments, q = [], q0
    for i, duration in enumerate(lengths):
        target = q if i % 3 == 2 else q + rng.uniform(-0.2, 0.2, 7)
        segments.append(still("s", q, duration, OPEN) if i % 3 == 2 else way("w", q, target, duration, OPEN))
        q = target
    end = sum(lengths) + 1.0
    trajectory = desired_positions(q0, OPEN, segments, end)
    velocity = trajectory.MakeDerivative()
    for joint in np.cumsum(lengths):
        before, after = (trajectory.value(joint + dt)[:7, 0] for dt in (-1e-7, 1e-7))
        np.testing.assert_allclose(before, after, atol=1e-7)
        np.testing.assert_allclose(velocity.value(joint)[:7, 0], 0.0, atol=1e-6)
    for i, start in enumerate(np.cumsum([0.0, *lengths[:-1]])):
        np.testing.assert_allclose(trajectory.value(start)[:7, 0], segments[i].control_points[0], atol=1e-9)
    np.testing.assert_allclose(trajectory.value(end)[:7, 0], q)


def test_a_single_control_point_is_a_stand_still() -> None:
    trajectory = desired_positions(q0, OPEN, [still("wait", q1, 0.5, OPEN)], 2.0)
    for t in (0.0, 0.2, 0.5, 1.9):
        np.testing.assert_array_equal(trajectory.value(t)[:7, 0], q1)
        np.testing.assert_array_equal(trajectory.EvalDerivative(t, 1)[:7, 0], 0.0)


def test_without_a_motion_everything_stays() -> None:
    trajectory = desired_positions(q1, GRIP, [], 2.0)
    for t in (0.0, 1.0, 2.0):
        np.testing.assert_allclose(trajectory.value(t)[:, 0], [*q1, GRIP.width / 2, GRIP.width / 2])
        np.testing.assert_allclose(feedforward(GRIP, [], 2.0).value(t)[7:, 0], -GRIP.force)


@given(lengths=st.lists(st.sampled_from([0.3, 0.35, 0.6, 1 / 3, 0.1 + 0.2, 0.7]), min_size=2, max_size=6))
def test_commands_may_follow_each_other_without_a_pause(lengths: list[float]) -> None:
    """The hand may need exactly the duration of a segment, up to rounding."""
    segments, before = list[Segment](), OPEN
    for i, _ in enumerate(lengths):
        after = (GRIP, OPEN)[i % 2]
        segments.append(still("s", q0, gripper_time(before, after), after))
        before = after
    end = sum(segment.duration for segment in segments) + 1.0
    forces = feedforward(OPEN, segments, end)
    assert -forces.value(end)[7, 0] == pytest.approx(before.force)


goals = st.builds(
    GripperCommand, width=st.sampled_from([0.0, 0.03, 0.05, 0.08]), force=st.sampled_from([0.0, 30.0, 60.0])
)


@given(told=st.lists(st.tuples(goals, st.floats(0.01, 1.0)), min_size=1, max_size=6), before=goals)
def test_a_command_is_obeyed_whole_before_the_next_one(
    told: list[tuple[GripperCommand, float]], before: GripperCommand
) -> None:
    """However soon the next one comes, fingers keep their speed limit, forces do not jump, and each goal is reached."""
    segments = [still("s", q0, duration, gripper) for gripper, duration in told]
    obeyed = obedience_time(before, segments)
    end = max(obeyed, sum(duration for _, duration in told)) + 0.5
    times = np.arange(0.0, end, 0.001)
    positions, efforts = desired_positions(q0, before, segments, end), feedforward(before, segments, end)
    finger = np.array([positions.value(t)[7, 0] for t in times])
    force = np.array([-efforts.value(t)[7, 0] for t in times])
    assert finger[0] == pytest.approx(before.width / 2)
    assert force[0] == pytest.approx(before.force)
    assert np.abs(np.diff(finger)).max() <= MAX_FINGER_SPEED * 0.001 * (1 + 1e-6)
    assert np.abs(np.diff(force)).max() <= 60.0 / FORCE_RAMP * 0.001 * (1 + 1e-6)
    last = told[-1][0]
    np.testing.assert_allclose(2 * finger[times > obeyed], last.width, atol=1e-9)
    np.testing.assert_allclose(force[times > obeyed], last.force, atol=1e-9)
    wanted = [before, *(gripper for gripper, _ in told)]
    reached = iter(2 * finger)
    assert all(any(abs(width - goal.width) < 1.1e-4 for width in reached) for goal in wanted)  # in their order


def test_a_command_in_time_starts_with_its_segment() -> None:
    segments = [still("a", q0, 1.0, GRIP), still("b", q0, 1.0, OPEN)]
    assert obedience_time(OPEN, segments) == pytest.approx(1.0 + gripper_time(GRIP, OPEN))
    assert obedience_time(OPEN, []) == obedience_time(GRIP, [still("a", q0, 1.0, GRIP)]) == 0.0
    assert obedience_time(OPEN, [still("a", q0, 0.1, GRIP), still("b", q0, 1.0, OPEN)]) == pytest.approx(
        gripper_time(OPEN, GRIP) + gripper_time(GRIP, OPEN)
    )
