"""Pick and Place in physics: where they must succeed, why they refuse, and records of their attempts."""

from collections.abc import Iterator
from dataclasses import dataclass
from itertools import pairwise

import numpy as np
import pytest
from scipy.interpolate import BSpline

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Attempt, Configuration, Motion, Parameter
from ictamp_drake.models.panda import ARM_LIMITS
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec
from ictamp_drake.skills.config import OptimizationConfig, SkillsConfig, UniformConfig
from ictamp_drake.skills.context import SamplerConfig
from ictamp_drake.world.poses import to_transform
from tests.panda import PANDA, TIP
from tests.skills.rig import KINEMATIC, Rig, pick, place, rig
from tests.world.scenes import RACK_TOP, box, build_tower, scene

LABELS = {"pick": ["approach", "lower", "grasp", "lift"], "place": ["transfer", "lower", "release", "retreat"]}

ON_THE_TABLE = scene({**build_tower("yellow_box", yaws=(30.0,)), **build_tower("cyan_box", y=0.3)})
TOWER = scene(build_tower("cyan_box", "yellow_box", "red_box", "blue_box", yaws=(10.0, 50.0, -20.0, 80.0)))
TOWER_ON_RACK = scene(
    {
        **build_tower("cyan_box", "yellow_box", "red_box", x=0.44, y=-0.33, floor=RACK_TOP),
        **build_tower("blue_box", x=0.5, y=0.2),
    }
)
TIPPED = scene({"red_box": box("red_box", (0.5, 0.1, 0.025), (90.0, 0.0, 30.0)), **build_tower("cyan_box", y=0.3)})


def behind(x: float, y: float) -> SceneSpec:
    return scene(build_tower("yellow_box", x=x, y=y, yaws=(20.0,)))


MUST_SUCCEED = {
    "table to rack and back": (
        ON_THE_TABLE,
        [pick("yellow_box", "table"), place("yellow_box", "rack"), pick("yellow_box", "rack")],
    ),
    "table to box and back": (
        ON_THE_TABLE,
        [pick("yellow_box", "table"), place("yellow_box", "cyan_box"), pick("yellow_box", "cyan_box")],
    ),
    "off a tower": (TOWER, [pick("blue_box", "red_box"), place("blue_box", "table"), pick("red_box", "yellow_box")]),
    "fourth of a tower on the rack": (
        TOWER_ON_RACK,
        [pick("blue_box", "table"), place("blue_box", "red_box"), pick("blue_box", "red_box")],
    ),
    "tipped, onto a box and the rack": (
        TIPPED,
        [pick("red_box", "table"), place("red_box", "cyan_box"), pick("red_box", "cyan_box"), place("red_box", "rack")],
    ),
    "from behind, left": (behind(-0.25, 0.3), [pick("yellow_box", "table"), place("yellow_box", "rack")]),
    "from behind, right": (behind(-0.25, -0.3), [pick("yellow_box", "table"), place("yellow_box", "rack")]),
}


def check_motion(c: Configuration, motion: Motion) -> None:
    """Assert a motion from the commanded start in c, from rest to rest, without jumps, within the arm's limits."""
    np.testing.assert_array_equal(motion[0].control_points[0], c.commanded)
    for before, after in pairwise(motion):
        np.testing.assert_array_equal(before.control_points[-1], after.control_points[0])
    limits = np.array(ARM_LIMITS)
    for segment in motion:
        assert segment.duration > 0
        assert np.all(segment.control_points >= limits[:, 0])
        assert np.all(segment.control_points <= limits[:, 1])
        if len(segment.control_points) == 1:
            continue
        assert segment.knots[-1] == pytest.approx(segment.duration)
        spline = BSpline(segment.knots, segment.control_points, segment.order - 1)
        times = np.linspace(0.0, segment.duration, 400)
        for order in (1, 2, 3):
            assert np.all(np.abs(spline.derivative(order)(times)) <= limits[:, 1 + order])
        np.testing.assert_allclose(spline.derivative(1)([0.0, segment.duration]), 0.0, atol=1e-6)


def check_attempt(attempt: Attempt[Configuration], action: Action) -> None:
    """Assert that an attempt records an executed motion."""
    assert attempt.action == action
    assert attempt.k is not None
    assert attempt.k.shape == (4,)
    labels = LABELS[action.name]
    assert [segment.label for segment in attempt.motion] in (labels, [*labels, "rest"])
    assert {"sampling", "motion", "physics", "abstraction"} <= attempt.seconds.keys()
    assert all(seconds >= 0 for seconds in attempt.seconds.values())
    assert set(attempt.rejections) <= KINEMATIC
    assert attempt.successor is not None
    assert attempt.successor.held == (action.args[0] if action.name == "pick" else None)


@pytest.mark.parametrize("case", MUST_SUCCEED)
def test_skills_succeed(case: str) -> None:
    spec, actions = MUST_SUCCEED[case]
    setup = rig(spec)
    c = setup.start
    for number, action in enumerate(actions):
        attempt = setup.attempt(c, action, seed=number)
        assert attempt.failure is None, f"{action}: {attempt.failure} {attempt.detail}"
        check_attempt(attempt, action)
        check_motion(c, attempt.motion)
        assert attempt.successor is not None
        assert setup.abstraction(attempt.successor) == setup.promised_state(c, action)
        c = attempt.successor


def test_the_hand_comes_from_above_and_leaves_upwards() -> None:
    """It moves straight down to the grasp and straight up; before and after, the fingertips are above the box."""
    setup = rig(ON_THE_TABLE)
    c = setup.start
    for action, down, up in (
        (pick("yellow_box", "table"), "lower", "lift"),
        (place("yellow_box", "rack"), "lower", "retreat"),
    ):
        attempt = setup.attempt(c, action)
        assert attempt.successor is not None
        arm = ArmKinematics(PANDA, to_transform(setup.world.spec.arm.X_WB))
        heights = {}
        for segment in attempt.motion:
            if segment.label in (down, up):
                spline = BSpline(segment.knots, segment.control_points, segment.order - 1)
                way = np.array([arm.forward(q).translation() for q in spline(np.linspace(0, segment.duration, 20))])
                assert np.ptp(way[:, :2], axis=0).max() < 2e-3
                heights[segment.label] = way[:, 2]
        assert np.all(np.diff(heights[down]) < 1e-6)
        assert np.all(np.diff(heights[up]) > -1e-6)
        if action.name == "pick":
            top = setup.world.upright_frame(c, "yellow_box").X_WT.translation()[2]
            assert heights[down][0] - TIP > top
        else:
            top = setup.world.upright_frame(attempt.successor, "yellow_box").X_WT.translation()[2]
            assert heights[up][-1] - TIP > top
        c = attempt.successor


# determinism


def test_the_same_seed_gives_the_same_attempt() -> None:
    """This holds whatever was tried in between, and for a separate set of skills."""
    setup, own = rig(ON_THE_TABLE), rig(ON_THE_TABLE)
    action = pick("yellow_box", "table")
    first = setup.attempt(setup.start, action, seed=5)
    setup.attempt(setup.start, pick("cyan_box", "table"), seed=6)
    for again in (setup.attempt(setup.start, action, seed=5), own.attempt(own.start, action, seed=5)):
        assert again.successor == first.successor
        assert again.rejections == first.rejections
        np.testing.assert_array_equal(again.k, first.k)
        for one, other in zip(again.motion, first.motion, strict=True):
            np.testing.assert_array_equal(one.control_points, other.control_points)
            np.testing.assert_array_equal(one.knots, other.knots)
    other_seed = setup.attempt(setup.start, action, seed=7)
    assert other_seed.k is not None
    assert first.k is not None
    assert not np.array_equal(other_seed.k, first.k)


# refusals


def _wall(x: float, y: float, size: tuple[float, float, float]) -> BoxSpec:
    return BoxSpec(size, (x, y, size[2] / 2), mass=1.0)


WALLED_IN = scene(
    {
        **build_tower("yellow_box"),
        "left": _wall(0.5, 0.15, (0.14, 0.02, 0.2)),
        "right": _wall(0.5, 0.05, (0.14, 0.02, 0.2)),
        "front": _wall(0.55, 0.1, (0.02, 0.078, 0.2)),
        "back": _wall(0.45, 0.1, (0.02, 0.078, 0.2)),
    }
)
FAR = scene(build_tower("yellow_box", x=0.85, y=0.3))


def assert_refused(spec: SceneSpec, action: Action, sampler: SamplerConfig) -> Attempt[Configuration]:
    setup = rig(spec, sampler)
    attempt = setup.attempt(setup.start, action)
    assert attempt.failure in KINEMATIC
    assert attempt.successor is None
    assert attempt.motion == ()
    assert "physics" not in attempt.seconds
    assert attempt.seconds["sampling"] >= 0
    return attempt


def test_a_box_out_of_reach_is_refused_by_inverse_kinematics() -> None:
    attempt = assert_refused(FAR, pick("yellow_box", "table"), UniformConfig())
    assert len(attempt.rejections) == SkillsConfig().draws - 1
    assert attempt.failure is Failure.NO_INVERSE_KINEMATICS
    assert set(attempt.rejections) == {Failure.NO_INVERSE_KINEMATICS}
    assert attempt.obstacles == ()
    assert attempt.k is not None


def test_a_walled_in_box_is_refused_and_the_wall_named() -> None:
    attempt = assert_refused(WALLED_IN, pick("yellow_box", "table"), UniformConfig())
    assert attempt.failure in (Failure.GOAL_IN_COLLISION, Failure.NO_PATH)
    assert any(wall in attempt.detail for wall in ("left", "right", "front", "back")), attempt.detail
    assert {"left", "right", "front", "back"} & {*attempt.obstacles}
    assert {Failure.GOAL_IN_COLLISION} <= set(attempt.rejections)


def test_a_given_k_is_the_only_one_that_is_tried() -> None:
    setup, k = rig(FAR), np.array([0.0, 0.0, 0.0, 0.1])
    attempt = setup.attempt(setup.start, pick("yellow_box", "table"), k=k)
    assert attempt.failure is Failure.NO_INVERSE_KINEMATICS
    assert attempt.rejections == ()
    np.testing.assert_array_equal(attempt.k, k)


@pytest.mark.parametrize(
    ("spec", "cause"), [(FAR, Failure.NO_INVERSE_KINEMATICS), (WALLED_IN, Failure.GOAL_IN_COLLISION)]
)
def test_a_sampler_that_finds_nothing_says_why_and_is_not_asked_again(spec: SceneSpec, cause: Failure) -> None:
    attempt = assert_refused(spec, pick("yellow_box", "table"), OptimizationConfig(restarts=4))
    assert attempt.failure is cause
    assert attempt.k is None
    assert attempt.rejections == ()


@dataclass(frozen=True)
class Fruitless:
    """A sampler that yields nothing, not even a failure, and its own configuration."""

    def create(self, _: object) -> "Fruitless":
        return self

    def draws(self, *_: object) -> Iterator[Parameter]:
        return iter(())


def test_a_sampler_that_yields_nothing_has_found_nothing() -> None:
    attempt = assert_refused(FAR, pick("yellow_box", "table"), Fruitless())
    assert attempt.failure is Failure.NO_INVERSE_KINEMATICS
    assert attempt.detail == "the sampler found no parameter"
    assert attempt.k is None
    assert attempt.rejections == ()


# execution that fails


@pytest.fixture(scope="module")
def carrying() -> tuple[Rig, Configuration]:
    """yellow_box in the hand."""
    setup = rig(ON_THE_TABLE)
    attempt = setup.attempt(setup.start, pick("yellow_box", "table"))
    assert attempt.successor is not None
    return setup, attempt.successor


def _place_box(
    carrying: tuple[Rig, Configuration], receptacle: str, k: tuple[float, float, float, float]
) -> Failure | None:
    setup, c = carrying
    action = place("yellow_box", receptacle)
    attempt = setup.attempt(c, action, k=np.array(k))
    assert attempt.failure is None or attempt.detail
    return attempt.failure


def test_a_box_put_down_on_an_edge_does_not_pass(carrying: tuple[Rig, Configuration]) -> None:
    assert _place_box(carrying, "cyan_box", (0.0, 0.0, 0.002, 0.0)) is None
    assert _place_box(carrying, "cyan_box", (0.04, 0.0, 0.002, 0.0)) in (Failure.WRONG_STATE, Failure.TOPPLED)


def test_a_box_dropped_from_high_up_or_beside_does_not_pass(carrying: tuple[Rig, Configuration]) -> None:
    assert _place_box(carrying, "rack", (0.0, 0.0, 0.002, 0.3)) is None
    assert _place_box(carrying, "rack", (0.0, 0.3, 0.002, 0.3)) is not None


def test_fingers_that_close_beside_the_box_grasp_nothing() -> None:
    setup = rig(ON_THE_TABLE)
    attempt = setup.attempt(setup.start, pick("yellow_box", "table"), k=np.array([0.0, 0.0, 0.05, 0.0]))
    assert attempt.failure is Failure.NOT_GRASPED
    assert "yellow_box" in attempt.detail
    assert attempt.successor is not None
    assert attempt.motion
