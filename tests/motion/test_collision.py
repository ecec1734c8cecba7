import numpy as np
import pytest
from pydrake.math import RigidTransform, RotationMatrix

from ictamp_drake.core.types import Configuration
from ictamp_drake.motion.collision import CollisionScene
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.motion.trajectory import sample
from ictamp_drake.motion.trajectory_optimization import TrajectoryOptimizer
from ictamp_drake.world.world import World
from tests.panda import HOME, LOWER, PANDA, UPPER

ARM = ArmKinematics(PANDA, RigidTransform())
UPSIDE_DOWN = RotationMatrix.MakeXRotation(np.pi)


@pytest.fixture
def scene(world: World) -> CollisionScene:
    return CollisionScene(world)


def reach(X_WG: RigidTransform) -> np.ndarray:
    q = ARM.solve(X_WG, HOME)
    assert q is not None
    return q


def test_agrees_with_plain_queries(world: World, scene: CollisionScene, overlaps) -> None:
    c = world.initial_configuration()
    rng = np.random.default_rng(1)
    free = 0
    for q in np.clip(HOME + rng.uniform(-1.3, 1.3, (150, 7)), LOWER, UPPER):
        depths = overlaps(world, c, q)
        assert scene.is_free(c, q) == (not depths)
        assert {frozenset(contact[:2]) for contact in scene.contacts(c, q)} == set(depths)
        free += not depths
    assert 20 < free < 130


def test_held_box_moves_with_the_hand(world: World, scene: CollisionScene, down, holding, overlaps) -> None:
    c = holding(HOME, "blue_box", ARM.forward(HOME) @ RigidTransform(UPSIDE_DOWN, [0.0, 0.0, 0.03]))
    rng = np.random.default_rng(2)
    differs = 0
    for x, y, z in rng.uniform([0.42, 0.0, 0.25], [0.58, 0.2, 0.4], (60, 3)):
        q = reach(down(x, y, z))
        depths = overlaps(world, c, q)
        held_free = scene.is_free(c, q)
        if not depths or max(depths.values()) > 2e-3:  # the held box counts as 1 mm smaller
            assert held_free == (not depths)
        empty = Configuration(c.q, c.fingers, {**c.poses, "blue_box": world.initial_configuration().poses["blue_box"]})
        differs += scene.is_free(empty, q) and not held_free
    assert differs > 5


def test_box_that_rests_and_is_held_collides_only_deeper(scene: CollisionScene, down, holding) -> None:
    q = reach(down(0.5, 0.3, 0.07))
    c = holding(q, "blue_box", RigidTransform([0.5, 0.3, 0.053]))
    assert scene.is_free(c, q)
    assert str(scene.first_contact(c, reach(down(0.5, 0.3, 0.066))[None])) == "blue_box would touch table"


def test_place_that_the_held_box_left_is_empty(world: World, scene: CollisionScene, down, holding) -> None:
    q = reach(down(0.5, 0.3, 0.04, 0.5))
    c = holding(HOME, "blue_box", ARM.forward(HOME) @ RigidTransform(UPSIDE_DOWN, [0, 0, 0.2]))
    contacts = scene.contacts(c, q)
    assert "blue_box" not in {contact.other for contact in contacts}
    closed = Configuration(HOME, np.zeros(2), world.initial_configuration().poses)
    assert "blue_box" in {contact.other for contact in scene.contacts(closed, q)}


def test_contacts_are_sentences_with_distances(scene: CollisionScene, c: Configuration, down) -> None:
    q = reach(down(0.4, -0.05, -0.02))
    contact = scene.first_contact(c, np.array([HOME, q]))
    assert contact is not None
    assert contact.other == "table"
    assert contact.distance < -0.015
    assert str(contact) == f"{contact.moving} would touch table"
    assert scene.first_contact(c, HOME[None]) is None


def test_padding_is_kept_from_the_scene(scene: CollisionScene, c: Configuration, down) -> None:
    q = reach(down(0.4, -0.05, 0.03))
    clearance = scene.clearance(c, q, 0.1)
    assert 0.015 < clearance < 0.025
    assert scene.is_free(c, q, padding=clearance - 1e-3)
    assert not scene.is_free(c, q, padding=clearance + 1e-3)
    assert scene.is_free(c, HOME, padding=0.05)  # parts of the arm need not keep the padding from each other
    assert scene.clearance(c, q, 0.01) == 0.01


@pytest.mark.parametrize("held", [False, True])
@pytest.mark.parametrize("padding", [0.002, 0.0045, 0.005, 0.02])
def test_padding_means_that_no_distance_is_shorter(
    world: World, c: Configuration, down, holding, *, held: bool, padding: float
) -> None:
    """This holds although few distances are computed, and also beyond the padding up to which they are few."""
    scene = CollisionScene(world, padding=0.005)
    if held:
        c = holding(HOME, "blue_box", ARM.forward(HOME) @ RigidTransform(UPSIDE_DOWN, [0, 0, 0.03]))
    rng = np.random.default_rng(4)
    verdicts = set()
    for x, y, z in rng.uniform([0.42, 0.0, 0.2], [0.58, 0.2, 0.36], (80, 3)):
        q = reach(down(x, y, z))
        nearest = min((contact.distance for contact in scene.contacts(c, q, 0.1)), default=np.inf)
        near = scene.is_free(c, q) and not scene.is_free(c, q, padding)
        assert scene.is_free(c, q, padding) == (nearest > padding and scene.is_free(c, q))
        verdicts.add((scene.is_free(c, q), near))
    assert verdicts == {(True, False), (True, True), (False, False)}


@pytest.mark.parametrize("padding", [0.0, 0.0045])
def test_verdict_on_a_trajectory_is_that_of_all_its_samples(
    scene: CollisionScene, c: Configuration, down, padding: float
) -> None:
    optimizer, rng = TrajectoryOptimizer(PANDA), np.random.default_rng(5)
    counts = [0, 0]
    for x, y, z in rng.uniform([0.35, 0.05, 0.08], [0.65, 0.35, 0.4], (30, 3)):
        qs = sample(optimizer.follow(np.array([HOME, reach(down(x, y, z))]), 14), ARM.forward_all, 0.01, 0.02)
        each = [not scene.contacts(c, q, padding) for q in qs]
        assert scene.are_free(c, qs, padding) == all(each)
        contact = scene.first_contact(c, qs, padding)
        if all(each):
            assert contact is None
        else:
            assert contact == scene.contacts(c, qs[each.index(False)], padding)[0]
        counts[all(each)] += 1
    assert min(counts) >= 5


def test_all_must_be_free(scene: CollisionScene, c: Configuration, down) -> None:
    colliding = reach(down(0.4, -0.05, -0.02))
    for index in range(5):
        qs = np.tile(HOME, (5, 1))
        assert scene.are_free(c, qs)
        qs[index] = colliding
        assert not scene.are_free(c, qs)


def test_gradients_are_derivatives_of_the_distances(scene: CollisionScene, down, holding) -> None:
    c = holding(HOME, "blue_box", ARM.forward(HOME) @ RigidTransform(UPSIDE_DOWN, [0.0, 0.0, 0.03]))
    q = reach(down(0.42, 0.03, 0.3)) + np.linspace(-0.02, 0.02, 7)  # parallel faces have no derivative
    rng = np.random.default_rng(3)
    found = scene.clearance_gradients(c, q, 0.2)
    nearest, gradient = min(found, key=lambda item: item[0])
    assert nearest == pytest.approx(scene.clearance(c, q, 0.2))
    assert np.linalg.norm(gradient) > 0.05
    for direction in rng.normal(size=(5, 7)):
        step = 1e-5 * direction
        slope = (scene.clearance(c, q + step, 0.2) - scene.clearance(c, q - step, 0.2)) / 2
        assert slope == pytest.approx(gradient @ step, abs=2e-7)
