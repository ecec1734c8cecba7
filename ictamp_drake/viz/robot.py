"""A robot at home in Meshcat, with the frames of its file."""

from contextlib import suppress
from time import sleep

import numpy as np
from pydrake.geometry import Meshcat, MeshcatVisualizer, MeshcatVisualizerParams, Role
from pydrake.math import RigidTransform
from pydrake.planning import RobotDiagramBuilder
from pydrake.visualization import AddFrameTriadIllustration

from ictamp_drake.core.errors import IctampError
from ictamp_drake.robots.bodies import find_frame
from ictamp_drake.robots.robot import Robot
from ictamp_drake.viz.stage import PREFIX, start_meshcat

LENGTHS = {"base": 0.2, "flange": 0.1, "grasp": 0.08, "first pad": 0.03, "second pad": 0.03}
"""Frames that are drawn, with the lengths of their axes [m]."""


def open_robot(robot: Robot, port: int | None = None) -> Meshcat:
    """Show a robot at home, with an open hand and its frames, and return the server.

    Raises:
        IctampError: The port cannot be used.
    """
    builder = RobotDiagramBuilder(time_step=0.0)
    plant, scene_graph = builder.plant(), builder.scene_graph()
    bodies = robot.add_to(plant, RigidTransform(), "visible")
    flange = find_frame(plant, bodies.instances[0], robot.spec.flange, "flange")
    frames = (bodies.base, flange, bodies.grasp, *bodies.faces)
    for frame, (name, length) in zip(frames, LENGTHS.items(), strict=True):
        AddFrameTriadIllustration(
            scene_graph=scene_graph, plant=plant, frame=frame, name=name, length=length, radius=length / 40
        )
    plant.Finalize()
    meshcat = start_meshcat(port)
    parameters = MeshcatVisualizerParams(role=Role.kIllustration, prefix=PREFIX)
    MeshcatVisualizer.AddToBuilder(builder.builder(), scene_graph, meshcat, parameters)
    diagram = builder.Build()
    root = diagram.CreateDefaultContext()
    context = plant.GetMyMutableContextFromRoot(root)
    places = np.zeros(plant.num_positions())
    places[bodies.arm] = robot.home
    with suppress(IctampError):  # a gripper that cannot be measured is drawn with its joints at zero
        places[bodies.gripper] = robot.gripper.positions(robot.gripper.opening)
    plant.SetPositions(context, places)
    diagram.ForcedPublish(root)
    points = np.array([frame.CalcPoseInWorld(context).translation() for frame in frames])
    middle = (points.min(axis=0) + points.max(axis=0)) / 2
    distance = 1.5 * float(np.ptp(points, axis=0).max()) + 0.5
    meshcat.SetCameraPose(middle + distance * np.array([0.6, 0.7, 0.4]), middle)
    return meshcat


def show_robot(robot: Robot) -> None:
    """Show a robot, print the address of the page, and wait for Ctrl-C."""
    meshcat = open_robot(robot)
    print(f"Robot at {meshcat.web_url()}, until Ctrl-C. Axes: x red, y green, z blue.", flush=True)
    print(f"Frames, from long axes to short ones: {', '.join(LENGTHS)}", flush=True)
    try:
        while True:
            sleep(0.1)
    except KeyboardInterrupt:
        print()
