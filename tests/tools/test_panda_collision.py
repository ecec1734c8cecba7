"""The collision geometry agrees with the meshes of the real links, which are not part of the package."""

from importlib.metadata import files
from pathlib import Path

import numpy as np
import pytest
import trimesh
from pydrake.geometry import Box, Capsule, Cylinder, GeometryId, QueryObject, Role, Sphere
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import AddMultibodyPlantSceneGraph, MultibodyPlant
from pydrake.systems.framework import Context, DiagramBuilder
from scipy.spatial import cKDTree

from ictamp_drake.models.package import add_package

SLACK = {"panda_hand": 0.010, "panda_leftfinger": 0.005, "panda_rightfinger": 0.005}
"""Maximum protrusion of the primitives beyond hand and fingers [m]; 2 cm for every other link."""
LINKS = [*(f"panda_link{i}" for i in range(8)), "panda_hand", "panda_leftfinger", "panda_rightfinger"]
SAMPLES = 3000
TOLERANCE = 1e-4
"""Depth of the pads' faces, which are at the joint's zero, inside the mesh [m]."""


def real_link(name: str) -> trimesh.Trimesh:
    """Mesh of the real link, in the link's frame."""
    kind = "finger" if name.endswith("finger") else name.removeprefix("panda_")
    found = files("example-robot-data") or []
    (path,) = (f for f in found if str(f).endswith(f"panda_description/meshes/visual/{kind}.dae"))
    return trimesh.load(Path(str(path.locate())), force="mesh")


class Links:
    """Primitives of the model, as Drake reads them."""

    def __init__(self) -> None:
        builder = DiagramBuilder()
        plant, scene_graph = AddMultibodyPlantSceneGraph(builder, 0.0)
        parser = Parser(plant)
        add_package(parser)
        parser.AddModelsFromUrl("package://ictamp_drake/sdf/panda.sdf")
        plant.Finalize()
        self.plant: MultibodyPlant = plant
        self.diagram = builder.Build()
        self.context: Context = self.diagram.CreateDefaultContext()
        self.query: QueryObject = scene_graph.get_query_output_port().Eval(
            scene_graph.GetMyContextFromRoot(self.context)
        )

    def geometries(self, name: str) -> list[GeometryId]:
        frame = self.plant.GetBodyFrameIdOrThrow(self.plant.GetBodyByName(name).index())
        return list(self.query.inspector().GetGeometries(frame, Role.kProximity))

    def distances(self, name: str, points: np.ndarray) -> np.ndarray:
        """Signed distance of every point (n, 3) of the link's frame to every primitive of the link, shape (n, m)."""
        ids = self.geometries(name)
        X_WL = self.plant.EvalBodyPoseInWorld(
            self.plant.GetMyContextFromRoot(self.context), self.plant.GetBodyByName(name)
        )
        p_WQ = X_WL.multiply(points.T).T
        return np.array([self._to_each(ids, point) for point in p_WQ])

    def _to_each(self, ids: list[GeometryId], point: np.ndarray) -> list[float]:
        found = {d.id_G: d.distance for d in self.query.ComputeSignedDistanceToPoint(point)}
        return [found[i] for i in ids]

    def boundary(self, name: str) -> np.ndarray:
        """Points on the surface of the union of the link's primitives, including its corners, shape (n, 3)."""
        inspector = self.query.inspector()
        ids = self.geometries(name)
        pieces = [points_on(inspector.GetShape(i), inspector.GetPoseInFrame(i)) for i in ids]
        points = np.concatenate(pieces)
        return points[self.distances(name, points).min(axis=1) > -1e-4]


def points_on(shape: object, X_LS: RigidTransform) -> np.ndarray:
    match shape:
        case Box():
            mesh = trimesh.creation.box(shape.size())
        case Cylinder():
            mesh = trimesh.creation.cylinder(shape.radius(), shape.length(), sections=64)
        case Capsule():
            mesh = trimesh.creation.capsule(shape.length(), shape.radius(), count=[32, 32])
            mesh.apply_translation(-mesh.bounds.mean(axis=0))
        case Sphere():
            mesh = trimesh.creation.icosphere(3, shape.radius())
        case _:
            raise AssertionError(shape)
    samples = trimesh.sample.sample_surface(mesh, SAMPLES // 3, seed=0)[0]
    return X_LS.multiply(np.concatenate([mesh.vertices[:2000], samples]).T).T


@pytest.fixture(scope="module")
def links() -> Links:
    return Links()


@pytest.mark.parametrize("name", LINKS)
def test_primitives_hold_the_real_link(links: Links, name: str) -> None:
    mesh = real_link(name)
    samples = trimesh.sample.sample_surface(mesh, SAMPLES, seed=0)[0]
    points = np.concatenate([mesh.convex_hull.vertices, samples])
    assert links.distances(name, points).min(axis=1).max() < TOLERANCE


@pytest.mark.parametrize("name", LINKS)
def test_primitives_stay_near_the_real_link(links: Links, name: str) -> None:
    surface = trimesh.sample.sample_surface(real_link(name), 100_000, seed=0)[0]
    distances, _ = cKDTree(surface).query(links.boundary(name))
    assert distances.max() < SLACK.get(name, 0.02)
