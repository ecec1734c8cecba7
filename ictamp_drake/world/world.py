"""The scene in Drake without physics: c in a Context, frames and contacts."""

from typing import NamedTuple

import numpy as np
from pydrake.math import RigidTransform
from pydrake.systems.framework import Context

from ictamp_drake.core.types import Configuration, FloatArray, GripperCommand
from ictamp_drake.models.constants import HOME, MAX_GRIP_FORCE
from ictamp_drake.models.grip import LEAST_FORCE, needed_force
from ictamp_drake.models.hand import MAX_OPENING
from ictamp_drake.models.kinematics import forward
from ictamp_drake.scenes.spec import SceneSpec, SupportSpec
from ictamp_drake.world.build import SKIN, build_kinematic
from ictamp_drake.world.frames import Upright, upright_frame
from ictamp_drake.world.poses import to_transform

ARM, FINGERS = "the arm", ("the left finger", "the right finger")
"""Names of the robot's parts. Names of boxes and supports have no spaces, so they cannot clash."""
ROBOT = frozenset({ARM, *FINGERS})
SQUARE = 1e-4
"""Maximum difference between the sides of a footprint that counts as square [m]."""


class Touch(NamedTuple):
    """Two bodies whose surfaces are near each other.

    Attributes:
        a, b: Names of the bodies.
        distance: Distance between the surfaces, negative when they overlap [m].
        normal: Unit vector from b to a in W, shape (3,).
    """

    a: str
    b: str
    distance: float
    normal: FloatArray


class _Top(NamedTuple):
    """Top face of a support, or a region or pose on it, which never moves.

    Attributes:
        X_WT: Frame in its center, z up.
        size: Side lengths along T's x and y, shape (2,) [m].
    """

    X_WT: RigidTransform
    size: FloatArray

    @classmethod
    def of_support(cls, support: SupportSpec) -> "_Top":
        size = np.array(support.size[:2])
        size.setflags(write=False)
        return cls(to_transform(support.X_WT), size)


class World:
    """Scene for queries. It holds one Drake context and is not thread-safe."""

    def __init__(self, spec: SceneSpec) -> None:
        self.spec = spec
        self.diagram, self.bodies = build_kinematic(spec)
        self.plant = self.diagram.plant()
        self.context = self.diagram.CreateDefaultContext()
        self._plant_context = self.plant.GetMyMutableContextFromRoot(self.context)
        self._query_port = self.diagram.scene_graph().get_query_output_port()
        self._names = self._name_geometries()
        self.sizes = {name: np.array(box.size) for name, box in spec.boxes.items()}
        self._tops = {name: _Top.of_support(support) for name, support in spec.supports.items()}
        for name, area in spec.areas.items():
            X_WT = self._tops[area.on].X_WT @ to_transform(area.X_TR)
            self._tops[name] = _Top(X_WT, np.array(area.size))
        self._areas = {name: [area for area in spec.areas if spec.areas[area].on == name] for name in spec.supports}

    def _name_geometries(self) -> dict[object, str]:
        arm = self.plant.GetBodyIndices(self.bodies.arm)
        named = [(ARM, self.plant.get_body(index)) for index in arm]
        named += zip(FINGERS, self.bodies.fingers, strict=True)
        named += [*self.bodies.boxes.items(), *self.bodies.supports.items()]
        geometries = self.plant.GetCollisionGeometriesForBody
        return {geometry: name for name, body in named for geometry in geometries(body)}

    def initial_configuration(self) -> Configuration:
        """Return arm, hand and boxes as specified. By default the arm is at home with an open hand."""
        start = self.spec.start
        arm = np.array(start.joints) if start.joints else HOME
        poses = {name: box.X_WO for name, box in self.spec.boxes.items()}
        if not start.held:
            return Configuration(arm, np.full(2, MAX_OPENING / 2), poses)
        gripper, fingers = self._grip(arm, start.held, poses[start.held])
        return Configuration(arm, fingers, poses, start.held, gripper)

    def _grip(self, arm: FloatArray, box: str, X_WO: FloatArray) -> tuple[GripperCommand, FloatArray]:
        """Return the command that holds the box, and the finger positions that just touch it, shape (2,) [m]."""
        X_WG = to_transform(self.spec.arm.X_WB) @ RigidTransform(forward(arm[None])[0])
        X_GO = X_WG.inverse() @ to_transform(X_WO)
        half = float(np.abs(X_GO.rotation().matrix()[1]) @ self.sizes[box]) / 2
        offset, middle, _ = X_GO.translation()  # the left finger is on the side of positive y
        spec = self.spec.boxes[box]
        force = float(np.clip(needed_force(spec.mass, spec.friction, offset), LEAST_FORCE, MAX_GRIP_FORCE))
        return GripperCommand(2 * half, force), np.clip([half + middle, half - middle], 0.0, MAX_OPENING / 2)

    def set_configuration(self, c: Configuration) -> None:
        """Set the context to c."""
        self.plant.SetPositions(self._plant_context, self.bodies.arm, np.append(c.q, c.fingers))
        for name, body in self.bodies.boxes.items():
            self.plant.SetPositions(self._plant_context, body.model_instance(), c.poses[name])

    def touches(self, c: Configuration, tolerance: float) -> list[Touch]:
        """Return all pairs of boxes, supports, fingers and arm at most `tolerance` [m] apart in c."""
        self.set_configuration(c)
        return self.touches_in(self.context, tolerance)

    def touches_in(self, context: Context, tolerance: float) -> list[Touch]:
        """`touches` in another context of the diagram."""
        query = self._query_port.Eval(self.diagram.scene_graph().GetMyContextFromRoot(context))
        found = []
        for pair in query.ComputeSignedDistancePairwiseClosestPoints(tolerance + 2 * SKIN):
            a, b = self._names[pair.id_A], self._names[pair.id_B]
            distance = pair.distance - SKIN * ((a in self.sizes) + (b in self.sizes))
            if distance <= tolerance:
                found.append(Touch(a, b, distance, pair.nhat_BA_W))
        return found

    def upright_frame(self, c: Configuration, box: str) -> Upright:
        """Return the box as it lies in c."""
        return upright_frame(c.poses[box], self.sizes[box])

    def area_at(self, place: str, X_WU: RigidTransform, size: FloatArray, margin: float = 0.0) -> str:
        """Return the region or pose in which a box is, or else its support or the box below it.

        Args:
            place: Thing that the box rests on: a support, a region or pose on it, or a box.
            X_WU: Upright frame of the box.
            size: Side lengths along U's axes, shape (3,) [m]; they say which turns make no difference to the box.
            margin: Length by which regions grow on each side, and tolerances of position with them [m]; negative to
                shrink them.
        """
        support = self.spec.support_of(place)
        for name in self._areas.get(support, ()):
            if self._is_in_area(name, X_WU, size, margin):
                return name
        return support

    def _is_in_area(self, name: str, X_WU: RigidTransform, size: FloatArray, margin: float) -> bool:
        X_TU = self._tops[name].X_WT.inverse() @ X_WU
        x, y, _ = X_TU.translation()
        if name in self.spec.regions:
            return bool(np.all(np.abs([x, y]) <= self._tops[name].size / 2 + margin))
        distance, angle = self.spec.poses[name].tolerance
        turn = np.pi / 2 if np.ptp(size[:2]) < SQUARE else np.pi
        yaw = np.arctan2(*X_TU.rotation().matrix()[[1, 0], 0])
        deviation = abs((yaw + turn / 2) % turn - turn / 2)
        return bool(np.hypot(x, y) <= distance + margin and deviation <= np.deg2rad(angle))

    def X_WT(self, c: Configuration, receptacle: str) -> RigidTransform:
        """Frame in the center of the top face of a support or box in c, or of a region or pose."""
        if receptacle in self._tops:
            return self._tops[receptacle].X_WT
        return self.upright_frame(c, receptacle).X_WT

    def top_size(self, c: Configuration, receptacle: str) -> FloatArray:
        """Side lengths of the top face along T's x and y, shape (2,) [m]."""
        if receptacle in self._tops:
            return self._tops[receptacle].size
        return self.upright_frame(c, receptacle).size[:2]
