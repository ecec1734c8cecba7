"""A robot at home in Meshcat, with the frames of its file."""

from contextlib import suppress
from time import sleep

import numpy as np
from pydrake.geometry import Cylinder, Meshcat, MeshcatVisualizer, MeshcatVisualizerParams, Rgba, Role
from pydrake.math import RigidTransform, RotationMatrix
from pydrake.planning import RobotDiagramBuilder

from ictamp_drake.core.errors import IctampError
from ictamp_drake.robots.bodies import find_frame
from ictamp_drake.robots.robot import Robot
from ictamp_drake.viz.stage import DIRECTION, FIELD_OF_VIEW, PREFIX, start_meshcat

LENGTHS = {"base": 0.25, "flange": 0.15, "grasp frame": 0.1, "first pad": 0.03, "second pad": 0.03}
"""Frames that are drawn, with the lengths of their axes [m]."""
COLORS = (Rgba(0.9, 0.1, 0.1), Rgba(0.1, 0.7, 0.1), Rgba(0.1, 0.2, 0.9))
"""Colors of the axes x, y, z."""


def open_robot(robot: Robot, port: int | None = None) -> Meshcat:
    """Show a robot at home, with an open hand and its frames, and return the server.

    Raises:
        IctampError: The port cannot be used.
    """
    builder = RobotDiagramBuilder(time_step=0.0)
    plant = builder.plant()
    bodies = robot.add_alone(plant, "visible")
    flange = find_frame(plant, bodies.instances[0], robot.spec.flange, "flange")
    meshcat = start_meshcat(port)
    parameters = MeshcatVisualizerParams(role=Role.kIllustration, prefix=PREFIX)
    MeshcatVisualizer.AddToBuilder(builder.builder(), builder.scene_graph(), meshcat, parameters)
    diagram = builder.Build()
    root = diagram.CreateDefaultContext()
    context = plant.GetMyMutableContextFromRoot(root)
    places = np.zeros(plant.num_positions())
    places[bodies.arm] = robot.home
    with suppress(IctampError):  # a gripper that cannot be measured is drawn with its joints at zero
        places[bodies.gripper] = robot.gripper.positions(robot.gripper.opening)
    plant.SetPositions(context, places)
    diagram.ForcedPublish(root)
    frames = (bodies.base, flange, bodies.grasp, *bodies.faces)
    for frame, (name, length) in zip(frames, LENGTHS.items(), strict=True):
        _draw_frame(meshcat, f"frames/{name}", frame.CalcPoseInWorld(context), length)
    points = np.array([link.EvalPoseInWorld(context).translation() for link in bodies.links])
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    radius = float(np.linalg.norm(np.ptp(points, axis=0))) / 2 + LENGTHS["base"] / 2
    meshcat.SetCameraPose(middle + DIRECTION * radius / np.sin(np.deg2rad(FIELD_OF_VIEW / 2)), middle)
    return meshcat


def _draw_frame(meshcat: Meshcat, path: str, X_WF: RigidTransform, length: float) -> None:
    """Draw the axes of a frame as thin cylinders."""
    turns = (RotationMatrix.MakeYRotation(np.pi / 2), RotationMatrix.MakeXRotation(-np.pi / 2), RotationMatrix())
    for axis, turn, color in zip("xyz", turns, COLORS, strict=True):
        meshcat.SetObject(f"{path}/{axis}", Cylinder(length / 50 + 0.0005, length), color)
        meshcat.SetTransform(f"{path}/{axis}", X_WF @ RigidTransform(turn, turn @ np.array([0.0, 0.0, length / 2])))


def show_robot(robot: Robot) -> None:
    """Show a robot, print the address of the page, and wait for Ctrl-C."""
    meshcat = open_robot(robot)
    print(f"Robot at {meshcat.web_url()}, until Ctrl-C. Axes: x red, y green, z blue.", flush=True)
    print(f"Frames, from long axes to short ones: {', '.join(LENGTHS)}", flush=True)
    with suppress(KeyboardInterrupt):
        while True:
            sleep(0.1)
