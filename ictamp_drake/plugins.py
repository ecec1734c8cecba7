"""The protocols and types that are promised to authors of samplers, estimators, rules, generators and skills.

    from ictamp_drake.plugins import Action, Configuration, Parameter, SamplerContext

A part is made by its configuration: `create(context)`, with the context of its kind, e.g. `SamplerContext`. There is
an example of each kind in docs/extending.md, and `tamp.parts` says how an installed package offers its own.
"""

from typing import TYPE_CHECKING

from ictamp_drake.core.lazy import import_lazily

if TYPE_CHECKING:
    from ictamp_drake.core.protocols import (
        Config,
        Estimator,
        Learned,
        NeedsEstimator,
        PlanGenerator,
        PlanOptimizer,
        PlanParameters,
        RuleContext,
        Sampler,
        SelectionRule,
        Selective,
        Skill,
        SkillRunner,
        Trained,
    )
    from ictamp_drake.core.types import (
        Action,
        Atom,
        Attempt,
        C,
        Configuration,
        FloatArray,
        GripperCommand,
        Motion,
        Obstruction,
        Parameter,
        Segment,
        Skeleton,
        State,
    )
    from ictamp_drake.estimators.context import EstimatorConfig, EstimatorContext
    from ictamp_drake.motion.inverse_kinematics import ArmKinematics
    from ictamp_drake.motion.planner import MotionPlanner, Refusal
    from ictamp_drake.planning.rule import OpenPlan, Option, RuleConfig
    from ictamp_drake.planning.tree import RunStep, Tree
    from ictamp_drake.skills.base import imagine
    from ictamp_drake.skills.chain import ChainSampler
    from ictamp_drake.skills.config import PickConfig, PlaceConfig, SkillsConfig
    from ictamp_drake.skills.context import SamplerConfig, SamplerContext, SkillConfig, SkillContext
    from ictamp_drake.skills.geometry import raise_pose
    from ictamp_drake.skills.pick import Pick
    from ictamp_drake.skills.place import Place
    from ictamp_drake.symbolic.context import GeneratorConfig, GeneratorContext
    from ictamp_drake.symbolic.domain import Domain
    from ictamp_drake.symbolic.goal import Goal
    from ictamp_drake.world.world import World

__all__ = [
    "Action",
    "ArmKinematics",
    "Atom",
    "Attempt",
    "C",
    "ChainSampler",
    "Config",
    "Configuration",
    "Domain",
    "Estimator",
    "EstimatorConfig",
    "EstimatorContext",
    "FloatArray",
    "GeneratorConfig",
    "GeneratorContext",
    "Goal",
    "GripperCommand",
    "Learned",
    "Motion",
    "MotionPlanner",
    "NeedsEstimator",
    "Obstruction",
    "OpenPlan",
    "Option",
    "Parameter",
    "Pick",
    "PickConfig",
    "Place",
    "PlaceConfig",
    "PlanGenerator",
    "PlanOptimizer",
    "PlanParameters",
    "Refusal",
    "RuleConfig",
    "RuleContext",
    "RunStep",
    "Sampler",
    "SamplerConfig",
    "SamplerContext",
    "Segment",
    "SelectionRule",
    "Selective",
    "Skeleton",
    "Skill",
    "SkillConfig",
    "SkillContext",
    "SkillRunner",
    "SkillsConfig",
    "State",
    "Trained",
    "Tree",
    "World",
    "imagine",
    "raise_pose",
]

_HOMES = {
    "Action": "core.types:Action",
    "ArmKinematics": "motion.inverse_kinematics:ArmKinematics",
    "Atom": "core.types:Atom",
    "Attempt": "core.types:Attempt",
    "C": "core.types:C",
    "ChainSampler": "skills.chain:ChainSampler",
    "Config": "core.protocols:Config",
    "Configuration": "core.types:Configuration",
    "Domain": "symbolic.domain:Domain",
    "Estimator": "core.protocols:Estimator",
    "EstimatorConfig": "estimators.context:EstimatorConfig",
    "EstimatorContext": "estimators.context:EstimatorContext",
    "FloatArray": "core.types:FloatArray",
    "GeneratorConfig": "symbolic.context:GeneratorConfig",
    "GeneratorContext": "symbolic.context:GeneratorContext",
    "Goal": "symbolic.goal:Goal",
    "GripperCommand": "core.types:GripperCommand",
    "Learned": "core.protocols:Learned",
    "Motion": "core.types:Motion",
    "MotionPlanner": "motion.planner:MotionPlanner",
    "NeedsEstimator": "core.protocols:NeedsEstimator",
    "Obstruction": "core.types:Obstruction",
    "OpenPlan": "planning.rule:OpenPlan",
    "Option": "planning.rule:Option",
    "Parameter": "core.types:Parameter",
    "Pick": "skills.pick:Pick",
    "PickConfig": "skills.config:PickConfig",
    "Place": "skills.place:Place",
    "PlaceConfig": "skills.config:PlaceConfig",
    "PlanGenerator": "core.protocols:PlanGenerator",
    "PlanOptimizer": "core.protocols:PlanOptimizer",
    "PlanParameters": "core.protocols:PlanParameters",
    "Refusal": "motion.planner:Refusal",
    "RuleConfig": "planning.rule:RuleConfig",
    "RuleContext": "core.protocols:RuleContext",
    "RunStep": "planning.tree:RunStep",
    "Sampler": "core.protocols:Sampler",
    "SamplerConfig": "skills.context:SamplerConfig",
    "SamplerContext": "skills.context:SamplerContext",
    "Segment": "core.types:Segment",
    "SelectionRule": "core.protocols:SelectionRule",
    "Selective": "core.protocols:Selective",
    "Skeleton": "core.types:Skeleton",
    "Skill": "core.protocols:Skill",
    "SkillConfig": "skills.context:SkillConfig",
    "SkillContext": "skills.context:SkillContext",
    "SkillRunner": "core.protocols:SkillRunner",
    "SkillsConfig": "skills.config:SkillsConfig",
    "State": "core.types:State",
    "Trained": "core.protocols:Trained",
    "Tree": "planning.tree:Tree",
    "World": "world.world:World",
    "imagine": "skills.base:imagine",
    "raise_pose": "skills.geometry:raise_pose",
}
"""Where each name is defined."""

__getattr__ = import_lazily(__name__, globals(), _HOMES)


def __dir__() -> list[str]:
    return sorted({*globals(), *__all__})
