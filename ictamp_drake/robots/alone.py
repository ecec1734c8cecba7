"""A robot alone in the world, for questions of contact with itself and with a table."""

from typing import TYPE_CHECKING

import numpy as np
from pydrake.geometry import Box
from pydrake.math import RigidTransform
from pydrake.planning import RobotDiagramBuilder

from ictamp_drake.core.types import FloatArray
from ictamp_drake.models.contact import BODY
from ictamp_drake.robots.bodies import RobotBodies, properties_of

if TYPE_CHECKING:
    from ictamp_drake.robots.robot import Robot

_TABLE = 3.0
"""Side of the table's top [m]."""


class Alone:
    """A robot with its base in the origin of the world.

    Attributes:
        bodies: Its bodies.

    Args:
        robot: Robot.
        height: Height of the top of a large table [m]; by default there is none.
        filtered: Whether links that always touch each other do not count.
    """

    def __init__(self, robot: "Robot", height: float | None = None, *, filtered: bool = True) -> None:
        builder = RobotDiagramBuilder(time_step=0.0)
        self._plant = plant = builder.plant()
        self.bodies: RobotBodies = robot.add_to(plant, RigidTransform(), "solid")
        if height is not None:
            X_WT = RigidTransform([0.0, 0.0, height - _TABLE / 2])
            shape = Box(_TABLE, _TABLE, _TABLE)
            plant.RegisterCollisionGeometry(plant.world_body(), X_WT, shape, "table", properties_of(BODY))
        plant.Finalize()
        names = {**self.bodies.names, "world": plant.world_body()}
        self._names = {body.index(): name for name, body in names.items()}
        if filtered:
            robot.filter(self.bodies, builder.scene_graph())
        self._diagram = builder.Build()
        self._root = self._diagram.CreateDefaultContext()
        self._context = plant.GetMyMutableContextFromRoot(self._root)
        scene_graph = self._diagram.scene_graph()
        self._scene_context = scene_graph.GetMyContextFromRoot(self._root)
        self._port = scene_graph.get_query_output_port()
        self._inspector = scene_graph.model_inspector()

    def is_free(self, q: FloatArray, fingers: FloatArray) -> bool:
        """Whether the robot touches nothing, joints of shapes (n,) and (m,) [rad or m]."""
        self._set(q, fingers)
        return not self._port.Eval(self._scene_context).HasCollisions()

    def contacts(self, q: FloatArray, fingers: FloatArray) -> list[tuple[str, str]]:
        """Names of the links that touch, joints of shapes (n,) and (m,) [rad or m]."""
        self._set(q, fingers)
        pairs = self._port.Eval(self._scene_context).ComputePointPairPenetration()
        names = ((self._name(pair.id_A), self._name(pair.id_B)) for pair in pairs)
        return sorted({(min(pair), max(pair)) for pair in names})

    def _name(self, geometry: object) -> str:
        return self._names[self._plant.GetBodyFromFrameId(self._inspector.GetFrameId(geometry)).index()]

    def _set(self, q: FloatArray, fingers: FloatArray) -> None:
        places = np.zeros(self._plant.num_positions())
        places[self.bodies.arm] = q
        places[self.bodies.gripper] = fingers
        self._plant.SetPositions(self._context, places)
