"""From a scene's specification to bodies in a Drake plant."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass

import numpy as np
from pydrake.geometry import (
    AddContactMaterial,
    Box,
    CollisionFilterDeclaration,
    GeometryId,
    GeometrySet,
    ProximityProperties,
    Role,
    SceneGraph,
    Sphere,
)
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import ModelInstanceIndex, RigidBody
from pydrake.planning import RobotDiagram, RobotDiagramBuilder

from ictamp_drake.models import add_package
from ictamp_drake.models.contact import SUPPORT
from ictamp_drake.models.shapes import box_sdf, rack_sdf, rim_contacts, table_sdf
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.world.poses import to_transform

PANDA_URL = "package://ictamp_drake/sdf/panda.sdf"

SKIN = 5e-5
"""How much smaller boxes are in queries than they are, on every side [m]: faces that touch within 1e-7 m make the
narrow phase fail or return directions at random, and resting boxes ought to be apart."""

FINEST_RIM = 0.0075
"""Least distance between two contact points along the rim of a support [m]."""

SUPPORT_SDF: Mapping[str, Callable[..., str]] = {"table": table_sdf, "rack": rack_sdf}


@dataclass(frozen=True)
class SceneBodies:
    """What a scene consists of in a plant.

    Attributes:
        arm: model instance of the Panda with its hand: 7 revolute joints, 2 prismatic ones.
        hand: the body that a held object moves with.
        fingers: left and right.
        boxes: free bodies by name, sorted; their frame is O.
        supports: bodies welded to W by name, sorted; their frame is T, in the centre of the top face.
    """

    arm: ModelInstanceIndex
    hand: RigidBody
    fingers: tuple[RigidBody, RigidBody]
    boxes: Mapping[str, RigidBody]
    supports: Mapping[str, RigidBody]


def add_arm(plant: MultibodyPlant, spec: SceneSpec) -> ModelInstanceIndex:
    """Add the Panda with its hand where it stands in the scene to a plant that is not finalised."""
    parser = Parser(plant)
    add_package(parser)
    (arm,) = parser.AddModelsFromUrl(PANDA_URL)
    base = plant.GetBodyByName("panda_link0", arm)
    plant.WeldFrames(plant.world_frame(), base.body_frame(), to_transform(spec.arm.X_WB))
    return arm


def add_scene(plant: MultibodyPlant, spec: SceneSpec) -> SceneBodies:
    """Add arm, supports and boxes to a plant that is not finalised; default poses are those of the specification.

    A discrete plant, which is there for the physics of contact, also gets the rims of the supports.
    """
    arm = add_arm(plant, spec)
    parser = Parser(plant)
    supports = {}
    for name, support in sorted(spec.supports.items()):
        supports[name] = _add_body(plant, parser, SUPPORT_SDF[support.kind](name, support.size))
        plant.WeldFrames(plant.world_frame(), supports[name].body_frame(), to_transform(support.X_WT))
    boxes = {}
    for name, box in sorted(spec.boxes.items()):
        boxes[name] = _add_body(plant, parser, box_sdf(name, box.size, box.mass, box.friction, box.colour))
        plant.SetDefaultFloatingBaseBodyPose(boxes[name], to_transform(box.X_WO))
    if plant.time_step() > 0.0:
        _add_rims(plant, spec, supports)
    fingers = (plant.GetBodyByName("panda_leftfinger", arm), plant.GetBodyByName("panda_rightfinger", arm))
    return SceneBodies(arm, plant.GetBodyByName("panda_hand", arm), fingers, boxes, supports)


def _add_body(plant: MultibodyPlant, parser: Parser, sdf: str) -> RigidBody:
    (instance,) = parser.AddModelsFromString(sdf, "sdf")
    return plant.get_body(plant.GetBodyIndices(instance)[0])


def _add_rims(plant: MultibodyPlant, spec: SceneSpec, supports: Mapping[str, RigidBody]) -> None:
    """Add contact points along the rims of supports, which carry what overhangs.

    They are half as far apart as the shortest side of a box is long, so there is one beneath a box on either side of
    its centre wherever it overhangs. They do not belong to the world, which would be quicker by a tenth: Drake 1.51
    breaks down where a locked body, as sleeping boxes are, touches a shape of the world itself.
    """
    spacing = max(FINEST_RIM, min(min(box.size) for box in spec.boxes.values()) / 2)
    surface = ProximityProperties()
    friction = CoulombFriction(SUPPORT.friction, SUPPORT.friction)
    AddContactMaterial(SUPPORT.dissipation, SUPPORT.stiffness, friction, surface)
    surface.AddProperty("material", "relaxation_time", SUPPORT.relaxation_time)
    for name, body in supports.items():
        for shape in rim_contacts(spec.supports[name].size, spacing):
            X_TS = RigidTransform(np.array(shape.xyz))
            plant.RegisterCollisionGeometry(body, X_TS, Sphere(*shape.size), shape.name, surface)


def remove_contact_points(plant: MultibodyPlant, scene_graph: SceneGraph) -> None:
    """Leave only the shapes themselves: the small spheres serve the physics of contact, not kinematics."""
    source = plant.get_source_id()
    for geometry in _contact_points(scene_graph):
        scene_graph.RemoveRole(source, geometry, Role.kProximity)


def shrink_boxes(plant: MultibodyPlant, scene_graph: SceneGraph, bodies: SceneBodies) -> None:
    """Make the boxes smaller by `SKIN`."""
    inspector = scene_graph.model_inspector()
    for body in bodies.boxes.values():
        for geometry in plant.GetCollisionGeometriesForBody(body):
            shape = inspector.GetShape(geometry)
            if isinstance(shape, Box):
                scene_graph.ChangeShape(plant.get_source_id(), geometry, Box(shape.size() - 2 * SKIN))


def filter_flat_contacts(plant: MultibodyPlant, scene_graph: SceneGraph, bodies: SceneBodies) -> None:
    """Let flat faces touch at contact points only.

    Point contact between two faces is one single point that jumps about; several spheres a face carry it firmly. So
    sphere against sphere, and box against box, top or pad are filtered; sphere against shape remains. Spheres of rims
    are left out, since filters are slow to set up: they seldom meet another sphere, and then touch the solid in it.
    """
    points = _contact_points(scene_graph)
    boxes = [*bodies.boxes.values(), *bodies.supports.values(), *bodies.fingers]
    inspector = scene_graph.model_inspector()
    flat = [
        geometry
        for body in boxes
        for geometry in plant.GetCollisionGeometriesForBody(body)
        if _own_name(inspector.GetName(geometry)) in {"body", "top", "pad"}
    ]
    manager = scene_graph.collision_filter_manager()
    declaration = CollisionFilterDeclaration()
    declaration.ExcludeWithin(GeometrySet(points)).ExcludeWithin(GeometrySet(flat))
    manager.Apply(declaration)


def _contact_points(scene_graph: SceneGraph) -> list[GeometryId]:
    inspector = scene_graph.model_inspector()
    geometries = inspector.GetGeometryIds(GeometrySet(inspector.GetAllGeometryIds()), Role.kProximity)
    return [geometry for geometry in geometries if "contact" in _own_name(inspector.GetName(geometry))]


def _own_name(scoped_name: str) -> str:
    return scoped_name.rsplit("::", 1)[-1]


def build_kinematic(spec: SceneSpec) -> tuple[RobotDiagram, SceneBodies]:
    """A diagram of the scene for kinematics and collision queries: shapes without contact points, no physics."""
    builder = RobotDiagramBuilder(time_step=0.0)
    bodies = add_scene(builder.plant(), spec)
    builder.plant().Finalize()
    remove_contact_points(builder.plant(), builder.scene_graph())
    shrink_boxes(builder.plant(), builder.scene_graph(), bodies)
    return builder.Build(), bodies
