"""From a scene's specification to bodies in a Drake plant."""

import re
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cache

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

from ictamp_drake.models.contact import SUPPORT
from ictamp_drake.models.package import PACKAGE_FILE, add_package
from ictamp_drake.models.shapes import box_sdf, rack_sdf, rim_contacts, table_sdf
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.world.poses import to_transform

SKIN = 5e-5
"""How much smaller boxes are in queries than they are, on every side [m]: faces that touch within 1e-7 m make the
narrow phase fail or return directions at random, and resting boxes ought to be apart."""

FINEST_RIM = 0.0075
"""Least distance between two contact points along the rim of a support [m]."""
_VISUAL = re.compile(r"<visual\b.*?</visual>", re.DOTALL)
_COLLISION = re.compile(r"<collision\b.*?</collision>", re.DOTALL)

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


def add_arm(plant: MultibodyPlant, spec: SceneSpec, *, visible: bool = False) -> ModelInstanceIndex:
    """Add the Panda with its hand where it stands in the scene to a plant that is not finalised."""
    parser = Parser(plant)
    arm = add_panda(parser, visible=visible)
    base = plant.GetBodyByName("panda_link0", arm)
    plant.WeldFrames(plant.world_frame(), base.body_frame(), to_transform(spec.arm.X_WB))
    return arm


def add_scene(plant: MultibodyPlant, spec: SceneSpec, *, visible: bool = False) -> SceneBodies:
    """Add arm, supports and boxes to a plant that is not finalised; default poses are those of the specification.

    Args:
        plant: of the scene.
        spec: the scene.
        visible: whether the bodies get the shapes that are drawn, in the place of those that collide.
    """
    arm = add_arm(plant, spec, visible=visible)
    parser = Parser(plant)
    supports = {}
    for name, support in sorted(spec.supports.items()):
        supports[name] = _add_body(plant, parser, SUPPORT_SDF[support.kind](name, support.size), visible)
        plant.WeldFrames(plant.world_frame(), supports[name].body_frame(), to_transform(support.X_WT))
    boxes = {}
    for name, box in sorted(spec.boxes.items()):
        boxes[name] = _add_body(plant, parser, box_sdf(name, box.size, box.mass, box.friction, box.color), visible)
        plant.SetDefaultFloatingBaseBodyPose(boxes[name], to_transform(box.X_WO))
    fingers = (plant.GetBodyByName("panda_leftfinger", arm), plant.GetBodyByName("panda_rightfinger", arm))
    return SceneBodies(arm, plant.GetBodyByName("panda_hand", arm), fingers, boxes, supports)


def add_panda(parser: Parser, *, visible: bool = False) -> ModelInstanceIndex:
    """Add the arm with its hand, not welded to anything; with the shapes that are drawn or with those that collide."""
    add_package(parser)
    (arm,) = parser.AddModelsFromString(_panda_sdf(visible), "sdf")
    return arm


@cache
def _panda_sdf(visible: bool) -> str:
    """Drake takes 0.03 s longer to parse a file than to parse its text."""
    text = (PACKAGE_FILE.parent / "sdf" / "panda.sdf").read_text(encoding="utf-8")
    return _keep_shapes(text, visible)


def _add_body(plant: MultibodyPlant, parser: Parser, sdf: str, visible: bool) -> RigidBody:
    (instance,) = parser.AddModelsFromString(_keep_shapes(sdf, visible), "sdf")
    return plant.get_body(plant.GetBodyIndices(instance)[0])


def add_rims(plant: MultibodyPlant, spec: SceneSpec) -> None:
    """Add contact points along the rims of the supports, which carry what overhangs.

    They are half as far apart as the shortest side of a box is long, so there is one beneath a box on either side of
    its centre wherever it overhangs. They belong to the world, since Drake updates the poses of all others at every
    step. With them no joint may be locked: Drake 1.51 reads out of bounds when the world is touched then.
    """
    spacing = max(FINEST_RIM, min(min(box.size) for box in spec.boxes.values()) / 2)
    surface = ProximityProperties()
    friction = CoulombFriction(SUPPORT.friction, SUPPORT.friction)
    AddContactMaterial(SUPPORT.dissipation, SUPPORT.stiffness, friction, surface)
    surface.AddProperty("material", "relaxation_time", SUPPORT.relaxation_time)
    world = plant.world_body()
    for name, support in spec.supports.items():
        X_WT = to_transform(support.X_WT)
        for shape in rim_contacts(support.size, spacing):
            X_WS = X_WT @ RigidTransform(np.array(shape.xyz))
            plant.RegisterCollisionGeometry(world, X_WS, Sphere(*shape.size), f"{name}_{shape.name}", surface)


def _keep_shapes(sdf: str, visible: bool) -> str:
    """The model without the shapes of the other kind, which take a third of the time to parse it."""
    return (_COLLISION if visible else _VISUAL).sub("", sdf)


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
