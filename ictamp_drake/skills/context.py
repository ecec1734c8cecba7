"""Inputs from which samplers and skills are created."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Protocol, runtime_checkable

from ictamp_drake.core.protocols import Config, Sampler, Skill
from ictamp_drake.core.types import Configuration

if TYPE_CHECKING:
    from ictamp_drake.motion.inverse_kinematics import ArmKinematics
    from ictamp_drake.motion.planner import MotionPlanner, Refusal
    from ictamp_drake.world.world import World


@dataclass(frozen=True)
class SamplerContext:
    """Inputs from which a sampler is created.

    Attributes:
        world: The scene.
        arm: Kinematics of its arm, which determine what is within reach.
    """

    world: "World"
    arm: "ArmKinematics"


@runtime_checkable
class SamplerConfig(Config[SamplerContext, Sampler[Configuration]], Protocol):
    """Configuration of a sampler of k."""


@dataclass(frozen=True)
class SkillContext:
    """Inputs from which a skill is created.

    Attributes:
        world: The scene.
        planner: Motion planner of the scene, shared by all of its skills.
    """

    world: "World"
    planner: "MotionPlanner"


@runtime_checkable
class SkillConfig(Protocol):
    """Configuration of a skill."""

    def create(self, context: SkillContext, /) -> "Skill[Refusal]":
        """The skill in one scene."""
