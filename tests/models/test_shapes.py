"""Boxes, tables and racks, as Drake reads them."""

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

from ictamp_drake.core.errors import IctampError
from ictamp_drake.models import box_sdf, rack_sdf, table_sdf

RED = (1.0, 0.0, 0.0)


def parse(sdf: str) -> tuple[MultibodyPlant, SceneGraph]:
    plant, scene_graph = AddMultibodyPlantSceneGraph(DiagramBuilder(), 0.0)
    Parser(plant).AddModelsFromString(sdf, "sdf")
    return plant, scene_graph


def collisions(plant: MultibodyPlant, scene_graph: SceneGraph, name: str) -> dict[str, tuple[object, RigidTransform]]:
    """Shape and pose of every collision geometry of the link by its name in the SDF."""
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
    with pytest.raises(IctampError, match=f"crate: {word}"):
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
    with pytest.raises(IctampError, match="shelf: size"):
        rack_sdf("shelf", (0.22, 0.32, 0.02))
