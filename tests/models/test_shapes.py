"""Boxes, tables and racks as Drake reads them."""

from itertools import product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from pydrake.geometry import Box, Role, SceneGraph, Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, MultibodyPlant
from pydrake.systems.framework import DiagramBuilder

from ictamp_drake.core.errors import Code
from ictamp_drake.models.contact import CONTACT_RADIUS
from ictamp_drake.models.shapes import box_contacts, box_sdf, rack_sdf, rim_contacts, table_sdf
from tests.refusals import refusal

RED = (1.0, 0.0, 0.0)


def parse(sdf: str) -> tuple[MultibodyPlant, SceneGraph]:
    plant, scene_graph = AddMultibodyPlantSceneGraph(DiagramBuilder(), 0.0)
    Parser(plant).AddModelsFromString(sdf, "sdf")
    return plant, scene_graph


def collisions(plant: MultibodyPlant, scene_graph: SceneGraph, name: str) -> dict[str, tuple[object, RigidTransform]]:
    """Shape and pose of every collision geometry of the link, by name in the SDF."""
    inspector = scene_graph.model_inspector()
    frame = plant.GetBodyFrameIdOrThrow(plant.GetBodyByName(name).index())
    return {
        inspector.GetName(g).split("::")[-1]: (inspector.GetShape(g), inspector.GetPoseInFrame(g))
        for g in inspector.GetGeometries(frame, Role.kProximity)
    }


@given(size=st.tuples(*[st.floats(0.01, 0.3)] * 3), mass=st.floats(0.01, 2.0))
def test_box_has_the_inertia_of_uniform_density(size: tuple[float, float, float], mass: float) -> None:
    plant, _ = parse(box_sdf("thing", size, mass, 0.7, RED))
    plant.Finalize()
    M = plant.GetBodyByName("thing").CalcSpatialInertiaInBodyFrame(plant.CreateDefaultContext())
    x, y, z = np.square(size)
    assert M.get_mass() == pytest.approx(mass)
    np.testing.assert_allclose(M.get_com(), 0.0, atol=1e-12)
    expected = np.diag([y + z, x + z, x + y]) * mass / 12.0
    np.testing.assert_allclose(M.CalcRotationalInertia().CopyToFullMatrix3(), expected, rtol=1e-6)


def test_contact_spheres_touch_the_faces_of_the_box_from_inside() -> None:
    size = np.array([0.05, 0.06, 0.118])
    found = collisions(*parse(box_sdf("thing", tuple(size), 0.1, 0.7, RED)), "thing")
    body, X_LB = found.pop("body")
    assert isinstance(body, Box)
    np.testing.assert_allclose(body.size(), size)
    assert X_LB.IsExactlyIdentity()
    assert set(found) == {f"contact_{i}" for i in range(20)}
    signs = set()
    for sphere, X_LC in found.values():
        assert isinstance(sphere, Sphere)
        reach = np.abs(X_LC.translation()) + sphere.radius()
        at_face = np.isclose(reach, size / 2)
        assert np.all(at_face | np.isclose(X_LC.translation(), 0.0))
        assert at_face.sum() >= 2
        signs.add(tuple(np.sign(X_LC.translation()).astype(int)))
    assert signs == {s for s in product((-1, 0, 1), repeat=3) if s.count(0) <= 1}


def test_friction_of_a_box_is_the_given_one() -> None:
    plant, scene_graph = parse(box_sdf("thing", (0.05, 0.05, 0.05), 0.1, 0.37, RED))
    inspector = scene_graph.model_inspector()
    frame = plant.GetBodyFrameIdOrThrow(plant.GetBodyByName("thing").index())
    for geometry in inspector.GetGeometries(frame, Role.kProximity):
        friction = inspector.GetProximityProperties(geometry).GetProperty("material", "coulomb_friction")
        assert friction.static_friction() == friction.dynamic_friction() == pytest.approx(0.37)


@pytest.mark.parametrize(
    ("size", "mass", "word"), [((0.05, 0.05, 0.001), 0.1, "size"), ((0.05, 0.05, 0.05), 0.0, "mass")]
)
def test_impossible_boxes_are_refused_by_name(size: tuple[float, float, float], mass: float, word: str) -> None:
    with refusal(Code.OUT_OF_RANGE, f"crate.{word}"):
        box_sdf("crate", size, mass, 1.0, RED)


def test_top_face_of_the_table_is_its_origin() -> None:
    found = collisions(*parse(table_sdf("desk", (1.0, 0.8, 0.05))), "desk")
    ((name, (box, X_TB)),) = found.items()
    assert name == "top"
    assert X_TB.translation()[2] + box.size()[2] / 2 == pytest.approx(0.0)


def test_rack_stands_on_its_feet_below_its_top_face() -> None:
    size = np.array([0.22, 0.32, 0.16])
    found = collisions(*parse(rack_sdf("shelf", tuple(size))), "shelf")
    assert sorted(found) == ["leg_0", "leg_1", "leg_2", "leg_3", "stabiliser_0", "stabiliser_1", "top"]
    corners = np.array(
        [X.multiply(np.array(s) * box.size() / 2) for box, X in found.values() for s in product((-1, 1), repeat=3)]
    )
    np.testing.assert_allclose(corners.min(axis=0), [-size[0] / 2, -size[1] / 2, -size[2]], atol=1e-9)
    np.testing.assert_allclose(corners.max(axis=0), [size[0] / 2, size[1] / 2, 0.0], atol=1e-9)
    top, X_RT = found["top"]
    np.testing.assert_allclose(top.size(), [0.22, 0.32, 0.01])
    assert X_RT.translation()[2] == pytest.approx(-0.005)


def test_one_cannot_build_a_rack_of_nothing() -> None:
    with refusal(Code.OUT_OF_RANGE, "shelf.size"):
        rack_sdf("shelf", (0.22, 0.32, 0.02))


# rims

MARGIN = 0.003
ANGLES = np.linspace(0.0, 2 * np.pi, 180, endpoint=False)
DIRECTIONS = np.array([np.cos(ANGLES), np.sin(ANGLES)])


def reach_of_contacts(
    support: np.ndarray, rim: np.ndarray, box: tuple[float, float], centre: np.ndarray, yaw: float
) -> float:
    """Distance from a box's center to the outline of its supporting contact points, negative outside [m]."""
    R = np.array([[np.cos(yaw), -np.sin(yaw)], [np.sin(yaw), np.cos(yaw)]])
    feet = np.array([shape.xyz[:2] for shape in box_contacts((*box, 0.05)) if shape.xyz[2] < 0]) @ R.T + centre
    feet = feet[np.all(np.abs(feet) <= support / 2, axis=1)]
    beneath = rim[np.all(np.abs((rim - centre) @ R) <= np.array(box) / 2, axis=1)]
    return float(np.max((np.concatenate([feet, beneath]) - centre) @ DIRECTIONS, axis=0).min())


@pytest.mark.parametrize("size", [(0.4, 0.3, 0.02), (0.22, 0.32, 0.16), (0.06, 0.5, 0.02)])
@pytest.mark.parametrize(("side", "length"), [(0.015, 0.015), (0.015, 0.1), (0.03, 0.05), (0.05, 0.05), (0.05, 0.3)])
def test_whatever_overhangs_a_rim_is_carried(size: tuple[float, float, float], side: float, length: float) -> None:
    """With its center 3 mm inside, a box rests on points at least 1 mm around the center, anywhere, at any angle."""
    rng = np.random.default_rng(0)
    support = np.array(size[:2])
    rim = np.array([shape.xyz[:2] for shape in rim_contacts(size, side / 2)])
    inner = support / 2 - MARGIN
    reach = np.hypot(side, length) / 2
    for i in range(1500):
        # near a corner, near a side, or as near to the rim as possible
        centre = inner - rng.uniform(0.0, np.minimum(2 * inner, (reach, reach) if i % 3 else (0.0, 2 * inner[1])))
        yaw = rng.choice([0.0, np.pi / 4, np.pi / 2, rng.uniform(0.0, np.pi)])
        assert reach_of_contacts(support, rim, (side, length), centre, yaw) > 0.8e-3, (centre, yaw)


def test_a_coarser_rim_would_let_boxes_fall() -> None:
    rim = np.array([shape.xyz[:2] for shape in rim_contacts((0.4, 0.3, 0.02), 0.05)])
    places = [np.array([0.2 - MARGIN, y]) for y in np.linspace(0.0, 0.05, 50)]
    assert min(reach_of_contacts(np.array([0.4, 0.3]), rim, (0.05, 0.05), p, 0.4) for p in places) < 0


def test_spheres_of_a_rim_touch_top_and_sides_from_inside() -> None:
    size = (0.22, 0.315, 0.16)
    spheres = rim_contacts(size, 0.025)
    places = np.array([shape.xyz for shape in spheres])
    assert len({shape.name for shape in spheres}) == len(np.unique(places, axis=0)) == len(spheres)
    np.testing.assert_allclose(places[:, 2] + CONTACT_RADIUS, 0.0)
    gaps = np.array(size[:2]) / 2 - np.abs(places[:, :2]) - CONTACT_RADIUS
    np.testing.assert_allclose(gaps.min(axis=1), 0.0, atol=1e-12)
    assert np.sum(np.all(np.isclose(gaps, 0.0), axis=1)) == 4  # corners
    others = np.linalg.norm(places[:, None] - places[None], axis=2) + np.eye(len(places))
    assert others.min(axis=1).max() <= 0.025 + 1e-9
