"""Executions in a world that differs from the one in which the plan was found."""

from collections.abc import Iterator
from dataclasses import dataclass, replace

import numpy as np
from pydrake.math import RigidTransform, RollPitchYaw

from ictamp_drake.core.checks import check_range, check_vector
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.core.types import Attempt, Configuration, GripperCommand, State
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.tamp.plan import Plan
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.poses import to_pose, to_transform
from ictamp_drake.world.start import find_overlaps
from ictamp_drake.world.world import World

DRAWS = 200
"""Maximum number of draws of the noise until the scene is one in which the plan could start."""


@dataclass(frozen=True)
class Changes:
    """Differences between an execution and the world in which the plan was found.

    Attributes:
        noise: Standard deviations of where the boxes start [m] and of their yaw [deg]. Each stack moves as a whole, is
            drawn again when boxes overlap or the symbolic state changes, and comes to rest before the plan begins.
        seed: Random seed of the noise.
        friction: Factor of the friction of the boxes.
        mass: Factor of the mass of the boxes.
        grip_force: Factor of the force of the fingers.
        stiffness: Factor of the stiffness of the arm's controllers.
        time_step: Time step of the physics [s]; by default that of --physics.
    """

    noise: tuple[float, float] = (0.0, 0.0)
    seed: int = 0
    friction: float = 1.0
    mass: float = 1.0
    grip_force: float = 1.0
    stiffness: float = 1.0
    time_step: float | None = None

    def __post_init__(self) -> None:
        check_vector("noise[0]", self.noise[:1], 0, 0.1, " m", count=None)
        check_vector("noise[1]", self.noise[1:], 0, 180, " deg", count=None)
        check_range("seed", self.seed, 0, 2**63 - 1)
        for name in ("friction", "mass", "grip_force", "stiffness"):
            check_range(name.replace("_", "-"), getattr(self, name), 0.01, 100)
        if self.time_step is not None:
            PhysicsConfig(time_step=self.time_step)  # which checks it

    def physics(self, config: PhysicsConfig) -> PhysicsConfig:
        """Return the settings of the simulation with the changed controllers and time step."""
        stiffness = tuple(self.stiffness * each for each in config.arm_stiffness)
        return replace(config, arm_stiffness=stiffness, time_step=self.time_step or config.time_step)

    def apply(self, plan: Plan, config: PhysicsConfig | None = None) -> Plan:
        """Return the same plan for the changed boxes, hand and start.

        Args:
            plan: Plan to change.
            config: Settings of the simulation in which the moved boxes come to rest.

        Raises:
            IctampError: A changed mass or friction is out of range, or the noise leaves no scene to start in.
        """
        spec = self._change_boxes(plan.spec)
        attempts = tuple(self._change_grip(attempt) for attempt in plan.attempts)
        c = replace(plan.c, gripper=self._grip(plan.c.gripper))
        if any(self.noise):
            c = self._move(spec, c, self.physics(config or PhysicsConfig()))
        return Plan(spec, c, attempts)

    def _change_boxes(self, spec: SceneSpec) -> SceneSpec:
        boxes = {}
        for name, box in spec.boxes.items():
            try:
                boxes[name] = replace(box, mass=self.mass * box.mass, friction=self.friction * box.friction)
            except IctampError as error:
                error.add_field(f"boxes.{name}")
                raise
        return replace(spec, boxes=boxes)

    def _change_grip(self, attempt: Attempt[Configuration]) -> Attempt[Configuration]:
        motion = tuple(replace(segment, gripper=self._grip(segment.gripper)) for segment in attempt.motion)
        return replace(attempt, motion=motion, recording=None)

    def _grip(self, command: GripperCommand) -> GripperCommand:
        return replace(command, force=self.grip_force * command.force)

    def _move(self, spec: SceneSpec, c: Configuration, config: PhysicsConfig) -> Configuration:
        """Move every stack of boxes, and let the scene come to rest."""
        world = World(spec)
        abstraction, physics = SceneAbstraction(world), config.create(world)
        state, rng = abstraction(c), generator(Stream.NOISE, self.seed, spec.seed)
        stacks = list(find_stacks(state, c))
        for _ in range(DRAWS):
            moved = self._draw(stacks, c, rng)
            if find_overlaps(world, moved) or abstraction(moved) != state:
                continue
            outcome = physics.run(moved, (), record=False)
            if outcome.settled and abstraction(outcome.c) == state:
                return outcome.c
        problem = f"expected room for the boxes to start elsewhere, found none in {DRAWS} draws of noise {{value}}"
        raise IctampError(Code.OVERLAP, problem, field="noise", value=self.noise)

    def _draw(self, stacks: list[list[str]], c: Configuration, rng: np.random.Generator) -> Configuration:
        poses = dict(c.poses)
        shift, turn = self.noise
        for stack in stacks:
            x, y, yaw = rng.normal(size=3) * (shift, shift, np.radians(turn))
            foot = poses[min(stack, key=lambda name: float(c.poses[name][6]))][4:]
            X_WS = RigidTransform(RollPitchYaw(0.0, 0.0, yaw), foot + [x, y, 0.0]) @ RigidTransform(-foot)
            poses.update({name: to_pose(X_WS @ to_transform(c.poses[name])) for name in stack})
        return replace(c, poses=poses, x=None)


def find_stacks(state: State, c: Configuration) -> Iterator[list[str]]:
    """Yield the boxes that hang together because one carries the other, without the box in the hand."""
    pairs = [atom.args for atom in sorted(state) if atom.predicate in {"on", "lying"} and atom.args[1] in c.poses]
    waiting = [name for name in c.poses if name != c.held]
    while waiting:
        stack = [waiting.pop(0)]
        for name in stack:  # which grows meanwhile
            linked = {other for pair in pairs if name in pair for other in pair} & set(waiting)
            stack += sorted(linked)
            waiting = [other for other in waiting if other not in linked]
        yield stack
