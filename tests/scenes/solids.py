"""Boxes, rack and arm of a packing scene as Drake's solids, and the support of each box."""

import itertools
from typing import Any

import numpy as np
import pytest
from pydrake.common.eigen_geometry import Quaternion
from pydrake.geometry import Box, Cylinder, GeometryInstance, ProximityProperties, SceneGraph, Shape
from pydrake.math import RigidTransform

from ictamp_drake.scenes.spec import SUPPORT_SIZES, BoxSpec, SceneSpec

TOUCHING = 1e-5
ARM_RADIUS = 0.16
FLOORS = {0.0: "table", SUPPORT_SIZES["rack"][2]: "rack"}


def height(box: BoxSpec) -> float:
    """Vertical extent of a box [m]."""
    return float(np.abs(_transform(box.X_WO).rotation().matrix()[2]) @ box.size)


def _transform(pose: Any) -> RigidTransform:
    return RigidTransform(Quaternion(pose[:4]), pose[4:])


def distances(spec: SceneSpec) -> dict[frozenset[str], float]:
    """Signed distances between boxes, rack (as a solid) and the arm's base (as a column), by pairs of names [m]."""
    graph = SceneGraph()
    source = graph.RegisterSource("scene")
    upright: tuple[float, ...] = (1, 0, 0, 0)
    x, y, z = SUPPORT_SIZES["rack"]
    solids: dict[str, tuple[Shape, RigidTransform]] = {
        "rack": (Box(y, x, z), _transform(np.array([*upright, 0.44, -0.33, z / 2]))),
        "arm": (Cylinder(ARM_RADIUS, 2.0), _transform(np.array([*upright, 0, 0, 1]))),
        **{name: (Box(*box.size), _transform(box.X_WO)) for name, box in spec.boxes.items()},
    }
    names = {}
    for name, (shape, X_WG) in solids.items():
        instance = GeometryInstance(X_WG, shape, name)
        instance.set_proximity_properties(ProximityProperties())
        names[graph.RegisterAnchoredGeometry(source, instance)] = name
    context = graph.CreateDefaultContext()
    query: Any = graph.get_query_output_port().Eval(context)
    return {
        frozenset((names[a], names[b])): query.ComputeSignedDistancePairClosestPoints(a, b).distance
        for a, b in itertools.combinations(names, 2)
    }


def carriers(spec: SceneSpec) -> dict[str, str]:
    """Support of each box: the box whose top face touches its bottom face below its center, or a scene's support."""
    found = {}
    for name, box in spec.boxes.items():
        bottom = box.position[2] - height(box) / 2
        below = [support for floor, support in FLOORS.items() if abs(bottom - floor) < 1e-9]
        below += [
            other
            for other, it in spec.boxes.items()
            if abs(it.position[2] + height(it) / 2 - bottom) < 1e-9
            and np.hypot(*np.subtract(it.position, box.position)[:2]) < 0.01
        ]
        assert len(below) == 1, f"{name} floats"
        found[name] = below[0]
    return found


def foot(name: str, carried_by: dict[str, str]) -> str:
    """The lowest box of the stack that a box is part of."""
    return name if carried_by[name] in FLOORS.values() else foot(carried_by[name], carried_by)


def check_clearances(spec: SceneSpec) -> None:
    """Assert that boxes touch their supports and keep clear of everything else."""
    carried_by = carriers(spec)
    for pair, distance in distances(spec).items():
        boxes = sorted(pair - {"rack", "arm"})
        if len(boxes) == 2:
            first, second = boxes
            if carried_by[first] == second or carried_by[second] == first:
                assert distance == pytest.approx(0, abs=TOUCHING)
            elif foot(first, carried_by) == foot(second, carried_by):
                assert distance > 0
            else:
                assert distance >= 0.01 - TOUCHING
        elif "arm" in pair and boxes:
            assert distance > 0
        elif boxes and carried_by[foot(boxes[0], carried_by)] == "rack":
            assert distance >= -TOUCHING
        elif boxes:
            assert distance >= 0.02 - TOUCHING
