import numpy as np
import pytest
from pydrake.math import RigidTransform, RotationMatrix

from ictamp_drake.core.errors import Code
from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Configuration, FloatArray
from ictamp_drake.motion.config import MotionConfig, PathConfig, TrajectoryConfig
from ictamp_drake.motion.planner import MotionPlanner, PlannedMotion, Refusal
from ictamp_drake.motion.trajectory import sample
from ictamp_drake.world.world import World
from tests.motion.derivatives import derivatives
from tests.panda import HOME
from tests.refusals import refusal

UPSIDE_DOWN = RotationMatrix.MakeXRotation(np.pi)


def rng() -> np.random.Generator:
    return np.random.default_rng(0)


def posture(planner: MotionPlanner, c: Configuration, X_WG: RigidTransform) -> FloatArray:
    q = planner.posture(c, X_WG, HOME)
    assert not isinstance(q, Refusal), q
    return q


def check_free(
    world: World, planner: MotionPlanner, c: Configuration, planned: PlannedMotion | Refusal, overlaps
) -> PlannedMotion:
    """Assert a motion from rest to rest without collisions at 5 mm and 0.01 rad, twice as fine as promised."""
    assert isinstance(planned, PlannedMotion), planned
    for q in sample(planned.trajectory, planner.kinematics.forward_all, 0.005, 0.01):
        assert max(overlaps(world, c, q).values(), default=0.0) < 1.5e-3  # the held box counts as 1 mm smaller
    ends = np.array([0.0, planned.trajectory.duration])
    for order in (1, 2):
        np.testing.assert_allclose(derivatives(planned.trajectory, ends, order), 0.0, atol=1e-6)
    return planned


def test_posture_is_free_of_collisions(planner: MotionPlanner, c: Configuration, down) -> None:
    assert planner.scene.is_free(c, posture(planner, c, down(0.5, 0.3, 0.08)))


@pytest.mark.parametrize("place", [(0.0, 0.31, 0.06, 2.56), (-0.03, 0.33, 0.06, 1.78)])
def test_posture_leaves_the_way_up_open(planner: MotionPlanner, c: Configuration, down, place) -> None:
    """The nearest posture does not, but another one does."""
    X_WG, X_WG1 = down(*place), down(*place[:2], place[2] + 0.15, place[3])
    assert planner.kinematics.line(posture(planner, c, X_WG), X_WG1) is None
    q = planner.posture(c, X_WG, HOME, towards=X_WG1)
    assert not isinstance(q, Refusal)
    assert planner.scene.is_free(c, q)
    assert planner.kinematics.line(q, X_WG1) is not None


def test_posture_without_a_way_up_is_refused(planner: MotionPlanner, c: Configuration, down) -> None:
    refusal = planner.posture(c, down(0.6, -0.05, 0.1), HOME, towards=down(0.6, -0.05, 1.4))
    assert refusal == Refusal(Failure.NO_INVERSE_KINEMATICS, "the arm cannot follow the straight line")


@pytest.mark.parametrize(
    ("place", "failure", "detail"),
    [
        ((1.3, 0.0, 0.2), Failure.NO_INVERSE_KINEMATICS, ""),
        ((0.5, 0.1, 0.2, 0.8), Failure.GOAL_IN_COLLISION, "would touch red_box"),
    ],
)
def test_posture_says_why_there_is_none(
    planner: MotionPlanner, c: Configuration, down, place, *, failure: Failure, detail: str
) -> None:
    refusal = planner.posture(c, down(*place), HOME)
    assert isinstance(refusal, Refusal)
    assert refusal.failure is failure
    assert detail in refusal.detail


@pytest.mark.parametrize("ends", [((0.5, 0.3, 0.08), (0.5, 0.3, 0.2)), ((0.5, 0.3, 0.13), (0.4, 0.35, 0.3))])
@pytest.mark.parametrize("config", [TrajectoryConfig(), TrajectoryConfig(velocity=0.7, acceleration=0.5, jerk=0.1)])
def test_straight_stays_straight(world: World, down, overlaps, ends, config: TrajectoryConfig) -> None:
    planner, c = MotionPlanner(world, MotionConfig(trajectory=config)), world.initial_configuration()
    X_WG0, X_WG1 = (down(*end) for end in ends)
    q0 = posture(planner, c, X_WG0)
    planned = planner.plan_straight(c, q0, X_WG1)
    check_free(world, planner, c, planned, overlaps)
    assert isinstance(planned, PlannedMotion)
    np.testing.assert_array_equal(planned.trajectory.control_points[:3], [q0, q0, q0])
    np.testing.assert_array_equal(planned.trajectory.reversed().control_points[-3:], [q0, q0, q0])
    p0, p1 = X_WG0.translation(), X_WG1.translation()
    way = (p1 - p0) / np.linalg.norm(p1 - p0)
    times = np.linspace(0.0, planned.trajectory.duration, 200)
    for X_WG in map(planner.kinematics.forward, planned.trajectory.positions(times)):
        offset = X_WG.translation() - p0
        assert np.linalg.norm(offset - (offset @ way) * way) < 2e-3
        assert (X_WG0.rotation().inverse() @ X_WG.rotation()).ToAngleAxis().angle() < 0.02
    np.testing.assert_allclose(planner.kinematics.forward(planned.trajectory.end).translation(), p1, atol=3e-4)


@pytest.mark.parametrize(
    ("ends", "failure", "detail"),
    [
        (((0.5, 0.3, 0.08), (1.2, 0.3, 0.08)), Failure.NO_INVERSE_KINEMATICS, "cannot follow the straight line"),
        (((0.4, -0.05, 0.1), (0.4, -0.05, -0.02)), Failure.GOAL_IN_COLLISION, "would touch table"),
        (((0.5, -0.1, 0.1), (0.5, 0.5, 0.1)), Failure.NO_PATH, "_box"),
    ],
)
def test_straight_says_why_there_is_none(
    planner: MotionPlanner, c: Configuration, down, ends, *, failure, detail: str
) -> None:
    refusal = planner.plan_straight(c, posture(planner, c, down(*ends[0])), down(*ends[1]))
    assert isinstance(refusal, Refusal)
    assert refusal.failure is failure
    assert detail in refusal.detail


def test_transfer_takes_the_free_way(world: World, planner: MotionPlanner, c: Configuration, down, overlaps) -> None:
    q1 = posture(planner, c, down(0.5, 0.1, 0.35))
    planned = check_free(world, planner, c, planner.transfer(c, HOME, q1, rng()), overlaps)
    assert planned.stage == "free"
    np.testing.assert_array_equal([planned.trajectory.start, planned.trajectory.end], [HOME, q1])


def test_transfer_passes_over_the_tower(world: World, planner: MotionPlanner, c: Configuration, down, overlaps) -> None:
    q0, q1 = posture(planner, c, down(0.5, -0.1, 0.08)), posture(planner, c, down(0.5, 0.3, 0.09))
    planned = planner.transfer(c, q0, q1, rng())
    assert check_free(world, planner, c, planned, overlaps).stage == "raised"


@pytest.mark.parametrize("rounds", [0, 6])
def test_transfer_finds_a_way_by_sampling(world: World, c: Configuration, down, overlaps, rounds: int) -> None:
    """The arm cannot reach the height of the raised path; obstacles that are too near are pushed away."""
    corridors = ((0.3, 14), (0.1, 18), (0.03, 40)) if rounds == 0 else ((0.1, 14),)
    planner = MotionPlanner(world, MotionConfig(rise=3.0, corridors=corridors, push_rounds=rounds))
    q0, q1 = posture(planner, c, down(0.5, -0.1, 0.08)), posture(planner, c, down(0.5, 0.3, 0.09))
    found = [planner.transfer(c, q0, q1, np.random.default_rng(seed)) for seed in range(4 if rounds == 0 else 1)]
    ways = [planned for planned in found if isinstance(planned, PlannedMotion)]
    assert ways  # without pushes, about two sampled paths of three have a corridor
    for planned in ways:
        assert check_free(world, planner, c, planned, overlaps).stage in {
            "sampled",
            "pushed",
        }


@pytest.mark.parametrize(
    ("corridor", "value"),
    [((0.1, 6), 6), ((-0.1, 7), -0.1)],
)
def test_impossible_corridors_are_refused(corridor: tuple[float, int], value: float) -> None:
    with refusal(Code.OUT_OF_RANGE, "skills.motion.corridors", value=value):
        MotionConfig(corridors=(corridor,))


def test_held_box_makes_the_transfer_rise(
    world: World, planner: MotionPlanner, c: Configuration, down, *, holding, overlaps
) -> None:
    q0, q1 = posture(planner, c, down(0.5, -0.1, 0.33)), posture(planner, c, down(0.5, 0.3, 0.33))
    empty = planner.transfer(c, q0, q1, rng())
    assert isinstance(empty, PlannedMotion)
    X_WO = planner.kinematics.forward(q0) @ RigidTransform(UPSIDE_DOWN, [0.0, 0.0, 0.09])
    held = holding(q0, "blue_box", X_WO)
    full = check_free(world, planner, held, planner.transfer(held, q0, q1, rng()), overlaps)
    tops = []
    for trajectory in (empty.trajectory, full.trajectory):
        qs = sample(trajectory, planner.kinematics.forward_all, 0.01, 0.02)
        tops.append(max(planner.kinematics.forward(q).translation()[2] for q in qs))
    assert tops[1] > max(tops[0], 0.254 + 0.09 + 0.053)


@pytest.mark.parametrize(("blocked", "failure"), [(0, Failure.NO_PATH), (1, Failure.GOAL_IN_COLLISION)])
def test_transfer_from_or_into_a_collision_is_refused(
    planner: MotionPlanner, c: Configuration, down, blocked: int, failure
) -> None:
    colliding = planner.kinematics.solve(down(0.4, -0.05, -0.02), HOME)
    ends = [HOME, HOME]
    ends[blocked] = colliding
    refusal = planner.transfer(c, ends[0], ends[1], rng())
    assert isinstance(refusal, Refusal)
    assert refusal.failure is failure
    assert "would touch table" in refusal.detail
    assert refusal.obstacle == "table"


def test_transfer_without_a_way_is_refused(world: World, c: Configuration, down) -> None:
    planner = MotionPlanner(world, MotionConfig(rise=3.0, path=PathConfig(max_checks=5)))
    q0, q1 = posture(planner, c, down(0.5, -0.1, 0.08)), posture(planner, c, down(0.5, 0.3, 0.09))
    refusal = planner.transfer(c, q0, q1, rng())
    assert isinstance(refusal, Refusal)
    assert refusal.failure is Failure.NO_PATH
    assert "would touch" in refusal.detail


def test_same_request_gives_the_same_motion_whatever_came_before(world: World, c: Configuration, down) -> None:
    results = []
    for detours in (0, 2):
        planner = MotionPlanner(world, MotionConfig(rise=3.0))
        q0, q1 = posture(planner, c, down(0.5, -0.1, 0.08)), posture(planner, c, down(0.5, 0.3, 0.09))
        for seed in range(detours):
            planner.transfer(c, q1, q0, np.random.default_rng(seed + 5))
        planned = planner.transfer(c, q0, q1, rng())
        assert isinstance(planned, PlannedMotion)
        results.append(planned.trajectory)
    np.testing.assert_array_equal(results[0].control_points, results[1].control_points)
    np.testing.assert_array_equal(results[0].knots, results[1].knots)


def test_motions_are_those_in_the_configuration_given_whatever_was_given_before(
    planner: MotionPlanner, c: Configuration, down
) -> None:
    q, X_WG1 = posture(planner, c, down(0.5, 0.3, 0.08)), down(0.5, 0.3, 0.2)
    under_a_finger = np.array([1.0, 0.0, 0.0, 0.0, 0.5, 0.26, 0.053])
    moved = Configuration(c.q, c.fingers, {**c.poses, "blue_box": under_a_finger})
    for _ in range(2):
        assert isinstance(planner.plan_straight(c, q, X_WG1), PlannedMotion)
        refusal = planner.plan_straight(moved, q, X_WG1)
        assert isinstance(refusal, Refusal)
        assert refusal.obstacle == "blue_box"
        assert isinstance(planner.plan_straight(Configuration(c.q, c.fingers, c.poses), q, X_WG1), PlannedMotion)
