"""A scene on a Meshcat server of this machine, for the live view and the pages."""

import logging
from collections.abc import Iterator
from contextlib import contextmanager
from typing import Any

import numpy as np
from pydrake.geometry import (
    Meshcat,
    MeshcatParams,
    MeshcatVisualizer,
    MeshcatVisualizerParams,
    QueryObject,
    Role,
)
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.planning import RobotDiagramBuilder

from ictamp_drake.core.checks import check_range
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import Configuration, FloatArray
from ictamp_drake.scenes.spec import SceneSpec, SupportSpec
from ictamp_drake.world.build import add_scene
from ictamp_drake.world.poses import to_transform

PREFIX = "/scene"
"""Path of the scene in Meshcat's tree."""

PORTS = (1024, 65535)

FIELD_OF_VIEW = 38.0
"""Vertical field of view of the camera [deg]."""

DIRECTION = np.array([0.800, 0.400, 0.447])
"""Unit vector from the scene to the camera, in the arm's base frame B."""

ARM_HEIGHT = 0.6
"""Height of the part of the arm that should be in the picture [m]."""

BACKGROUND = ((0.95, 0.96, 0.98), (0.80, 0.84, 0.89))
"""Colors of the top and bottom of the background."""

_LAMP = "/Lights/SpotLight"

LOOK: tuple[tuple[str, str, Any], ...] = (
    ("/Grid", "visible", False),
    ("/Axes", "visible", False),
    ("/Background", "top_color", BACKGROUND[0]),
    ("/Background", "bottom_color", BACKGROUND[1]),
    (_LAMP, "visible", True),
    (f"{_LAMP}/<object>", "position", [1.2, 1.2, 2.4]),
    (f"{_LAMP}/<object>", "castShadow", True),
    (f"{_LAMP}/<object>", "shadow.normalBias", 0.02),
    (f"{_LAMP}/<object>", "shadow.radius", 4.0),
    (f"{_LAMP}/<object>", "intensity", 16.0),
    ("/Lights/PointLightNegativeX/<object>", "intensity", 3.0),
    ("/Lights/PointLightPositiveX/<object>", "intensity", 3.0),
    ("/Lights/AmbientLight/<object>", "intensity", 0.5),
    ("/Lights/FillLight/<object>", "intensity", 0.4),
)
"""Meshcat's settings of lights and background: path, property, value."""


def start_meshcat(port: int | None = None) -> Meshcat:
    """Start a server that only this machine can reach, at the port or else at the first free one from 7000 on.

    Raises:
        IctampError: The port is out of range or taken.
    """
    if port is not None and not PORTS[0] <= port <= PORTS[1]:
        check_range("port", port, *PORTS)
    try:
        with _quiet_drake():
            meshcat = Meshcat(MeshcatParams(host="localhost", port=port, show_stats_plot=False))
    except RuntimeError as error:
        problem = f"port {port or '7000 to 7999'} of localhost is taken"
        raise IctampError(Code.IN_USE, problem, field="port", value=port) from error
    for path, name, value in LOOK:
        meshcat.SetProperty(path, name, value)
    meshcat.SetCamera(Meshcat.PerspectiveCamera(fov=FIELD_OF_VIEW))
    return meshcat


@contextmanager
def _quiet_drake() -> Iterator[None]:
    """Suppress Drake's announcement of every server, even of those that nobody looks at."""
    logger = logging.getLogger("drake")
    level = logger.level
    logger.setLevel(logging.WARNING)
    try:
        yield
    finally:
        logger.setLevel(level)


def viewpoint(spec: SceneSpec) -> tuple[FloatArray, FloatArray]:
    """Camera position and target in W [m], shape (3,) each: from the arm's front left, far enough to see everything."""
    towards = RotationMatrix.MakeZRotation(np.deg2rad(spec.arm.yaw)) @ DIRECTION
    corners = [_corners(support) for support in spec.supports.values()]
    base = np.array(spec.arm.position)
    points = np.vstack([*corners, base, base + [0.0, 0.0, ARM_HEIGHT]])
    centre = (points.min(axis=0) + points.max(axis=0)) / 2
    radius = np.linalg.norm(np.ptp(points, axis=0)) / 2
    return centre + towards * radius / np.sin(np.deg2rad(FIELD_OF_VIEW / 2)), centre


def _corners(support: SupportSpec) -> FloatArray:
    """Corners of the top face in W [m], shape (4, 3)."""
    x, y = support.size[0] / 2, support.size[1] / 2
    X_WT = to_transform(support.X_WT)
    return np.array([X_WT @ np.array(p_TC) for p_TC in ((x, y, 0), (x, -y, 0), (-x, y, 0), (-x, -y, 0))])


class Stage:
    """The visible bodies of a scene (not their collision shapes), shown in Meshcat if one is given."""

    def __init__(self, spec: SceneSpec, meshcat: Meshcat | None = None) -> None:
        self._meshcat = meshcat
        builder = RobotDiagramBuilder(time_step=0.0)
        self._bodies = add_scene(builder.plant(), spec, "visible")
        builder.plant().Finalize()
        if meshcat is not None:
            parameters = MeshcatVisualizerParams(role=Role.kIllustration, prefix=PREFIX)
            MeshcatVisualizer.AddToBuilder(builder.builder(), builder.scene_graph(), meshcat, parameters)
            meshcat.SetCameraPose(*viewpoint(spec))
        self._diagram = builder.Build()
        self._context = self._diagram.CreateDefaultContext()
        self._plant = self._diagram.plant()
        self._plant_context = self._plant.GetMyMutableContextFromRoot(self._context)
        bodies = [*self._bodies.robot.links, *self._bodies.boxes.values()]
        self._moving = {f"{PREFIX}/{body.scoped_name()}".replace("::", "/"): body for body in bodies}

    @property
    def meshcat(self) -> Meshcat:
        """Meshcat that shows the bodies."""
        if self._meshcat is None:
            raise ValueError("this stage has no Meshcat")
        return self._meshcat

    def show(self, c: Configuration) -> None:
        """Move the bodies in Meshcat to their poses in c."""
        self._set(c)
        self._diagram.ForcedPublish(self._context)

    def poses(self, c: Configuration) -> dict[str, RigidTransform]:
        """Return X_WB in c of every movable body, by its path in Meshcat."""
        self._set(c)
        return {path: body.EvalPoseInWorld(self._plant_context) for path, body in self._moving.items()}

    def shapes(self, c: Configuration) -> QueryObject:
        """Return the drawn shapes at their poses in c; valid until the next call of any method."""
        self._set(c)
        scene_graph = self._diagram.scene_graph()
        query: QueryObject = scene_graph.get_query_output_port().Eval(scene_graph.GetMyContextFromRoot(self._context))
        return query

    def _set(self, c: Configuration) -> None:
        self._plant.SetPositions(self._plant_context, self._bodies.positions(c))
