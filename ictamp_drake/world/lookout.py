"""Events that physics must notice along the way: contact with sleeping boxes, and boxes that overhang a rim."""

from collections.abc import Collection
from itertools import product

import numpy as np
from pydrake.geometry import CollisionFilterDeclaration, GeometrySet
from pydrake.systems.framework import Context

from ictamp_drake.core.types import FloatArray
from ictamp_drake.models.contact import CONTACT_RADIUS
from ictamp_drake.world.world import Touch, World

_POINTS = np.array(list(product((-1.0, 0.0, 1.0), repeat=3)))
"""Corners and centers of the edges and faces of a box, as multiples of its half sides."""
_LEVEL = 0.003
"""Largest height difference at which a point counts as level with a top face [m]."""


class Lookout:
    """Watches a scene in its own contexts and leaves those of others untouched."""

    def __init__(self, world: World) -> None:
        self._world = world
        self._all = world.diagram.CreateDefaultContext()
        self._passing = world.diagram.CreateDefaultContext()
        scene_graph, shapes = world.diagram.scene_graph(), world.plant.GetCollisionGeometriesForBody
        boxes, supports = (
            GeometrySet([shape for body in bodies.values() for shape in shapes(body)])
            for bodies in (world.bodies.boxes, world.bodies.supports)
        )
        scene_graph.collision_filter_manager(scene_graph.GetMyMutableContextFromRoot(self._passing)).Apply(
            CollisionFilterDeclaration().ExcludeBetween(boxes, supports)
        )
        c = world.initial_configuration()
        self._tops = [(world.X_WT(c, name).inverse(), world.top_size(c, name) / 2) for name in world.spec.supports]

    def touches(self, q: FloatArray, tolerance: float) -> list[Touch]:
        """Return all pairs at most `tolerance` [m] apart at the positions q, in the order of the plant."""
        return self._world.touches_in(self._evaluate_at(q, self._all), tolerance)

    def list_passing(self, q: FloatArray) -> list[Touch]:
        """Return all contacts at the positions q, except those of boxes with supports."""
        return self._world.touches_in(self._evaluate_at(q, self._passing), 0.0)

    def overhang(self, q: FloatArray, boxes: Collection[str]) -> bool:
        """Whether one of these boxes stands on a support and reaches beyond its rim at the positions q."""
        context = self._evaluate_at(q, self._passing)
        plant, bodies = self._world.plant, self._world.bodies.boxes
        plant_context = plant.GetMyContextFromRoot(context)
        for name in boxes:
            X_WO = plant.EvalBodyPoseInWorld(plant_context, bodies[name])
            p_WP = X_WO.multiply((_POINTS * (self._world.sizes[name] / 2 - CONTACT_RADIUS)).T)
            for X_TW, half in self._tops:
                x, y, z = X_TW.multiply(p_WP)
                level = np.abs(z - CONTACT_RADIUS) < _LEVEL
                inside = (np.abs(x) <= half[0]) & (np.abs(y) <= half[1])
                if np.any(level & inside) and np.any(level & ~inside):
                    return True
        return False

    def _evaluate_at(self, q: FloatArray, context: Context) -> Context:
        plant = self._world.plant
        plant.SetPositions(plant.GetMyMutableContextFromRoot(context), q)
        return context
