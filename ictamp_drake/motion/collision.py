"""Collision queries for the arm and the held box in a scene.

The queries go to SceneGraph itself: `HasCollisions` ends at the first contact and takes a fraction of the time of a
collision checker that measures distances.
"""

from collections.abc import Collection
from typing import NamedTuple

import numpy as np
from pydrake.geometry import (
    Box,
    CollisionFilterDeclaration,
    FrameId,
    GeometryId,
    GeometryInstance,
    GeometrySet,
    ProximityProperties,
    QueryObject,
    SceneGraphInspector,
)
from pydrake.math import RigidTransform
from pydrake.multibody.tree import JacobianWrtVariable, RigidBody

from ictamp_drake.core.types import Configuration, FloatArray
from ictamp_drake.robots.bodies import IntArray
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World

_AWAY = RigidTransform([0.0, 0.0, -100.0])


class Contact(NamedTuple):
    """Names of two things that touch, and their distance [m], which is negative where they overlap."""

    moving: str
    other: str
    distance: float

    def __str__(self) -> str:
        return f"{self.moving} would touch {self.other}"


class CollisionScene:
    """Collisions of the arm at any q among the things of a configuration c, whatever c's own q is.

    The boxes stand where c has them, the held one moves with the hand, and the fingers are as far open as in c. Contact
    among the things that stand still does not count.

    Holds two Drake contexts that keep the last c, so that another query about the same c is quick.

    Args:
        world: The scene.
        held_shrinkage: Length by which the held box is smaller on every side, so that resting contact is not a
            collision [m].
        padding: Largest padding for which `is_free` is quick [m].
        without: Links of the robot that are left out of all collisions.
    """

    def __init__(
        self, world: World, held_shrinkage: float = 0.001, padding: float = 0.005, without: Collection[RigidBody] = ()
    ) -> None:
        inspector = world.diagram.scene_graph().model_inspector()
        self._still = frozenset(
            geometry
            for body in (*world.bodies.boxes.values(), *world.bodies.supports.values())
            for geometry in world.plant.GetCollisionGeometriesForBody(body)
            if inspector.GetProximityProperties(geometry) is not None
        )
        self._exact = _Shapes(world, self._still, held_shrinkage, 0.0, without)
        self._padded = _Shapes(world, self._still, held_shrinkage, padding, without) if padding else self._exact
        self._padding = padding if self._padded.are_grown else 0.0

    def is_free(self, c: Configuration, q: FloatArray, padding: float = 0.0) -> bool:
        """Whether the arm at q, shape (n,) [rad], touches neither the scene nor itself.

        Args:
            c: Configuration of everything else.
            q: Joint positions.
            padding: Distance that arm and held box keep from what stands still [m]. 0 is much quicker.
        """
        if 0 < padding <= self._padding and not self._padded.query(c, q).HasCollisions():
            return True
        return not self._exact.query(c, q).HasCollisions() and (padding <= 0 or not self.contacts(c, q, padding))

    def are_free(self, c: Configuration, qs: FloatArray, padding: float = 0.0) -> bool:
        """Whether all of qs, shape (m, n), are free. Checks distant ones first and stops at the first contact."""
        return all(self.is_free(c, qs[i], padding) for i in sorted(range(len(qs)), key=lambda i: -(i & -i)))

    def contacts(self, c: Configuration, q: FloatArray, padding: float = 0.0) -> list[Contact]:
        """Contacts at q, shape (n,) [rad]: pairs that overlap or are nearer than the padding, nearest first."""
        found = []
        for pair in self._exact.query(c, q).ComputeSignedDistancePairwiseClosestPoints(padding):
            still = {pair.id_A, pair.id_B} & self._still
            if still or pair.distance < 0:  # parts of the arm may come near each other
                moving, other = (pair.id_B, pair.id_A) if pair.id_A in still else (pair.id_A, pair.id_B)
                found.append(Contact(self._exact.name(moving), self._exact.name(other), pair.distance))
        return sorted(found, key=lambda contact: contact.distance)

    def first_contact(self, c: Configuration, qs: FloatArray, padding: float = 0.0) -> Contact | None:
        """First contact along qs, shape (m, n), or None."""
        colliding = (q for q in qs if not self.is_free(c, q, padding))
        return next((contacts[0] for q in colliding if (contacts := self.contacts(c, q, padding))), None)

    def clearance(self, c: Configuration, q: FloatArray, limit: float) -> float:
        """Distance to what stands still, at most `limit`; negative in collision [m]."""
        return min((contact.distance for contact in self.contacts(c, q, limit)), default=limit)

    def clearance_gradients(self, c: Configuration, q: FloatArray, limit: float) -> list[tuple[float, FloatArray]]:
        """Distances below the limit [m] between moving and still things, each with its gradient by q, shape (n,)."""
        query = self._exact.query(c, q)
        found = []
        for pair in query.ComputeSignedDistancePairwiseClosestPoints(limit):
            if not {pair.id_A, pair.id_B} & self._still:
                continue
            still_B = pair.id_B in self._still
            moving, p_GC = (pair.id_A, pair.p_ACa) if still_B else (pair.id_B, pair.p_BCb)
            away = pair.nhat_BA_W if still_B else -pair.nhat_BA_W
            found.append((pair.distance, away @ self._exact.jacobian(moving, p_GC)))
        return found


def _as_slice(places: IntArray) -> slice | IntArray:
    """Return places one after the other as a slice, with which an array is set quicker."""
    first, last = int(places[0]), int(places[-1])
    return slice(first, last + 1) if np.array_equal(places, np.arange(first, last + 1)) else places


class _Shapes:
    """Shapes of a scene in a context of their own. Those that stand still are grown by some length on every side.

    A grown shape contains all points nearer to the shape than this length, and some more.
    """

    def __init__(
        self,
        world: World,
        still: frozenset[GeometryId],
        held_shrinkage: float,
        grown: float,
        without: Collection[RigidBody],
    ) -> None:
        self._shrinkage = held_shrinkage
        self._world = world
        self._plant = world.plant
        self._scene_graph = world.diagram.scene_graph()
        self._source = self._plant.get_source_id()
        self._root = world.diagram.CreateDefaultContext()
        self._context = self._plant.GetMyMutableContextFromRoot(self._root)
        self._scene_context = self._scene_graph.GetMyMutableContextFromRoot(self._root)
        self._port = self._scene_graph.get_query_output_port()
        self._held: tuple[str, GeometryId] | None = None
        self._c: Configuration | None = None
        self._q = self._plant.GetPositions(self._context).copy()
        robot = world.bodies.robot
        self._arm, self._velocities = _as_slice(robot.arm), robot.velocities[: len(robot.arm)]
        self._leave_only_collision_shapes([shape for body in without for shape in self._shapes(body)])
        self.are_grown = grown > 0 and all(self._grow(geometry, grown) for geometry in still)
        self._filters = self._scene_graph.collision_filter_manager(self._scene_context)
        self._filter(still)

    def _filter(self, still: frozenset[GeometryId]) -> None:
        """Restore the filters that changed shapes have lost, also those between bodies welded to the world."""
        welded = self._plant.GetBodiesWeldedTo(self._plant.world_body())
        declaration = CollisionFilterDeclaration()
        declaration.ExcludeWithin(GeometrySet(list(still)))
        declaration.ExcludeWithin(GeometrySet([self._frame(body) for body in welded]))
        self._filters.Apply(declaration)

    def _shapes(self, body: RigidBody) -> list[GeometryId]:
        return self._plant.GetCollisionGeometriesForBody(body)

    def _leave_only_collision_shapes(self, without: Collection[GeometryId]) -> None:
        """Remove all other shapes, which every query would move too, and those in `without`."""
        inspector = self._inspector()
        for geometry in inspector.GetAllGeometryIds():
            if inspector.GetProximityProperties(geometry) is None or geometry in without:
                self._scene_graph.RemoveGeometry(self._scene_context, self._source, geometry)

    def _grow(self, geometry: GeometryId, length: float) -> bool:
        """Grow the shape and return True, or return False if it is not a box."""
        shape = self._inspector().GetShape(geometry)
        if not isinstance(shape, Box):
            return False
        self._scene_graph.ChangeShape(self._scene_context, self._source, geometry, Box(shape.size() + 2 * length))
        return True

    def _inspector(self) -> SceneGraphInspector:
        return self._port.Eval(self._scene_context).inspector()

    def _enter(self, c: Configuration) -> None:
        """Put the boxes and fingers where c has them, and the held box into the hand."""
        bodies, robot = self._world.bodies, self._world.bodies.robot
        self._plant.SetPositions(self._context, bodies.positions(c))
        for name, body in bodies.boxes.items():
            X_WO = _AWAY if name == c.held else to_transform(c.poses[name])
            self._plant.SetFloatingBaseBodyPoseInWorldFrame(self._context, body, X_WO)
        self._detach()
        if c.held is not None:
            X_WH = self._plant.EvalBodyPoseInWorld(self._context, robot.hand)
            self._attach(c.held, X_WH.inverse() @ to_transform(c.poses[c.held]))
        self._q = self._plant.GetPositions(self._context).copy()
        self._c = c

    def _detach(self) -> None:
        if self._held is not None:
            self._scene_graph.RemoveGeometry(self._scene_context, self._source, self._held[1])
            self._held = None

    def _attach(self, name: str, X_HO: RigidTransform) -> None:
        box = GeometryInstance(X_HO, Box(self._world.sizes[name] - 2 * self._shrinkage), f"held_{name}")
        box.set_proximity_properties(ProximityProperties())
        robot = self._world.bodies.robot
        hand = self._frame(robot.hand)
        geometry = self._scene_graph.RegisterGeometry(self._scene_context, self._source, hand, box)
        fingers = GeometrySet([self._frame(body) for body in robot.fingers])
        self._filters.Apply(CollisionFilterDeclaration().ExcludeBetween(GeometrySet(geometry), fingers))
        self._held = name, geometry

    def _frame(self, body: RigidBody) -> FrameId:
        return self._plant.GetBodyFrameIdOrThrow(body.index())

    def query(self, c: Configuration, q: FloatArray) -> QueryObject:
        """Query object for c with the arm at q, shape (n,) [rad]; valid until the next call."""
        if c is not self._c and c != self._c:
            self._enter(c)
        self._q[self._arm] = q
        self._plant.SetPositions(self._context, self._q)
        return self._port.Eval(self._scene_context)

    def jacobian(self, geometry: GeometryId, p_GC: FloatArray) -> FloatArray:
        """Jacobian of the velocity in W of a point of a moving geometry at the last query, shape (3, n)."""
        inspector = self._inspector()
        body = self._plant.GetBodyFromFrameId(inspector.GetFrameId(geometry))
        world = self._plant.world_frame()
        jacobian = self._plant.CalcJacobianTranslationalVelocity(
            self._context,
            JacobianWrtVariable.kV,
            body.body_frame(),
            inspector.GetPoseInFrame(geometry) @ p_GC,
            world,
            world,
        )
        return np.asarray(jacobian)[:, self._velocities]

    def name(self, geometry: GeometryId) -> str:
        """Name of the held box or of the body that the geometry belongs to."""
        if self._held is not None and geometry == self._held[1]:
            return self._held[0]
        body = self._plant.GetBodyFromFrameId(self._inspector().GetFrameId(geometry))
        assert body is not None
        return str(body.name())
