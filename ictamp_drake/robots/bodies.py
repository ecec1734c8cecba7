"""A robot in a Drake plant."""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from functools import cached_property

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import AddContactMaterial, Box, Capsule, Cylinder, ProximityProperties, Shape, Sphere
from pydrake.math import RigidTransform, RollPitchYaw
from pydrake.multibody.plant import CoulombFriction, MultibodyPlant
from pydrake.multibody.tree import FixedOffsetFrame, Frame, Joint, JointActuator, ModelInstanceIndex, RigidBody

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.models.contact import BODY, CONTACT_RADIUS, PAD, PAD_CONTACT_PROUD, Surface
from ictamp_drake.robots.spec import FrameSpec, PadsSpec, ShapeSpec

IntArray = NDArray[np.intp]


@dataclass(frozen=True, eq=False)
class RobotBodies:
    """Bodies and joints of a robot in one plant.

    Attributes:
        plant: Plant that they are in.
        instances: Model instances: the arm's, and the gripper's if it has a model of its own.
        base: Frame that stands where the scene's arm does.
        grasp: Frame G.
        faces: Frames in the centers of the pads' gripping faces.
        hand: Body that a held object moves with.
        fingers: Bodies that carry the pads.
        arm_joints: Joints of the arm, from the base to the hand.
        driven: Joints of the fingers that are driven.
    """

    plant: MultibodyPlant
    instances: tuple[ModelInstanceIndex, ...]
    base: Frame
    grasp: Frame
    faces: tuple[Frame, Frame]
    hand: RigidBody
    fingers: tuple[RigidBody, RigidBody]
    arm_joints: tuple[Joint, ...]
    driven: tuple[Joint, ...]

    @cached_property
    def finger_joints(self) -> tuple[Joint, ...]:
        """All joints of the fingers, driven or not, in the order of the plant."""
        arm = {joint.index() for joint in self.arm_joints}
        indices = [index for instance in self.instances for index in self.plant.GetJointIndices(instance)]
        joints = (self.plant.get_joint(index) for index in indices if index not in arm)
        return tuple(joint for joint in joints if joint.num_positions() == 1)

    @cached_property
    def links(self) -> tuple[RigidBody, ...]:
        """All bodies of the robot."""
        indices = [index for instance in self.instances for index in self.plant.GetBodyIndices(instance)]
        return tuple(self.plant.get_body(index) for index in indices)

    @cached_property
    def names(self) -> Mapping[str, RigidBody]:
        """All bodies of the robot by the names of `name_links`."""
        return name_links(self.links)

    @cached_property
    def arm(self) -> IntArray:
        """Places of the arm's joints in the positions of the finalized plant, shape (n,)."""
        return np.array([joint.position_start() for joint in self.arm_joints], dtype=np.intp)

    @cached_property
    def gripper(self) -> IntArray:
        """Places of the fingers' joints in the positions of the finalized plant, shape (m,)."""
        return np.array([joint.position_start() for joint in self.finger_joints], dtype=np.intp)

    @cached_property
    def velocities(self) -> IntArray:
        """Places of arm and fingers in the velocities of the finalized plant, shape (n + m,)."""
        joints = self.arm_joints + self.finger_joints
        return np.array([joint.velocity_start() for joint in joints], dtype=np.intp)

    @cached_property
    def turning(self) -> tuple[RigidBody, ...]:
        """Links that turn with the last joint of the arm: the hand, its fingers, and what holds them."""
        moved = self.plant.GetBodiesKinematicallyAffectedBy([self.arm_joints[-1].index()])
        return tuple(map(self.plant.get_body, moved))

    @cached_property
    def moving(self) -> tuple[RigidBody, ...]:
        """Links that the joints of the fingers move."""
        moved = self.plant.GetBodiesKinematicallyAffectedBy([joint.index() for joint in self.finger_joints])
        return tuple(map(self.plant.get_body, moved))

    @cached_property
    def actuators(self) -> tuple[JointActuator, ...]:
        """Actuators of the arm's joints, then of the driven joints of the fingers: the order of a command."""
        actuators = map(self.plant.get_joint_actuator, self.plant.GetJointActuatorIndices())
        return tuple(actuator for actuator in actuators if actuator.model_instance() in self.instances)

    def parts(self, instance: ModelInstanceIndex) -> tuple[bool, bool]:
        """Whether a model instance contains the arm, and whether it contains the gripper."""
        return instance == self.instances[0], instance == self.instances[-1]


@contextmanager
def refuse_unconnected() -> Iterator[None]:
    """Raise IctampError where Drake cannot connect the links of a robot."""
    try:
        yield
    except RuntimeError as error:
        problem = f"Drake cannot build the robot: {str(error).strip().partition(chr(10))[0]}"
        advice = "the model must not fix the robot to the world: the scene does"
        raise IctampError(Code.CONFLICT, problem, field="base", advice=advice) from error


def name_links(links: Iterable[RigidBody]) -> dict[str, RigidBody]:
    """Return links of the arm and then of the gripper by name; gripper::NAME is a link whose name the arm has, too."""
    found: dict[str, RigidBody] = {}
    for body in links:
        found[f"gripper::{body.name()}" if body.name() in found else body.name()] = body
    return found


def find_frame(plant: MultibodyPlant, instance: ModelInstanceIndex, name: str, field: str) -> Frame:
    """Return a frame or the frame of a body.

    Raises:
        IctampError: The model has neither.
    """
    if plant.HasFrameNamed(name, instance):
        return plant.GetFrameByName(name, instance)
    bodies = [plant.get_body(index).name() for index in plant.GetBodyIndices(instance)]
    raise IctampError(Code.UNKNOWN_CHOICE, "there is no body or frame {value}", field=field, value=name, choices=bodies)


def find_joint(plant: MultibodyPlant, instance: ModelInstanceIndex, name: str, field: str) -> Joint:
    """Return a joint that moves in one way.

    Raises:
        IctampError: The model has no such joint.
    """
    joints = [plant.get_joint(index) for index in plant.GetJointIndices(instance)]
    moving = {joint.name(): joint for joint in joints if joint.num_positions() == 1}
    if name not in moving:
        raise IctampError(Code.UNKNOWN_CHOICE, "there is no joint {value}", field=field, value=name, choices=moving)
    return moving[name]


def pose_of(spec: FrameSpec | ShapeSpec) -> RigidTransform:
    """Return the pose of a frame or shape in the frame or body that it is fixed to."""
    return RigidTransform(RollPitchYaw(np.deg2rad(spec.rotation)), np.array(spec.position))


def add_frame(plant: MultibodyPlant, name: str, parent: Frame, X: RigidTransform) -> Frame:
    """Add a frame fixed to another one."""
    return plant.AddFrame(FixedOffsetFrame(name, parent, X))


def properties_of(surface: Surface) -> ProximityProperties:
    """Return the contact properties of a surface."""
    properties = ProximityProperties()
    friction = CoulombFriction(surface.friction, surface.friction)
    AddContactMaterial(surface.dissipation, surface.stiffness, friction, properties)
    properties.AddProperty("material", "relaxation_time", surface.relaxation_time)
    return properties


def add_shapes(plant: MultibodyPlant, body: RigidBody, shapes: Sequence[ShapeSpec]) -> None:
    """Add collision shapes to a body."""
    kinds: dict[str, type[Shape]] = {"box": Box, "cylinder": Cylinder, "capsule": Capsule, "sphere": Sphere}
    for number, shape in enumerate(shapes):
        added = kinds[shape.kind](*shape.size)
        name = f"{body.name()}_{shape.kind}_{number}"
        plant.RegisterCollisionGeometry(body, pose_of(shape), added, name, properties_of(BODY))


def add_pads(plant: MultibodyPlant, face: Frame, pads: PadsSpec, *, points: bool) -> None:
    """Add to a finger its pad, behind the gripping face, and contact spheres in its corners if `points`."""
    x, y, z = pads.size
    body, X_BF = face.body(), face.GetFixedPoseInBodyFrame()
    properties = properties_of(PAD)
    plant.RegisterCollisionGeometry(body, X_BF @ RigidTransform([0.0, y / 2, 0.0]), Box(x, y, z), "pad", properties)
    corners = np.array([(i, j) for i in (-1, 1) for j in (-1, 1)]) * (np.array([x, z]) / 2 - CONTACT_RADIUS)
    for number, (along, up) in enumerate(corners if points else ()):
        X_BS = X_BF @ RigidTransform([along, CONTACT_RADIUS - PAD_CONTACT_PROUD, up])
        plant.RegisterCollisionGeometry(body, X_BS, Sphere(CONTACT_RADIUS), f"pad_contact_{number}", properties)
