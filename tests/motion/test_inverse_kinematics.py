import numpy as np
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from pydrake.math import RigidTransform, RollPitchYaw

from ictamp_drake.core.types import FloatArray
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.robots.panda import PandaKinematics
from ictamp_drake.world.world import World
from tests.panda import HOME, PANDA, VELOCITY

ARM = ArmKinematics(PANDA, RigidTransform())
shares = st.lists(st.floats(0.0, 1.0), min_size=7, max_size=7).map(np.array)


def error(X_WG: RigidTransform, X_WH: RigidTransform) -> tuple[float, float]:
    X_GH = X_WG.inverse() @ X_WH
    return float(np.linalg.norm(X_GH.translation())), float(X_GH.rotation().ToAngleAxis().angle())


@given(shares, st.lists(st.floats(-0.1, 0.1), min_size=7, max_size=7).map(np.array))
@example(np.array([0.0, 0.0, 0.0, 0.0, 0.5, 0.0, 0.0]), np.zeros(7))
@example(np.array([0.0, 0.0, 0.0, 0.0, 0.0, 0.75, 0.0]), np.zeros(7))
def test_solution_is_near_the_guess_and_holds_the_hand_where_it_shall_be(share: FloatArray, offset: FloatArray) -> None:
    """The last joint's angle is one of those tried; else a posture at several limits may have none beside it."""
    q = ARM.lower + share * (ARM.upper - ARM.lower)
    q[6] -= np.remainder(q[6] - ARM.lower[6], ARM.config.last_step)
    X_WG, guess = ARM.forward(q), q + offset
    solution = ARM.solve(X_WG, guess)
    assert solution is not None
    assert max(error(X_WG, ARM.forward(solution))) < 1e-6
    assert np.all(solution >= ARM.lower)
    assert np.all(solution <= ARM.upper)


def test_far_pose_has_no_solution(down) -> None:
    assert ARM.solve(down(1.2, 0.0, 0.1), HOME) is None


def test_forward_kinematics_is_that_of_the_scene(world: World) -> None:
    c = world.initial_configuration()
    world.set_configuration(c)
    X_WG = world.plant.GetFrameByName("grasp").CalcPoseInWorld(world.plant.GetMyContextFromRoot(world.context))
    assert ARM.forward(c.q).IsNearlyEqualTo(X_WG, 1e-12)


def test_base_moves_the_solution_along(down) -> None:
    X_WB = RigidTransform(RollPitchYaw(0.0, 0.0, 0.7), [0.3, -0.2, 0.1])
    q = ArmKinematics(PANDA, X_WB).solve(X_WB @ down(0.5, 0.1, 0.2), HOME)
    np.testing.assert_allclose(q, ARM.solve(down(0.5, 0.1, 0.2), HOME), atol=1e-4)


def test_the_nearest_posture_to_the_guess_comes_first() -> None:
    for q in (HOME, np.array([0.6, -0.6, -0.6, -2.3, -0.3, 1.8, 0.9])):
        found = ARM.solve(ARM.forward(q), q)
        assert found is not None
        assert np.abs(found - q).max() < 0.15


def test_postures_that_differ_are_tried_until_one_is_accepted(down) -> None:
    seen: list[FloatArray] = []

    def accept(q: FloatArray) -> bool:
        seen.append(q)
        return len(seen) == 3

    q = ARM.solve(down(0.5, 0.1, 0.2), HOME, accept)
    assert len(seen) == 3
    assert q is seen[-1]
    for number, one in enumerate(seen):
        assert all(np.abs(one - other).max() >= ARM.config.apart for other in seen[:number])
    seen.clear()
    assert ARM.solve(down(0.5, 0.1, 0.2), HOME, lambda q: bool(seen.append(q))) is None
    assert len(seen) == ARM.config.attempts


def test_travel_times_are_short_where_the_hand_is_and_infinite_out_of_reach(down) -> None:
    poses = [ARM.forward(HOME), down(0.5, 0.2, 0.2), down(0.5, -0.6, 0.2), down(1.2, 0.0, 0.1)]
    times = ARM.travel_times(np.array([X_WG.GetAsMatrix4() for X_WG in poses]), HOME)
    assert times[0] < ARM.config.travel_step / VELOCITY[6]
    assert np.all(np.diff(times) > 0)
    assert np.isinf(times[3])


@given(st.lists(shares, min_size=1, max_size=4), shares)
def test_travel_times_are_the_least_of_all_postures(places: list[FloatArray], share: FloatArray) -> None:
    """This holds although not all postures are examined."""
    q = ARM.lower + share * (ARM.upper - ARM.lower)
    X_WG = ARM.forward_all(ARM.lower + np.array(places) * (ARM.upper - ARM.lower))
    last = np.arange(ARM.lower[6], ARM.upper[6], ARM.config.travel_step)
    for X, time in zip(X_WG, ARM.travel_times(X_WG, q), strict=True):
        found, _ = PandaKinematics().postures(X[None], last, np.array([ARM.lower, ARM.upper]))
        expected = (np.abs(found - q) / VELOCITY).max(axis=1).min(initial=np.inf)
        assert time == pytest.approx(expected, rel=1e-12)


def test_forward_of_many_is_that_of_each() -> None:
    arm = ArmKinematics(PANDA, RigidTransform(RollPitchYaw(0.0, 0.0, 0.7), [0.3, -0.2, 0.1]))
    qs = HOME + np.linspace(-0.5, 0.5, 5)[:, None]
    np.testing.assert_allclose(arm.forward_all(qs), [arm.forward(q).GetAsMatrix4() for q in qs], atol=1e-10)


@pytest.mark.parametrize("yaw", [0.0, 0.6])
def test_line_is_straight_and_turns_evenly(down, yaw: float) -> None:
    q0 = ARM.solve(down(0.5, 0.0, 0.1), HOME)
    X_WG0, X_WG1 = ARM.forward(q0), down(0.55, 0.05, 0.25, yaw)
    path = ARM.line(q0, X_WG1)
    assert path is not None
    np.testing.assert_array_equal(path[0], q0)
    assert max(error(X_WG1, ARM.forward(path[-1]))) < 3e-4
    for share, q in zip(np.linspace(0, 1, len(path)), path, strict=True):
        X_WG = ARM.forward(q)
        on_line = (1 - share) * X_WG0.translation() + share * X_WG1.translation()
        np.testing.assert_allclose(X_WG.translation(), on_line, atol=2e-4)
        assert error(X_WG0, X_WG)[1] == pytest.approx(share * error(X_WG0, X_WG1)[1], abs=2e-3)


def test_line_that_leaves_the_reach_is_none(down) -> None:
    q0 = ARM.solve(down(0.5, 0.0, 0.1), HOME)
    assert ARM.line(q0, down(1.1, 0.0, 0.1)) is None


def test_line_that_starts_at_its_end_stays(down) -> None:
    q0 = ARM.solve(down(0.5, 0.0, 0.1), HOME)
    path = ARM.line(q0, ARM.forward(q0))
    assert path is not None
    np.testing.assert_allclose(path, np.tile(q0, (len(path), 1)))


def test_lines_are_the_same_however_often_and_in_which_order_they_are_asked_for(down) -> None:
    arm, q0 = ArmKinematics(PANDA, RigidTransform()), ARM.solve(down(0.5, 0.0, 0.1), HOME)
    ends = [down(0.5, 0.0, 0.1 + rise) for rise in np.linspace(0.05, 0.2, 20)]
    for X_WG1 in (*ends, *ends[::-1], *ends[-3:]):
        np.testing.assert_array_equal(arm.line(q0, X_WG1), ArmKinematics(PANDA, RigidTransform()).line(q0, X_WG1))


def test_arms_with_the_same_base_share_a_plant_and_are_independent() -> None:
    X_WB = RigidTransform(RollPitchYaw(0.0, 0.0, 0.7), [0.1, -0.2, 0.3])
    one, two, other = (
        ArmKinematics(PANDA, X_WB),
        ArmKinematics(PANDA, RigidTransform(X_WB)),
        ArmKinematics(PANDA, RigidTransform()),
    )
    assert one.plant is two.plant
    assert one.plant is not other.plant
    X_WG = one.forward(HOME)
    two.forward(HOME + 0.1)
    assert one.forward(HOME).IsExactlyEqualTo(X_WG)
    np.testing.assert_allclose(X_WG.GetAsMatrix4(), (X_WB @ other.forward(HOME)).GetAsMatrix4(), atol=1e-12)
