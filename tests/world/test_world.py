"""c to Drake's context and back, frames of receptacles, and contacts."""

import pickle

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.strategies import SearchStrategy

from ictamp_drake.core.types import Configuration, GripperCommand
from ictamp_drake.models.panda import ARM_LIMITS
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World
from tests.panda import HOME, MAX_OPENING
from tests.world.scenes import RACK_TOP, SIZES, arrange, far_boxes, pose, scene

NAMES = sorted(SIZES)


@pytest.fixture(scope="module")
def world() -> World:
    return World(scene(far_boxes()))


def _poses() -> SearchStrategy[np.ndarray]:
    angle, length = st.floats(-180, 180), st.floats(-2, 2)
    return st.builds(pose, length, length, length, roll=angle, pitch=angle, yaw=angle)


configurations = st.builds(
    Configuration,
    q=st.tuples(*(st.floats(limits.lower, limits.upper) for limits in ARM_LIMITS)),
    fingers=st.tuples(*2 * [st.floats(0, 0.04)]),
    poses=st.fixed_dictionaries({name: _poses() for name in NAMES}),
    held=st.sampled_from([None, *NAMES]),
    gripper=st.builds(GripperCommand, width=st.floats(0, MAX_OPENING), force=st.floats(0, 70)),
)


@given(c=configurations)
def test_context_shows_c_bit_for_bit(world: World, c: Configuration) -> None:
    world.set_configuration(c)
    plant, context = world.plant, world.plant.GetMyContextFromRoot(world.context)
    np.testing.assert_array_equal(plant.GetPositions(context)[:9], [*c.q, *c.fingers])
    for name, body in world.bodies.boxes.items():
        np.testing.assert_array_equal(plant.GetPositions(context, body.model_instance()), c.poses[name])


@given(c=configurations)
def test_configurations_are_pickled_and_compared(c: Configuration) -> None:
    copy = pickle.loads(pickle.dumps(c))
    assert copy == c
    assert hash(copy) == hash(c)
    assert not any(array.flags.writeable for array in (copy.q, copy.fingers, *copy.poses.values()))
    for name in NAMES:
        moved = Configuration(
            c.q, c.fingers, {**c.poses, name: c.poses[name] + [0, 0, 0, 0, 0, 0, 1e-9]}, c.held, c.gripper
        )
        assert moved != c
    assert Configuration(c.q, c.fingers, c.poses, c.held, GripperCommand(0.05, 71.0)) != c


def test_initial_configuration_is_that_of_the_specification(world: World) -> None:
    c = world.initial_configuration()
    np.testing.assert_array_equal(c.q, HOME)
    np.testing.assert_array_equal(c.fingers, [0.04, 0.04])
    assert list(c.poses) == NAMES
    for name, spec in world.spec.boxes.items():
        np.testing.assert_array_equal(c.poses[name], spec.X_WO)
    assert c.held is None


def test_top_faces_of_supports_and_boxes(world: World) -> None:
    c = arrange(world, {"red_box": pose(0.4, 0.1, 0.025, roll=90.0)})
    X_WT = world.X_WT(c, "red_box")
    np.testing.assert_allclose(X_WT.translation(), [0.4, 0.1, 0.05], atol=1e-12)
    np.testing.assert_allclose(sorted(world.top_size(c, "red_box")), [0.05, 0.118])
    np.testing.assert_allclose(world.X_WT(c, "rack").translation(), [0.44, -0.33, RACK_TOP])
    np.testing.assert_allclose(world.top_size(c, "rack"), [0.22, 0.32])
    for name, support in world.spec.supports.items():
        np.testing.assert_array_equal(world.X_WT(c, name).GetAsMatrix4(), to_transform(support.X_WT).GetAsMatrix4())
        np.testing.assert_array_equal(world.top_size(c, name), support.size[:2])
    np.testing.assert_allclose(world.X_WT(c, "rack").rotation().matrix()[:, 0], [0, 1, 0], atol=1e-12)


@pytest.mark.parametrize("gap", [-0.001, -1e-12, 0.0, 1e-12, 0.001])
@pytest.mark.parametrize("yaw", [0.0, 45.0, 90.0, 33.3])
def test_touches_have_distance_and_direction(world: World, gap: float, yaw: float) -> None:
    """This includes faces that touch exactly, for which distance alone gives no direction."""
    c = arrange(world, {"cyan_box": pose(0.4, 0.1, 0.035), "yellow_box": pose(0.41, 0.1, 0.103 + gap, yaw=yaw)})
    (touch,) = (t for t in world.touches(c, 0.002) if {t.a, t.b} == {"cyan_box", "yellow_box"})
    assert touch.distance == pytest.approx(gap, abs=1e-9)
    up = touch.normal if touch.a == "yellow_box" else -touch.normal
    np.testing.assert_allclose(up, [0, 0, 1], atol=1e-3)


def test_every_pair_within_the_tolerance_is_found_once(world: World) -> None:
    c = world.initial_configuration()
    pairs = [frozenset((t.a, t.b)) for t in world.touches(c, 0.002)]
    on_table = [pair for pair in pairs if pair & set(NAMES)]
    assert sorted(on_table, key=sorted) == sorted((frozenset((name, "table")) for name in NAMES), key=sorted)
    X_WO = to_transform(c.poses["red_box"])
    closer = arrange(
        world, {"blue_box": np.append(c.poses["blue_box"][:4], X_WO.translation() + [0.0, 0.0505, -0.006])}
    )
    found = {frozenset((t.a, t.b)): t.distance for t in world.touches(closer, 0.002)}
    assert found[frozenset(("red_box", "blue_box"))] == pytest.approx(0.0005, abs=1e-9)


@given(
    gap=st.floats(-11, 11).map(lambda power: np.sign(power) * 10.0 ** (-5 - abs(power))),
    roll=st.floats(-14, -6).map(lambda power: 10.0**power),
    pitch=st.sampled_from([0.0, 1e-11, 1e-9]),
    yaw=st.floats(-180, 180),
)
def test_faces_that_all_but_touch_have_a_direction(
    world: World, gap: float, roll: float, pitch: float, yaw: float
) -> None:
    """General collision algorithms guess or fail for nearly parallel faces closer than 1e-7 m."""
    poses = {"cyan_box": pose(0.4, 0.1, 0.035), "red_box": pose(0.4, 0.1, 0.129 + gap, roll=roll, pitch=pitch, yaw=yaw)}
    (touch,) = (t for t in world.touches(arrange(world, poses), 0.002) if {t.a, t.b} == set(poses))
    assert touch.distance == pytest.approx(gap, abs=1e-6)
    np.testing.assert_allclose(touch.normal * (1 if touch.a == "red_box" else -1), [0, 0, 1], atol=1e-3)
