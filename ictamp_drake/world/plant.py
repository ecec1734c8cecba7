"""Discrete plants of the arm, alone or in its scene, with controllers that follow a motion."""

from collections.abc import Callable

import numpy as np
from numpy.typing import NDArray
from pydrake.geometry import SceneGraph
from pydrake.multibody.plant import (
    AddMultibodyPlant,
    ApplyMultibodyPlantConfig,
    MultibodyPlant,
    MultibodyPlantConfig,
)
from pydrake.multibody.tree import ModelInstanceIndex, PdControllerGains
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import DiagramBuilder
from pydrake.systems.primitives import TrajectorySource
from pydrake.trajectories import PiecewisePolynomial

from ictamp_drake.core.types import FloatArray
from ictamp_drake.robots.bodies import RobotBodies
from ictamp_drake.robots.robot import find_robot
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.world.build import SceneBodies, add_rims, add_scene, filter_flat_contacts
from ictamp_drake.world.commands import Command

IntArray = NDArray[np.intp]


class SimulatedPlant:
    """A plant simulated in steps. Its time is a whole number of steps since the start of a motion.

    Attributes:
        plant: Plant that contains the robot.
        robot: Arm and gripper.
        context: Context of the plant.
        simulator: Simulator of the whole diagram.
    """

    def __init__(
        self,
        config: MultibodyPlantConfig,
        add: Callable[[MultibodyPlant], RobotBodies],
        gains: tuple[FloatArray, FloatArray],
        touch: Callable[[MultibodyPlant, SceneGraph], None] | None,
    ) -> None:
        """Build the plant.

        Args:
            config: Time step and contact model of the plant.
            add: Function that adds the models to the plant and returns the robot.
            gains: Stiffness and damping of the controllers of the arm's joints [Nm/rad, Nm s/rad], then of the driven
                joints of the fingers, each of shape (commanded,).
            touch: Function that decides which shapes of the finished plant can touch. None leaves out all shapes.
        """
        builder = DiagramBuilder()
        if touch is None:
            self.plant = builder.AddSystem(MultibodyPlant(config.time_step))
            ApplyMultibodyPlantConfig(config, self.plant)
        else:
            self.plant, scene_graph = AddMultibodyPlant(config, builder)
        self._time_step = config.time_step
        self.robot = add(self.plant)
        for instance in self.robot.instances:
            self.plant.set_gravity_enabled(instance, False)  # as the arm's own controller compensates it
        for actuator, p, d in zip(self.robot.actuators, *gains, strict=True):
            actuator.set_controller_gains(PdControllerGains(p=p, d=d))
        self.plant.Finalize()
        if touch is not None:
            touch(self.plant, scene_graph)
        self._sources = [_Source(builder, self.robot, instance) for instance in self.robot.instances]
        self.simulator = Simulator(builder.Build())
        self.context = self.plant.GetMyMutableContextFromRoot(self.simulator.get_mutable_context())

    def command(self, command: Command) -> None:
        """Set desired positions and added efforts of arm and fingers over the time of a motion."""
        for source in self._sources:
            source.update(command)

    def start(self, step: int) -> None:
        """Set the time and keep the state of the plant."""
        self.simulator.get_mutable_context().SetTime(step * self._time_step)
        self.simulator.Initialize()

    def advance(self, step: int) -> None:
        """Simulate up to a step.

        Raises:
            RuntimeError: The contact solver diverges, which happens in a few jammed situations.
        """
        self.simulator.AdvanceTo(step * self._time_step)

    @property
    def x(self) -> FloatArray:
        """Copy of the complete state, positions then velocities, shape (n,)."""
        copy: FloatArray = self.context.get_discrete_state_vector().CopyToVector()
        return copy

    @x.setter
    def x(self, value: FloatArray) -> None:
        self.context.SetDiscreteState(value)

    def positions(self, instance: ModelInstanceIndex) -> IntArray:
        """Indices of a model's positions in `x`."""
        numbers = np.arange(self.plant.num_positions(), dtype=float)
        return self.plant.GetPositionsFromArray(instance, numbers).astype(np.intp)

    def velocities(self, instance: ModelInstanceIndex) -> IntArray:
        """Indices of a model's velocities in `x`."""
        numbers = np.arange(self.plant.num_velocities(), dtype=float)
        return self.plant.num_positions() + self.plant.GetVelocitiesFromArray(instance, numbers).astype(np.intp)


class _Source:
    """Source of the commands to a model instance: the arm, the gripper, or both if they are one model."""

    def __init__(self, builder: DiagramBuilder, robot: RobotBodies, instance: ModelInstanceIndex) -> None:
        self._parts = robot.parts(instance)
        plant = robot.plant
        rest = PiecewisePolynomial(np.zeros((plant.num_actuated_dofs(instance), 1)))
        self._positions = builder.AddSystem(TrajectorySource(rest, output_derivative_order=1))
        self._efforts = builder.AddSystem(TrajectorySource(rest))
        builder.Connect(self._positions.get_output_port(), plant.get_desired_state_input_port(instance))
        builder.Connect(self._efforts.get_output_port(), plant.get_actuation_input_port(instance))

    def update(self, command: Command) -> None:
        self._positions.UpdateTrajectory(command.positions(self._parts))
        self._efforts.UpdateTrajectory(command.efforts(self._parts))


class SimulatedScene(SimulatedPlant):
    """A plant of the arm and everything around it.

    Attributes:
        bodies: Bodies of the scene.
    """

    bodies: SceneBodies

    def __init__(
        self, spec: SceneSpec, config: MultibodyPlantConfig, gains: tuple[FloatArray, FloatArray], *, rims: bool
    ) -> None:
        """Build the plant. With `rims`, supports also carry boxes that overhang, and no joint may be locked."""

        def add(plant: MultibodyPlant) -> RobotBodies:
            self.bodies = add_scene(plant, spec)
            if rims:
                add_rims(plant, spec)
            return self.bodies.robot

        def touch(plant: MultibodyPlant, scene_graph: SceneGraph) -> None:
            filter_flat_contacts(plant, scene_graph, self.bodies)
            find_robot(spec.robot).filter(self.bodies.robot, scene_graph)

        super().__init__(config, add, gains, touch)
        self._boxes = {body.index(): name for name, body in self.bodies.boxes.items()}
        self._fingers = [body.index() for body in self.bodies.robot.fingers]

    def find_gripped(self, force: float) -> str | None:
        """Return the box that each finger pressed with at least `force` [N] in the last step, if any."""
        results = self.plant.get_contact_results_output_port().Eval(self.context)
        forces: dict[str, list[float]] = {name: [0.0, 0.0] for name in self.bodies.boxes}
        for i in range(results.num_point_pair_contacts()):
            contact = results.point_pair_contact_info(i)
            for one, other in (
                (contact.bodyA_index(), contact.bodyB_index()),
                (contact.bodyB_index(), contact.bodyA_index()),
            ):
                if one in self._fingers and other in self._boxes:
                    pressed = float(np.linalg.norm(contact.contact_force()))
                    forces[self._boxes[other]][self._fingers.index(one)] += pressed
        held = [name for name, pair in forces.items() if min(pair) >= force]
        return held[0] if held else None
