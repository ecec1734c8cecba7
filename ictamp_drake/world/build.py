"""Bodies in a Drake plant, built from the specification of a scene."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from pydrake.geometry import (
    Box,
    CollisionFilterDeclaration,
    GeometryId,
    GeometrySet,
    Role,
    SceneGraph,
    Sphere,
)
from pydrake.math import RigidTransform
from pydrake.multibody.parsing import Parser
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import RigidBody
from pydrake.planning import RobotDiagram, RobotDiagramBuilder

from ictamp_drake.core.types import Configuration, FloatArray
from ictamp_drake.models.contact import SUPPORT
from ictamp_drake.models.model_text import Shapes, keep_shapes
from ictamp_drake.models.shapes import box_sdf, rack_sdf, rim_contacts, table_sdf
from ictamp_drake.robots.bodies import RobotBodies, properties_of
from ictamp_drake.robots.robot import find_robot
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.world.poses import to_transform

SKIN = 5e-5
"""Amount by which boxes shrink on every side in queries [m]. Faces that touch within 1e-7 m make the narrow phase fail
or return random directions, and resting boxes should count as separate."""

AREA_HEIGHT = 0.001
"""Thickness of the rectangles that show regions and poses [m]. Half of it is above the support."""
AREA_COLOR = (0.95, 0.75, 0.25)
"""Color of these rectangles: red, green, blue from 0 to 1."""

FINEST_RIM = 0.0075
"""Smallest distance between two contact points along the rim of a support [m]."""
SUPPORT_SDF: Mapping[str, Callable[..., str]] = {"table": table_sdf, "rack": rack_sdf}


@dataclass(frozen=True)
class SceneBodies:
    """Bodies of a scene in a plant.

    Attributes:
        robot: Arm and gripper.
        boxes: Free bodies by name, sorted. Their frame is O.
        supports: Bodies welded to W by name, sorted. Their frame is T, in the center of the top face.
    """

    robot: RobotBodies
    boxes: Mapping[str, RigidBody]
    supports: Mapping[str, RigidBody]

    def positions(self, c: Configuration) -> FloatArray:
        """Return the positions of the finalized plant in c."""
        q = np.zeros(self.robot.plant.num_positions())
        q[self.robot.arm], q[self.robot.gripper] = c.q, c.fingers
        for name, places in self.box_positions.items():
            q[places] = c.poses[name]
        return q

    @cached_property
    def box_positions(self) -> Mapping[str, slice]:
        """Places of the pose of each box, quaternion and position, in the positions of the finalized plant."""
        starts = {name: body.floating_positions_start() for name, body in self.boxes.items()}
        return {name: slice(start, start + 7) for name, start in starts.items()}


def add_robot(plant: MultibodyPlant, spec: SceneSpec, shapes: Shapes = "contact") -> RobotBodies:
    """Add arm and gripper to a plant that is not finalized, at their place in the scene."""
    return find_robot(spec.robot).add_to(plant, to_transform(spec.arm.X_WB), shapes)


def add_scene(plant: MultibodyPlant, spec: SceneSpec, shapes: Shapes = "contact") -> SceneBodies:
    """Add robot, supports and boxes to a plant that is not finalized. Default poses are those of the specification.

    Args:
        plant: Plant of the scene.
        spec: Specification of the scene.
        shapes: Shapes that the bodies get.
    """
    robot = add_robot(plant, spec, shapes)
    parser = Parser(plant)
    supports = {}
    for name, support in sorted(spec.supports.items()):
        supports[name] = _add_body(plant, parser, SUPPORT_SDF[support.kind](name, support.size), shapes)
        plant.WeldFrames(plant.world_frame(), supports[name].body_frame(), to_transform(support.X_WT))
    if shapes == "visible":
        for name, area in spec.areas.items():
            for number, size in enumerate(area.marks):
                shape, label, color = Box(*size, AREA_HEIGHT), f"{name}_{number}", [*AREA_COLOR, 1.0]
                plant.RegisterVisualGeometry(supports[area.on], to_transform(area.X_TR), shape, label, color)
    boxes = {}
    for name, box in sorted(spec.boxes.items()):
        boxes[name] = _add_body(plant, parser, box_sdf(name, box.size, box.mass, box.friction, box.color), shapes)
        plant.SetDefaultFloatingBaseBodyPose(boxes[name], to_transform(box.X_WO))
    return SceneBodies(robot, boxes, supports)


def _add_body(plant: MultibodyPlant, parser: Parser, sdf: str, shapes: Shapes) -> RigidBody:
    (instance,) = parser.AddModelsFromString(keep_shapes(sdf, shapes), "sdf")
    return plant.get_body(plant.GetBodyIndices(instance)[0])


def add_rims(plant: MultibodyPlant, spec: SceneSpec) -> None:
    """Add contact points along the rims of the supports. They carry boxes that overhang.

    Their spacing is half the shortest side of any box, so wherever a box overhangs, one point lies beneath it on each
    side of its center. They belong to the world body, because Drake updates the poses of all other geometries at every
    step. With rims no joint may be locked: Drake 1.51 then reads out of bounds when something touches the world.
    """
    spacing = max(FINEST_RIM, min(min(box.size) for box in spec.boxes.values()) / 2)
    surface, world = properties_of(SUPPORT), plant.world_body()
    for name, support in spec.supports.items():
        X_WT = to_transform(support.X_WT)
        for shape in rim_contacts(support.size, spacing):
            X_WS = X_WT @ RigidTransform(np.array(shape.xyz))
            plant.RegisterCollisionGeometry(world, X_WS, Sphere(*shape.size), f"{name}_{shape.name}", surface)


def shrink_boxes(plant: MultibodyPlant, scene_graph: SceneGraph, bodies: SceneBodies) -> None:
    """Shrink the boxes by `SKIN` on every side."""
    inspector = scene_graph.model_inspector()
    for body in bodies.boxes.values():
        for geometry in plant.GetCollisionGeometriesForBody(body):
            shape = inspector.GetShape(geometry)
            if isinstance(shape, Box):
                scene_graph.ChangeShape(plant.get_source_id(), geometry, Box(shape.size() - 2 * SKIN))


def filter_flat_contacts(plant: MultibodyPlant, scene_graph: SceneGraph, bodies: SceneBodies) -> None:
    """Let flat faces touch at contact points only.

    Point contact between two faces is a single point that jumps about, whereas several spheres per face carry firmly.
    Therefore sphere against sphere is filtered, and so is box against box, top or pad. Sphere against shape remains.
    Rim spheres are not filtered, because filters are slow to set up. A rim sphere rarely meets another sphere, and then
    touches the solid around it.
    """
    points = _contact_points(scene_graph)
    boxes = [*bodies.boxes.values(), *bodies.supports.values(), *bodies.robot.fingers]
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
    """Build a diagram of the scene for kinematics and collision queries: no contact points and no physics."""
    builder = RobotDiagramBuilder(time_step=0.0)
    bodies = add_scene(builder.plant(), spec, "solid")
    builder.plant().Finalize()
    shrink_boxes(builder.plant(), builder.scene_graph(), bodies)
    find_robot(spec.robot).filter(bodies.robot, builder.scene_graph())
    return builder.Build(), bodies
