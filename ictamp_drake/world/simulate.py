"""f, the transition: what physics makes of a configuration and a motion."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Literal, NamedTuple

import numpy as np
from pydrake.multibody.plant import AddMultibodyPlant, MultibodyPlantConfig
from pydrake.multibody.tree import PdControllerGains
from pydrake.systems.analysis import Simulator
from pydrake.systems.framework import Context, DiagramBuilder, EventStatus
from pydrake.systems.primitives import TrajectorySource
from pydrake.trajectories import PiecewisePolynomial

from ictamp_drake.core.types import Configuration, Segment
from ictamp_drake.scenes.checks import check_fields, check_vector
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.world.build import add_scene, filter_flat_contacts
from ictamp_drake.world.commands import desired_positions, feedforward
from ictamp_drake.world.poses import normalised


@dataclass(frozen=True)
class PhysicsConfig:
    """How the scene is simulated.

    Attributes:
        time_step: of the discrete plant [s].
        contact_approximation: of Drake's discrete contact solver.
        arm_stiffness: of the controller of each joint [Nm/rad]; stiffer follows the motion closer.
        arm_damping: of the controller of each joint [Nm s/rad].
        finger_stiffness: of the controller of each finger [N/m].
        finger_damping: of the controller of each finger [N s/m].
        rest_speed: greatest speed of a box at rest [m/s].
        rest_turn: greatest angular speed of a box at rest [rad/s].
        settle_time: longest wait for rest after a motion [s].
        settle_check: time between two looks at the speeds [s].
        min_pad_force: least force of each finger on an object that counts as held, normal and friction together [N].
        record_period: time between two frames of a recording [s].
    """

    time_step: float = 0.004
    contact_approximation: Literal["lagged", "sap", "similar", "tamsi"] = "sap"
    arm_stiffness: tuple[float, ...] = (6000.0, 6000.0, 5000.0, 5000.0, 3000.0, 3000.0, 2000.0)
    arm_damping: tuple[float, ...] = (300.0, 300.0, 250.0, 250.0, 100.0, 100.0, 50.0)
    finger_stiffness: float = 2000.0
    finger_damping: float = 50.0
    rest_speed: float = 2e-3
    rest_turn: float = 2e-2
    settle_time: float = 2.0
    settle_check: float = 0.05
    min_pad_force: float = 1.0
    record_period: float = 1 / 30

    def __post_init__(self) -> None:
        check_fields(
            self,
            "physics",
            time_step=(1e-5, 0.1),
            finger_stiffness=(1e-3, 1e9),
            finger_damping=(0, 1e9),
            rest_speed=(1e-6, 10),
            rest_turn=(1e-6, 100),
            settle_time=(1e-3, 1e3),
            settle_check=(1e-3, 10),
            min_pad_force=(1e-3, 1e3),
            record_period=(1e-3, 1e3),
        )
        check_vector("physics.arm-stiffness", self.arm_stiffness, 1e-3, 1e9, count=7)
        check_vector("physics.arm-damping", self.arm_damping, 0, 1e9, count=7)

    def create(self, spec: SceneSpec) -> "Physics":
        """A simulator of the scene."""
        return Physics(spec, self)


@dataclass(frozen=True)
class Outcome:
    """Where a simulation ended.

    Attributes:
        c: the last configuration.
        settled: whether everything came to rest in time.
        stopped_after: label of the segment after which the watcher ended it, None when it ran to the end.
    """

    c: Configuration
    settled: bool
    stopped_after: str | None = None


class Frame(NamedTuple):
    """A moment of a recorded simulation: time from its start [s] and what is there."""

    time: float
    c: Configuration


Watcher = Callable[[Segment, "Physics"], bool]
"""Called after each segment; False ends the simulation there."""


class Physics:
    """A discrete-time plant of the scene with its controllers: deterministic, restartable from any configuration."""

    def __init__(self, spec: SceneSpec, config: PhysicsConfig) -> None:
        self.config = config
        builder = DiagramBuilder()
        self._plant, scene_graph = AddMultibodyPlant(
            MultibodyPlantConfig(
                time_step=config.time_step,
                contact_model="point",
                discrete_contact_approximation=config.contact_approximation,
                sap_near_rigid_threshold=0.0,  # else surfaces get softer with the square of the time step
            ),
            builder,
        )
        self.bodies = add_scene(self._plant, spec)
        self._plant.set_gravity_enabled(self.bodies.arm, False)  # as Franka's controller compensates it
        self._set_gains()
        self._plant.Finalize()
        filter_flat_contacts(self._plant, scene_graph, self.bodies)
        rest = PiecewisePolynomial(np.zeros((9, 1)))
        self._positions = builder.AddSystem(TrajectorySource(rest, output_derivative_order=1))
        self._efforts = builder.AddSystem(TrajectorySource(rest))
        builder.Connect(self._positions.get_output_port(), self._plant.get_desired_state_input_port(self.bodies.arm))
        builder.Connect(self._efforts.get_output_port(), self._plant.get_actuation_input_port(self.bodies.arm))
        self._simulator = Simulator(builder.Build())
        self._context = self._plant.GetMyMutableContextFromRoot(self._simulator.get_mutable_context())

    def _set_gains(self) -> None:
        stiffness = [*self.config.arm_stiffness, *2 * [self.config.finger_stiffness]]
        damping = [*self.config.arm_damping, *2 * [self.config.finger_damping]]
        for index, p, d in zip(self._plant.GetJointActuatorIndices(), stiffness, damping, strict=True):
            self._plant.get_joint_actuator(index).set_controller_gains(PdControllerGains(p=p, d=d))

    def run(
        self,
        c: Configuration,
        motion: Sequence[Segment],
        *,
        watch: Watcher | None = None,
        record: Callable[[Frame], None] | None = None,
    ) -> Outcome:
        """Execute a motion from c and wait until all is at rest.

        Args:
            c: where to start.
            motion: segments one after the other; empty just lets the scene settle.
            watch: may end the simulation early.
            record: is given a frame every `record_period`.
        """
        self._start(c, motion)
        self._record(c, record)
        time = 0.0
        for segment in motion:
            time += segment.duration
            self._gripper = segment.gripper
            self._simulator.AdvanceTo(time)
            if watch is not None and not watch(segment, self):
                return Outcome(self.configuration(), False, segment.label)
        deadline = time + self.config.settle_time
        settled = False
        while not settled and time < deadline:
            time += self.config.settle_check
            self._simulator.AdvanceTo(time)
            settled = self._at_rest()
        return Outcome(self.configuration(), settled)

    def _start(self, c: Configuration, motion: Sequence[Segment]) -> None:
        end = sum(segment.duration for segment in motion) + self.config.settle_time + 2 * self.config.settle_check
        self._positions.UpdateTrajectory(desired_positions(c.q[:7], c.gripper, motion, end))
        self._efforts.UpdateTrajectory(feedforward(c.gripper, motion, end))
        self._gripper = c.gripper
        self._simulator.get_mutable_context().SetTime(0.0)
        plant, context = self._plant, self._context
        plant.SetPositions(context, self.bodies.arm, c.q)
        for name, body in self.bodies.boxes.items():
            plant.SetPositions(context, body.model_instance(), c.poses[name])
        plant.SetVelocities(context, np.zeros(plant.num_velocities()))
        self._simulator.Initialize()

    def _record(self, c: Configuration, record: Callable[[Frame], None] | None) -> None:
        if record is None:
            self._simulator.clear_monitor()
            return
        record(Frame(0.0, c))  # the plant knows its contacts only after the first step
        due = self.config.record_period

        def monitor(context: Context) -> EventStatus:
            nonlocal due
            if context.get_time() >= due:
                due += self.config.record_period
                record(Frame(context.get_time(), self.configuration()))
            return EventStatus.DidNothing()

        self._simulator.set_monitor(monitor)

    def configuration(self) -> Configuration:
        """The configuration at this moment; velocities are dropped."""
        plant, context = self._plant, self._context
        poses = {n: normalised(plant.GetPositions(context, b.model_instance())) for n, b in self.bodies.boxes.items()}
        return Configuration(plant.GetPositions(context, self.bodies.arm), poses, self.gripped(), self._gripper)

    def gripped(self) -> str | None:
        """The box that both fingers press, if any."""
        results = self._plant.get_contact_results_output_port().Eval(self._context)
        fingers = [body.index() for body in self.bodies.fingers]
        forces: dict[str, list[float]] = {name: [0.0, 0.0] for name in self.bodies.boxes}
        names = {body.index(): name for name, body in self.bodies.boxes.items()}
        for i in range(results.num_point_pair_contacts()):
            contact = results.point_pair_contact_info(i)
            for one, other in (
                (contact.bodyA_index(), contact.bodyB_index()),
                (contact.bodyB_index(), contact.bodyA_index()),
            ):
                if one in fingers and other in names:
                    forces[names[other]][fingers.index(one)] += float(np.linalg.norm(contact.contact_force()))
        held = [name for name, pair in forces.items() if min(pair) >= self.config.min_pad_force]
        return held[0] if held else None

    def _at_rest(self) -> bool:
        for body in self.bodies.boxes.values():
            velocity = self._plant.EvalBodySpatialVelocityInWorld(self._context, body)
            moving = np.linalg.norm(velocity.translational()) > self.config.rest_speed
            if moving or np.linalg.norm(velocity.rotational()) > self.config.rest_turn:
                return False
        return True
