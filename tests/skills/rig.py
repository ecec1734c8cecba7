"""Everything that tests of skills need in one scene, put together as a program does it."""

from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Attempt, Configuration, Parameter, Skeleton, State
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.skills.config import OptimizationConfig, SkillsConfig
from ictamp_drake.skills.context import SamplerConfig
from ictamp_drake.skills.runner import Skills
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.tamp.symbols import domain_of
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.simulate import Physics
from ictamp_drake.world.world import World

OPTIMIZATION = OptimizationConfig()
KINEMATIC = frozenset({Failure.NO_INVERSE_KINEMATICS, Failure.GOAL_IN_COLLISION, Failure.NO_PATH})
"""Causes of failure before anything is simulated."""


@dataclass(frozen=True)
class Rig:
    """One scene with its physics and skills."""

    world: World
    abstraction: SceneAbstraction
    physics: Physics
    skills: Skills

    @cached_property
    def start(self) -> Configuration:
        """c_0, at rest."""
        return self.physics.run(self.world.initial_configuration(), ()).c

    @cached_property
    def domain(self) -> Domain:
        """The ground actions of the scene."""
        spec = self.world.spec
        return domain_of(spec, self.abstraction(self.start))

    def promised_state(self, c: Configuration, action: Action) -> State:
        """State that the action promises in c."""
        return self.domain.successor(self.abstraction(c), action)

    def step(self, c: Configuration, action: Action) -> Skeleton:
        """The plan of one action."""
        return Skeleton((self.abstraction(c), self.promised_state(c, action)), (action,))

    def attempt(
        self, c: Configuration, action: Action, seed: int = 0, k: Parameter | None = None
    ) -> Attempt[Configuration]:
        """One low-level step from c."""
        return self.skills.attempt(c, self.step(c, action), np.random.default_rng(seed), k)


def rig(spec: SceneSpec, sampler: SamplerConfig = OPTIMIZATION, draws: int = 8) -> Rig:
    """The scene with the default physics and skills."""
    world = World(spec)
    abstraction = SceneAbstraction(world)
    physics = PhysicsConfig().create(world)
    skills = replace(SkillsConfig(), draws=draws).create(world, abstraction, physics, sampler)
    return Rig(world, abstraction, physics, skills)


def pick(box: str, below: str) -> Action:
    """pick(box, below)."""
    return Action("pick", (box, below))


def place(box: str, receptacle: str) -> Action:
    """place(box, receptacle)."""
    return Action("place", (box, receptacle))
