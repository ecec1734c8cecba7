"""An arm with a gripper, built from its file. Everything that must know the robot of a scene asks it here."""

from collections.abc import Hashable
from dataclasses import dataclass
from functools import cached_property, lru_cache
from pathlib import Path

import numpy as np
from pydrake.geometry import CollisionFilterDeclaration, GeometrySet, SceneGraph
from pydrake.math import RigidTransform
from pydrake.multibody.plant import MultibodyPlant
from pydrake.multibody.tree import Joint, ModelInstanceIndex, RevoluteJoint

from ictamp_drake.core.checks import check_range
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.protocols import InverseKinematics
from ictamp_drake.core.reading import in_file
from ictamp_drake.core.types import FloatArray, KinematicsKind
from ictamp_drake.models.model_text import Shapes
from ictamp_drake.robots.bodies import (
    IntArray,
    RobotBodies,
    add_frame,
    add_pads,
    add_shapes,
    find_frame,
    find_joint,
    pose_of,
    refuse_unconnected,
)
from ictamp_drake.robots.chain import Chain, read_chain
from ictamp_drake.robots.choice import OPTION, create_inverse_kinematics
from ictamp_drake.robots.files import stamp_of
from ictamp_drake.robots.gripper import Gripper
from ictamp_drake.robots.measure import find_touching, measure_fingers, measure_hand
from ictamp_drake.robots.model_files import add_model, brings_pad, find_model, read_efforts, read_mimics
from ictamp_drake.robots.panda import forward as panda_forward
from ictamp_drake.robots.panda import is_panda
from ictamp_drake.robots.spec import DEFAULT, RobotSpec, find_file, read_robot

_ALIGNED = 1e-6
"""Largest deviation of axes and points that count as aligned [1 or m]."""


@dataclass(frozen=True, eq=False)
class Robot:
    """An arm with a gripper.

    Attributes:
        name: Name of a robot that ships, or the path of the robot's file.
        spec: Content of the file.
        model: File of the arm's model.
        gripper_model: File of the gripper's model; None if the arm's model contains the gripper.
    """

    name: str
    spec: RobotSpec
    model: Path
    gripper_model: Path | None

    @property
    def joints(self) -> tuple[str, ...]:
        """Names of the arm's joints, from the base to the hand."""
        return self.spec.joints

    @cached_property
    def home(self) -> FloatArray:
        """Comfortable posture of the arm, with the hand pointing down in front of the base, shape (n,) [rad]."""
        return _freeze(self.spec.home)

    @cached_property
    def lower(self) -> FloatArray:
        """Lower position limits of the arm's joints, shape (n,) [rad]."""
        return _freeze([joint.position_lower_limit() for joint in self._bare.arm_joints])

    @cached_property
    def upper(self) -> FloatArray:
        """Upper position limits of the arm's joints, shape (n,) [rad]."""
        return _freeze([joint.position_upper_limit() for joint in self._bare.arm_joints])

    @cached_property
    def velocity(self) -> FloatArray:
        """Velocity limits of the arm's joints, shape (n,) [rad/s]."""
        return self._limit("velocity", [joint.velocity_upper_limit() for joint in self._bare.arm_joints])

    @cached_property
    def acceleration(self) -> FloatArray:
        """Acceleration limits of the arm's joints, shape (n,) [rad/s^2]."""
        return self._limit("acceleration", [joint.acceleration_upper_limit() for joint in self._bare.arm_joints])

    @cached_property
    def jerk(self) -> FloatArray:
        """Jerk limits of the arm's joints, shape (n,) [rad/s^3]."""
        return self._limit("jerk", np.full(len(self.joints), np.inf))

    @cached_property
    def effort(self) -> FloatArray:
        """Torque limits of the arm's joints, shape (n,) [N m]."""
        arm = self._bare.actuators[: len(self.joints)]
        return self._limit("effort", [actuator.effort_limit() for actuator in arm])

    def _limit(self, name: str, found: "list[float] | FloatArray") -> FloatArray:
        """Return the limits of the file, or those of the model if the file has none."""
        limits = np.array(getattr(self.spec, name) or found)
        known = np.isfinite(limits) & (limits > 0)  # some models write 0 for what they do not know
        if not known.all():
            joint = self.joints[int(np.argmin(known))]
            problem = f"the model has no {name} limit of {joint}, so the file must give one for each joint"
            raise IctampError(Code.MISSING_FIELD, problem, field=name)
        return _freeze(limits)

    @cached_property
    def gripper(self) -> Gripper:
        """Gripper."""
        spec, bare = self.spec.gripper, self._bare
        names = tuple(joint.name() for joint in bare.finger_joints)
        moves = measure_fingers(bare, spec, read_mimics(self.gripper_model or self.model))
        return Gripper(
            spec,
            names,
            tuple(names.index(name) for name in spec.joints),
            measure_hand(self, moves),
            *moves,
        )

    @cached_property
    def places(self) -> IntArray:
        """Places of arm and fingers in the positions of a plant in which the robot comes first, shape (n + m,)."""
        return np.concatenate([self._bare.arm, self._bare.gripper])

    @cached_property
    def chain(self) -> Chain:
        """Joints of the arm from the base to G."""
        bare = self._bare
        return read_chain(bare.plant, bare.arm_joints, bare.base, bare.grasp)

    @cached_property
    def _is_panda(self) -> bool:
        return is_panda(self.chain)

    def forward(self, q: FloatArray) -> FloatArray:
        """X_BG at the arm's joint positions, shape (m, n) [rad] -> (m, 4, 4)."""
        return panda_forward(q) if self._is_panda else self.chain.forward(q)

    @cached_property
    def X_FG(self) -> RigidTransform:
        """Pose of G in the frame of the flange F."""
        bare = self._bare
        flange = find_frame(bare.plant, bare.instances[0], self.spec.flange, "flange")
        return bare.plant.CalcRelativeTransform(bare.plant.CreateDefaultContext(), flange, bare.grasp)

    @cached_property
    def waist(self) -> float:
        """1 or -1 if the first joint turns the arm about the base's z axis, or against it; else 0."""
        return _align(self.chain.axes[0], np.array([0.0, 0.0, 1.0]))

    @cached_property
    def wrist(self) -> float:
        """1 or -1 if the last joint turns the hand about G's z axis, or against it, and does not move G; else 0."""
        offset, axis = self.chain.offsets[-1], self.chain.axes[-1]
        is_on_axis = np.abs(np.cross(offset, axis)).max() < _ALIGNED
        return _align(axis, self.chain.rotation[:, 2]) if is_on_axis else 0.0

    def face(self, x: float, y: float) -> FloatArray:
        """Return home, with the arm turned about its waist towards (x, y) in the base frame [m], shape (n,) [rad].

        An arm without a waist stays as it is.
        """
        first = self.home[0] + self.waist * (np.arctan2(y, x) - self._heading)
        first += 2 * np.pi * np.round((self.home[0] - first) / (2 * np.pi))
        return np.append(first, self.home[1:])

    @cached_property
    def _heading(self) -> float:
        """Direction of G from the base at home, about the base's z axis [rad]."""
        x, y = np.round(self.forward(self.home[None])[0, :2, 3], 6)
        return float(np.arctan2(y, x))

    def inverse(self, kind: KinematicsKind, starts: int) -> InverseKinematics:
        """Return the inverse kinematics of a kind, see `robots.choice`; `auto` leaves the choice to the robot's file.

        A choice may take a while, so each is made once.
        """
        if kind != "auto":
            return _inverse_kinematics(self, kind, starts, OPTION)
        with in_file(find_file(self.name)):
            return _inverse_kinematics(self, self.spec.kinematics, starts, "kinematics")

    @cached_property
    def _bare(self) -> RobotBodies:
        """The robot alone, without shapes, in a plant whose joints all move freely."""
        return self.add_alone(MultibodyPlant(0.0))

    def add_alone(self, plant: MultibodyPlant, shapes: Shapes = "contact") -> RobotBodies:
        """Add the robot to an empty plant, with its base in the origin of the world, and finalize the plant.

        Raises:
            IctampError: Drake cannot connect the links.
        """
        with refuse_unconnected():
            bodies = self.add_to(plant, RigidTransform(), shapes)
            plant.Finalize()
        return bodies

    def add_to(self, plant: MultibodyPlant, X_WB: RigidTransform, shapes: Shapes = "contact") -> RobotBodies:
        """Add the robot to a plant that is not finalized, and fix its base at a pose.

        The plant has actuators of the joints that are commanded and no others. If it is continuous, joints that follow
        others move freely. Call `filter` once it is finalized.
        """
        spec, gripper = self.spec, self.spec.gripper
        arm, held = self._add_models(plant, X_WB, shapes)
        arm_joints = [find_joint(plant, arm, name, f"joints[{i}]") for i, name in enumerate(spec.joints)]
        driven = [find_joint(plant, held, name, f"gripper.joints[{i}]") for i, name in enumerate(gripper.joints)]
        instances = tuple(dict.fromkeys((arm, held)))
        self._actuate(plant, instances, [*arm_joints, *driven])
        pads = {"first": gripper.pads.first, "second": gripper.pads.second}
        parents = [find_frame(plant, held, pad.frame, f"gripper.pads.{name}") for name, pad in pads.items()]
        first, second = (
            add_frame(plant, f"{name}_pad_face", parent, pose_of(pad))
            for (name, pad), parent in zip(pads.items(), parents, strict=True)
        )
        grasp = find_frame(plant, held, gripper.grasp.frame, "gripper.grasp.frame")
        bodies = RobotBodies(
            plant=plant,
            instances=instances,
            base=find_frame(plant, arm, spec.base, "base"),
            grasp=add_frame(plant, "grasp_frame", grasp, pose_of(gripper.grasp)),
            faces=(first, second),
            hand=find_frame(plant, held, gripper.base, "gripper.base").body(),
            fingers=(first.body(), second.body()),
            arm_joints=tuple(arm_joints),
            driven=tuple(driven),
        )
        for joint in bodies.finger_joints:
            if gripper.joint_damping is not None:
                joint.set_default_damping(gripper.joint_damping)
        if not plant.time_step():
            for constraint in plant.GetConstraintIds():
                plant.RemoveConstraint(constraint)
        if plant.geometry_source_is_registered() and shapes != "visible":
            self._add_shapes(bodies, points=shapes == "contact")
        return bodies

    def _add_models(
        self, plant: MultibodyPlant, X_WB: RigidTransform, shapes: Shapes
    ) -> tuple[ModelInstanceIndex, ModelInstanceIndex]:
        """Add the models, fix the base and mount the gripper; return the instances of arm and gripper, maybe the same.

        See `add_to`.
        """
        spec, gripper = self.spec, self.spec.gripper
        without = frozenset(spec.collision) | (frozenset() if self.gripper_model else frozenset(gripper.collision))
        arm = add_model(plant, self.model, shapes, without, "model")
        plant.WeldFrames(plant.world_frame(), find_frame(plant, arm, spec.base, "base"), X_WB)
        if self.gripper_model is None or gripper.mount is None:
            return arm, arm
        held = add_model(plant, self.gripper_model, shapes, frozenset(gripper.collision), "gripper.model")
        flange = find_frame(plant, arm, spec.flange, "flange")
        mount = find_frame(plant, held, gripper.mount.frame, "gripper.mount.frame")
        plant.WeldFrames(flange, mount, pose_of(gripper.mount))
        return arm, held

    def check(self) -> None:
        """Raise IctampError unless the model and the file fit together. `robots.checking` finds more."""
        for number, joint in enumerate(self._bare.arm_joints):
            if not isinstance(joint, RevoluteJoint):
                problem, field = "expected a joint that turns, got {value}, which slides", f"joints[{number}]"
                raise IctampError(Code.WRONG_TYPE, problem, field=field, value=joint.name())
        for number, (position, low, high) in enumerate(zip(self.spec.home, self.lower, self.upper, strict=True)):
            check_range(f"home[{number}]", position, low, high, " rad")
        for limit in (self.velocity, self.acceleration, self.jerk, self.effort, self.gripper):
            assert limit is not None  # each raises an error of its own

    def _actuate(self, plant: MultibodyPlant, instances: tuple[ModelInstanceIndex, ...], joints: list[Joint]) -> None:
        actuators = map(plant.get_joint_actuator, plant.GetJointActuatorIndices())
        found = {each.joint().index(): each for each in actuators if each.model_instance() in instances}
        if list(found) == [joint.index() for joint in joints] and not self.spec.effort:
            return
        limits = {index: actuator.effort_limit() for index, actuator in found.items()}
        for actuator in found.values():
            plant.RemoveJointActuator(actuator)
        unused, given = read_efforts(self.model), dict(zip(self.joints, self.spec.effort, strict=False))
        for number, joint in enumerate(joints):
            name, limit = joint.name(), limits.get(joint.index(), np.inf)
            if number < len(self.joints):
                limit = given.get(name, limits.get(joint.index(), unused.get(name, np.inf)))
            plant.AddJointActuator(f"{name}_actuator", joint, limit)

    def _add_shapes(self, bodies: RobotBodies, *, points: bool) -> None:
        """Add the shapes of the robot's file, and pads to fingers whose models bring none."""
        plant, gripper = bodies.plant, self.spec.gripper
        for shapes, instance, field in (
            (self.spec.collision, bodies.instances[0], "collision"),
            (gripper.collision, bodies.instances[-1], "gripper.collision"),
        ):
            for name, added in shapes.items():
                with in_file(find_file(self.name)):
                    body = find_frame(plant, instance, name, f"{field}.{name}").body()
                add_shapes(plant, body, added)
        file = self.gripper_model or self.model
        for face, finger in zip(bodies.faces, bodies.fingers, strict=True):
            if finger.name() in gripper.collision or not brings_pad(file, finger.name()):
                add_pads(plant, face, gripper.pads, points=points)

    def filter(self, bodies: RobotBodies, scene_graph: SceneGraph) -> None:
        """Stop testing pairs of links that always touch, in the plant of the bodies, which is finalized."""
        if not self.touching and self.gripper.shares is not None:
            return
        plant, names = bodies.plant, bodies.names
        manager = scene_graph.collision_filter_manager()
        for number, pair in enumerate(self.touching):
            with in_file(find_file(self.name)):
                for name in pair:
                    if name not in names:
                        problem, field = "there is no body {value}", f"touching[{number}]"
                        raise IctampError(Code.UNKNOWN_CHOICE, problem, field=field, value=name, choices=names)
            first, second = (GeometrySet(plant.GetCollisionGeometriesForBody(names[name])) for name in pair)
            manager.Apply(CollisionFilterDeclaration().ExcludeBetween(first, second))
        if self.gripper.shares is None:  # the bars of a linkage overlap
            moving = [shape for body in bodies.moving for shape in plant.GetCollisionGeometriesForBody(body)]
            base = plant.GetCollisionGeometriesForBody(bodies.hand)
            manager.Apply(CollisionFilterDeclaration().ExcludeWithin(GeometrySet([*moving, *base])))

    @cached_property
    def touching(self) -> tuple[tuple[str, str], ...]:
        """Pairs of links that are not tested for contact with each other: those of the file, or found by sampling.

        Their names are those of `bodies.name_links`.
        """
        return find_touching(self) if self.spec.touching is None else self.spec.touching


def _align(axis: FloatArray, other: FloatArray) -> float:
    """Return 1 or -1 if an axis is along another one or against it, else 0."""
    cosine = float(axis @ other)
    return float(np.sign(cosine)) if abs(cosine) > 1 - _ALIGNED else 0.0


def _freeze(values: object) -> FloatArray:
    array = np.array(values, dtype=np.float64)
    array.setflags(write=False)
    return array


@lru_cache(maxsize=32)
def _inverse_kinematics(robot: Robot, kind: KinematicsKind, starts: int, field: str) -> InverseKinematics:
    return create_inverse_kinematics(kind, robot.chain, starts, field)


def find_robot(name: str = DEFAULT) -> Robot:
    """Return a robot that ships, or that of a file. It is built once, and again when one of its files has changed.

    Raises:
        IctampError: There is no such robot, or its file or models are not valid.
    """
    spec, file = read_robot(name), find_file(name)
    with in_file(file):
        models = _find_models(spec, file.parent.absolute())
        return _build(name, spec, models, tuple(each and stamp_of(each) for each in models))


@lru_cache(maxsize=32)
def _find_models(spec: RobotSpec, folder: Path) -> tuple[Path, Path | None]:
    """Return the files of the models of a robot file in a folder; see `Robot`."""
    gripper = spec.gripper.model
    return find_model(spec.model, folder, "model"), find_model(gripper, folder, "gripper.model") if gripper else None


@lru_cache(maxsize=32)
def _build(name: str, spec: RobotSpec, models: tuple[Path, Path | None], _stamps: Hashable) -> Robot:
    robot = Robot(name, spec, *models)
    robot.check()
    return robot
