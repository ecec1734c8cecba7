"""The transition f: physics executes a motion from a configuration."""

from collections.abc import Callable, Sequence
from dataclasses import replace
from functools import cached_property, partial

import numpy as np
from pydrake.multibody.plant import MultibodyPlantConfig

from ictamp_drake.core.types import Configuration, FloatArray, GripperCommand, Recording, Segment
from ictamp_drake.world.build import add_robot
from ictamp_drake.world.commands import command_motion, obedience_time, stand_still
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.lookout import Lookout
from ictamp_drake.world.outcome import Frame, Outcome, Tape
from ictamp_drake.world.plant import SimulatedPlant, SimulatedScene
from ictamp_drake.world.poses import normalize_quaternion
from ictamp_drake.world.sleep import NEAR, Sleepers
from ictamp_drake.world.world import World


def contact_model(config: PhysicsConfig) -> MultibodyPlantConfig:
    """The plant's time step and its model of contact."""
    return MultibodyPlantConfig(
        time_step=config.time_step,
        contact_model="point",
        discrete_contact_approximation=config.contact_approximation,
        sap_near_rigid_threshold=0.0,  # else surfaces get softer with the square of the time step
    )


Watcher = Callable[[Segment, "Physics"], bool]
"""Callback after each segment. Returning False ends the simulation there."""


class Physics:
    """Deterministic simulator of a scene that can start from any configuration.

    Every configuration it returns is the complete state. Motions that run one after the other, each from the final
    configuration of the one before, are therefore one execution, bit for bit, whatever simulators and processes run
    them.
    """

    def __init__(self, world: World, config: PhysicsConfig) -> None:
        self.config = config
        self._world = world
        self._gains = config.gains(world.robot)
        self._scene = self._plain = self._build(rims=False)
        contact = contact_model(config)
        contact.use_sampled_output_ports = False  # no forces of contact to keep
        self._arm = SimulatedPlant(contact, partial(add_robot, spec=world.spec), self._gains, None)
        self._sleepers = Sleepers(self._plain)
        self._lookout = Lookout(world)
        bodies = self._plain.bodies
        self._boxes = {name: self._plain.positions(body.model_instance()) for name, body in bodies.boxes.items()}
        robot, positions = bodies.robot, self._plain.plant.num_positions()
        self._q, self._fingers = robot.arm, robot.gripper
        self._robot_x = np.concatenate([robot.arm, robot.gripper, positions + robot.velocities])
        alone, positions = self._arm.robot, self._arm.plant.num_positions()
        self._alone_x = np.concatenate([alone.arm, alone.gripper, positions + alone.velocities])
        self._command = (world.robot.home, GripperCommand(world.robot.gripper.opening))
        self._held: str | None = None
        self._looked = (self._scene.x, self._scene.x)

    def _build(self, *, rims: bool) -> SimulatedScene:
        return SimulatedScene(self._world.spec, contact_model(self.config), self._gains, rims=rims)

    @cached_property
    def _rimmed(self) -> SimulatedScene:
        """Scene with contact points along the rims of supports, for boxes that overhang."""
        return self._build(rims=True)

    def run(
        self, c: Configuration, motion: Sequence[Segment], *, watch: Watcher | None = None, record: bool = True
    ) -> Outcome:
        """Execute a motion from c and wait until all boxes are at rest.

        Args:
            c: Initial configuration.
            motion: Segments to execute in order. Without segments the scene just settles.
            watch: Callback after each segment that may end the simulation early.
            record: Whether to record the states on the way.

        Raises:
            RuntimeError: The contact solver diverges, which happens in a few jammed situations.
            ValueError: The parts of c contradict each other.
        """
        self._load(c)
        return self.proceed(motion, watch=watch, record=record)

    def proceed(self, motion: Sequence[Segment], *, watch: Watcher | None = None, record: bool = True) -> Outcome:
        """Execute a motion from the end of the last one. See `run`."""
        before = self.configuration()
        sleep, rims = self.config.sleep, self._lookout.overhang(self._positions(), self._boxes)
        while True:
            if rims != (self._scene is not self._plain):
                self._scene = self._rimmed if rims else self._plain
                self._load(before)
            try:
                return self._execute(motion, watch, record, sleep=sleep and not rims)
            except _SleeperTouchedError:
                sleep = False
            except _OverhangError:
                rims = True
            except RuntimeError:  # the contact solver diverged; with all boxes awake it may converge
                if not sleep:
                    raise
                sleep = False
            self._load(before)

    def _load(self, c: Configuration) -> None:
        self._sleepers.wake()
        self._command, self._held = (c.commanded, c.gripper), c.held
        x = np.zeros(self._scene.x.size)
        x[self._q], x[self._fingers] = c.q, c.fingers
        for name, places in self._boxes.items():
            x[places] = c.poses[name]
        if c.x is not None:
            if c.x.shape != x.shape or self._view(c.x) != Configuration(c.q, c.fingers, c.poses):
                raise ValueError("x of the configuration belongs to other positions of the arm or the boxes")
            x = c.x
        self._scene.x = x

    def _execute(self, motion: Sequence[Segment], watch: Watcher | None, record: bool, *, sleep: bool) -> Outcome:
        """Execute a motion and wait for rest.

        Raises:
            _SleeperTouchedError: A sleeping box was touched.
            _OverhangError: A box overhangs, and the scene has no rims.
        """
        config = self.config
        period = max(1, round(config.record_period / config.time_step))
        tape = Tape(config.time_step, record)
        tape.add(0, self._scene.x)
        self._looked = (self._scene.x, self._scene.x)
        self._tell(motion)
        step, elapsed, obeyed = 0, 0.0, config.steps(self._obedience_time(motion))
        for segment in motion:
            elapsed += segment.duration
            end = config.steps(elapsed)
            step = self._simulate(segment.touches if sleep else None, [*range(step, end, period), end], tape)
            self._command = (segment.control_points[-1], segment.gripper)
            if watch is not None and not watch(segment, self):
                return Outcome(self.configuration(), False, segment.label, tuple(motion), tape.recording)
        touches = motion[-1].touches if motion else None
        if step < obeyed:
            step = self._simulate(touches if sleep else None, [*range(step, obeyed, period), obeyed], tape)
        if not motion or self._find_moving():
            end = step + config.steps(config.settle_time)
            looks = range(step, end + 1, config.steps(config.settle_check))
            step = self._simulate(touches if sleep else None, looks, tape, until_rest=True)
        waited = step * config.time_step - elapsed
        rest = (stand_still("rest", waited, *self._command, touches),) if motion and waited > 1e-9 else ()
        return Outcome(self.configuration(), not self._find_moving(), None, (*motion, *rest), tape.recording)

    def _tell(self, motion: Sequence[Segment]) -> None:
        """Send the commands of a motion to both plants."""
        config, (q, gripper) = self.config, self._command
        end = max(sum(segment.duration for segment in motion), self._obedience_time(motion)) + config.settle_time
        end += 2 * (config.settle_check + config.time_step)
        command = command_motion(self._world.robot.gripper, q, gripper, motion, end)
        for simulated in (self._scene, self._arm):
            simulated.command(command)

    def _obedience_time(self, motion: Sequence[Segment]) -> float:
        return obedience_time(self._command[1], motion, self._world.robot.gripper.speed)

    def _choose(self, touches: frozenset[str] | None, step: int) -> SimulatedPlant:
        """Let every box sleep that may, or none if `touches` is None, and prepare the plant that simulates the rest."""
        simulated: SimulatedPlant = self._scene
        if touches is None:
            self._sleepers.wake()
        else:
            near = self._lookout.touches(self._positions(), NEAR)
            awake = self._sleepers.find_connected(near, touches | self._find_moving() | self._find_gathering_speed())
            self._sleepers.let_sleep(frozenset(self._boxes) - awake)
            if not touches and not awake:
                simulated = self._arm
                x = np.empty(len(self._alone_x))
                x[self._alone_x] = self._scene.x[self._robot_x]
                simulated.x = x
        simulated.start(step)
        return simulated

    def _simulate(
        self, touches: frozenset[str] | None, looks: Sequence[int], tape: Tape, *, until_rest: bool = False
    ) -> int:
        """Simulate from the first of `looks` to the last, or until all boxes are at rest at one of them.

        Args:
            touches: Names of the bodies that the arm may touch. None allows all.
            looks: Steps at which to check for rest and for contact with sleeping boxes.
            tape: Recorder of the states.
            until_rest: Whether to stop at rest.

        Returns:
            The last step.

        Raises:
            _SleeperTouchedError: A sleeping box was touched.
            _OverhangError: A box overhangs, and the scene has no rims.
        """
        step, *later = looks
        simulated = self._choose(touches, step) if later else self._scene
        for step in later:
            simulated.advance(step)
            x = self._scene.x
            if simulated is self._arm:
                x[self._robot_x] = simulated.x[self._alone_x]
                self._scene.x = x
            self._looked = self._looked[1], x
            tape.add(step, x)
            self._look(arm_alone=simulated is self._arm)
            if until_rest and not self._find_moving():
                break
        if later:
            self._held = None if simulated is self._arm else self._scene.find_gripped(self.config.min_pad_force)
        return step

    def _look(self, *, arm_alone: bool) -> None:
        """Raise when a sleeping box is touched, or when a box overhangs in a scene without rims."""
        q = self._positions()
        if self._sleepers.asleep and self._sleepers.is_disturbed(self._lookout.list_passing(q), arm_alone=arm_alone):
            raise _SleeperTouchedError
        if self._scene is self._plain and self._lookout.overhang(q, self._boxes.keys() - self._sleepers.asleep):
            raise _OverhangError

    def _positions(self) -> FloatArray:
        return self._scene.x[: self._scene.plant.num_positions()]

    def _find_moving(self) -> frozenset[str]:
        """Return the boxes that are not at rest."""
        return self._sleepers.find_moving(self._scene.x, self.config.rest_speed, self.config.rest_turn)

    def _find_gathering_speed(self) -> frozenset[str]:
        """Return the boxes that are slow but faster than at the last check, as when one begins to topple."""
        before, now = self._looked
        return self._sleepers.find_accelerating(before, now, self.config.rest_speed / 20, self.config.rest_turn / 20)

    @property
    def held(self) -> str | None:
        """Box that both fingers press, if any."""
        return self._held

    def configuration(self) -> Configuration:
        """Return the current configuration."""
        x, (commanded, gripper) = self._scene.x, self._command
        return replace(self._view(x), held=self._held, gripper=gripper, commanded=commanded, x=x)

    def frames(self, recording: Recording) -> list[Frame]:
        """Return the frames at the times of a recording."""
        moments = zip(recording.times, recording.states, strict=True)
        return [Frame(float(time), self._view(x)) for time, x in moments]

    def _view(self, x: FloatArray | None = None) -> Configuration:
        """Return the positions of arm and boxes in a state of the scene, by default the current one."""
        x = self._scene.x if x is None else x
        return Configuration(
            x[self._q],
            x[self._fingers],
            {name: normalize_quaternion(x[places]) for name, places in self._boxes.items()},
        )


class _SleeperTouchedError(Exception):
    """Something awake touched a sleeping box."""


class _OverhangError(Exception):
    """A box reaches beyond the rim of a support that it stands on."""
