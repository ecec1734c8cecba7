"""Options of the programs: frozen dataclasses from which the command line is derived.

A choice between implementations is a dataclass with one field for each; its field names are what one can choose.
"""

import dataclasses
from collections.abc import Iterable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Annotated, Any, Literal, TypeGuard, get_args

import tyro

from ictamp_drake.core.checks import check_choice, check_range
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.protocols import Config, Learned, NeedsEstimator, Trained
from ictamp_drake.core.spelling import respell
from ictamp_drake.estimators.constant import ConstantConfig
from ictamp_drake.estimators.context import EstimatorConfig
from ictamp_drake.estimators.monte_carlo import MonteCarloConfig
from ictamp_drake.estimators.p_score import PScoreConfig
from ictamp_drake.estimators.q_value import QValueConfig
from ictamp_drake.motion.config import CarryingConfig, MotionConfig
from ictamp_drake.planning.adaptive import AdaptiveConfig
from ictamp_drake.planning.els import ElsConfig
from ictamp_drake.planning.planner import Budget, PlannerConfig
from ictamp_drake.planning.proportional import ProportionalConfig
from ictamp_drake.planning.round_robin import RoundRobinConfig
from ictamp_drake.planning.rule import RuleConfig
from ictamp_drake.planning.stap import StapConfig
from ictamp_drake.planning.uniform import UniformAllocationConfig
from ictamp_drake.skills.config import (
    GeometricConfig,
    OptimizationConfig,
    PickConfig,
    PlaceConfig,
    PolicyConfig,
    SkillsConfig,
    UniformConfig,
)
from ictamp_drake.skills.context import SamplerConfig
from ictamp_drake.symbolic.context import GeneratorConfig
from ictamp_drake.symbolic.skeletons import BestFirst, BreadthFirst
from ictamp_drake.tamp.parts import (
    GROUPS,
    check_part,
    find_part,
    list_constants,
    load_installed,
    name_part,
    set_constants,
)
from ictamp_drake.world.config import PhysicsConfig, PredicateConfig


@dataclass(frozen=True)
class Samplers:
    """Sources of the skill parameter k."""

    policy: PolicyConfig = PolicyConfig()
    geometric: GeometricConfig = GeometricConfig()
    optimization: OptimizationConfig = OptimizationConfig()
    uniform: UniformConfig = UniformConfig()

    def by_name(self) -> dict[str, SamplerConfig]:
        """Each by the name that chooses it."""
        return {
            "policy": self.policy,
            "geometric": self.geometric,
            "optimization": self.optimization,
            "uniform": self.uniform,
        }


@dataclass(frozen=True)
class Estimators:
    """Sources of P, the estimated probability that a step succeeds."""

    p_score: PScoreConfig = PScoreConfig()
    q_value: QValueConfig = QValueConfig()
    constant: ConstantConfig = ConstantConfig()
    monte_carlo: MonteCarloConfig = MonteCarloConfig()

    def by_name(self) -> dict[str, EstimatorConfig]:
        """Each by the name that chooses it."""
        return {
            "p-score": self.p_score,
            "q-value": self.q_value,
            "constant": self.constant,
            "monte-carlo": self.monte_carlo,
        }


@dataclass(frozen=True)
class Generators:
    """Streams of high-level plans."""

    breadth_first: BreadthFirst = BreadthFirst()
    best_first: BestFirst = BestFirst()

    def by_name(self) -> dict[str, GeneratorConfig]:
        """Each by the name that chooses it."""
        return {"breadth-first": self.breadth_first, "best-first": self.best_first}


@dataclass(frozen=True)
class Planners:
    """Rules that choose the next computational action."""

    completion_tree: ProportionalConfig = ProportionalConfig()
    els: ElsConfig = ElsConfig()
    round_robin: RoundRobinConfig = RoundRobinConfig()
    uniform: UniformAllocationConfig = UniformAllocationConfig()
    stap: StapConfig = StapConfig()
    adaptive: AdaptiveConfig = AdaptiveConfig()

    def by_name(self) -> dict[str, RuleConfig]:
        """Each by the name that chooses it."""
        return {
            "completion-tree": self.completion_tree,
            "els": self.els,
            "round-robin": self.round_robin,
            "uniform": self.uniform,
            "stap": self.stap,
            "adaptive": self.adaptive,
        }


Verification = Literal["none", "awake", "fine"]
"""Test of a found plan, see `Method`."""

Execution = Literal["each-step", "whole-plan"]
"""Time at which physics runs the skills, see `Method`."""

FINE_STEP = 1e-3
"""Time step of the strictest verification [s]."""


def describe_choices(names: tuple[str, ...]) -> Any:
    """Show in the help which names an option takes."""
    return tyro.conf.arg(metavar=f"{{{','.join(names)}}}")


def _describe_part(option: str, known: Iterable[str]) -> Any:
    """Show in the help which parts an option takes, installed ones among them."""
    names = ",".join([*known, *load_installed(option), "MODULE:CLASS"])
    return tyro.constructors.PrimitiveConstructorSpec(
        nargs=1,
        metavar=f"{{{names}}}",
        instance_from_str=lambda arguments: arguments[0],
        is_instance=lambda part: isinstance(part, (str, Config)),
        str_from_instance=lambda part: [part if isinstance(part, str) else name_part(part)],
    )


@dataclass(frozen=True)
class Method:
    """Options of planning. A run can be continued only with the same values of all `decisive` ones.

    Attributes:
        time_limit: Time limit of one problem, from the start of loading its scene [s].
        cpu_limit: Limit of the processor time of one problem, over the same span [s]. By default there is none. A
            result with this limit, and a time limit that is far away, does not depend on what else the machine does.
        max_steps: Maximum number of low-level steps of one problem.
        improve: Time after the first plan in which the search goes on for a better one: one with fewer skills or, with
            as many, a shorter execution [s]. The limits of time and of processor time hold until the first plan.
        seed: Random seed of the search.
        sampler: Source of the skill parameters k.
        estimator: Source of P, the estimated probability that a step succeeds.
        generator: Order in which high-level plans are found.
        planner: Rule that chooses the next computational action; completion-tree is the rule of the paper, and adaptive
            is ours. els (unless weighted), round-robin and uniform use no estimator, and stap uses STAP's product of Q
            along the plan.
        max_expansions: Maximum number of nodes expanded in one call for a new high-level plan (Algorithm 3, line 1).
        sweep: Whether all grasps and placements that every plan needs are tested before the search, on a grid of 5 mm
            and 10 deg and among the supports alone. When an action has none, there is no search.
        verify: Test of a found plan, whose skills were executed one after the other already. none: no further test.
            awake: another execution, in a fresh simulator in which no box sleeps. fine: the same in steps of 1 ms.
        execution: Time at which physics runs the skills. each-step: at once, so that the search continues from the
            simulated end of each skill. whole-plan: once the motions of a whole plan are found; until then, each skill
            is assumed to end where it promises. A step that fails in physics counts as a failure, and the search
            continues from the step before.
        skills: Constants of the skills and of motion planning.
        physics: Constants of the simulation.
        predicates: Tolerances of H.
        samplers: Constants of each sampler.
        estimators: Constants of each estimator.
        generators: Constants of each plan generator.
        planners: Constants of each planner.
    """

    time_limit: float = 60.0
    cpu_limit: float | None = None
    max_steps: int | None = None
    improve: float = 0.0
    seed: int = 0
    sampler: Annotated[str | SamplerConfig, _describe_part("sampler", Samplers().by_name())] = "policy"
    estimator: Annotated[str | EstimatorConfig, _describe_part("estimator", Estimators().by_name())] = "p-score"
    generator: Annotated[str | GeneratorConfig, _describe_part("generator", Generators().by_name())] = "breadth-first"
    planner: Annotated[str | RuleConfig, _describe_part("planner", Planners().by_name())] = "completion-tree"
    max_expansions: int = PlannerConfig.max_expansions
    sweep: bool = False
    verify: Verification = "none"
    execution: Annotated[Execution, tyro.conf.arg(name="physics")] = "each-step"
    skills: SkillsConfig = SkillsConfig()
    physics: PhysicsConfig = PhysicsConfig()
    predicates: PredicateConfig = PredicateConfig()
    samplers: Samplers = Samplers()
    estimators: Estimators = Estimators()
    generators: Generators = Generators()
    planners: Planners = Planners()

    def __post_init__(self) -> None:
        check_range("time-limit", self.time_limit, 0, 1e6, " s")
        check_range("cpu-limit", self.cpu_limit or 0, 0, 1e6, " s")
        check_range("max-steps", self.max_steps or 0, 0, 1e9)
        check_range("improve", self.improve, 0, 1e6, " s")
        check_range("seed", self.seed, 0, 2**63 - 1)
        check_range("max-expansions", self.max_expansions, 1, 1e9)
        check_choice("verify", self.verify, get_args(Verification))
        check_choice("physics", self.execution, get_args(Execution))
        for option in GROUPS:
            if isinstance(name := getattr(self, option), str):
                is_text = ":" in name or "(" in name
                object.__setattr__(self, option, name if is_text else respell(name.replace("_", "-")))
        for option, (chosen, known) in self._choices().items():
            check_part(option, find_part(option, chosen, known))

    def with_options(self, **options: Any) -> "Method":
        """The same method with other values of some fields.

        Raises:
            IctampError: A field or its value does not exist.
        """
        for name in options:
            check_choice("option", name, [field.name for field in dataclasses.fields(self)])
        return replace(self, **options)

    def list_stand_ins(self, robot: str) -> dict[str, str]:
        """List the parts that serve with a robot in place of those trained with another one, by their option.

        Args:
            robot: Robot of the scene: a name of one that ships, or the path of a robot file.

        Raises:
            IctampError: The rule needs an estimator that was trained with another robot.
        """
        if isinstance(self.rule_config, NeedsEstimator) and _is_foreign(self.estimator_config, robot):
            name, _ = self.rule_config.estimator
            problem = f"{{value}} needs the estimator {name}, which is not trained with the robot {robot}"
            raise IctampError(Code.CONFLICT, problem, field="planner", value=self.name_part("planner"))
        parts: dict[str, object] = {"sampler": self.sampler_config, "estimator": self.estimator_config}
        return {option: part.stand_in for option, part in parts.items() if _is_foreign(part, robot)}

    def tell_stand_ins(self, robot: str) -> str:
        """Say in one line what `list_stand_ins` lists; empty if there is nothing."""
        stand_ins = self.list_stand_ins(robot)
        trained = ", ".join(self.name_part(option) for option in stand_ins)
        served = " and ".join(f"the {option} {name}" for option, name in stand_ins.items())
        serve = "serves" if len(stand_ins) == 1 else "serve"
        instead = f"With {Path(robot).name}, {served} {serve} instead."
        return f"Trained with another robot: {trained}. {instead}" if stand_ins else ""

    def suited_to(self, robot: str) -> "Method":
        """Return the method with the parts that serve with a robot, see `list_stand_ins`."""
        return self.with_options(**self.list_stand_ins(robot))

    def name_part(self, option: str) -> str:
        """Name of a chosen part: that of the option, or that of its class."""
        chosen = getattr(self, option)
        return chosen if isinstance(chosen, str) else name_part(chosen)

    def check(self) -> None:
        """Raise IctampError now, rather than in every problem, if trained networks are missing or damaged."""
        for config in self.learned:
            config.check()

    @property
    def learned(self) -> list[Learned]:
        """The chosen sampler and estimator, if they need trained networks."""
        return [config for config in (self.sampler_config, self.estimator_config) if isinstance(config, Learned)]

    @property
    def sampler_config(self) -> SamplerConfig:
        """The chosen sampler of k."""
        return find_part("sampler", self.sampler, self.samplers.by_name())

    @property
    def estimator_config(self) -> EstimatorConfig:
        """The chosen estimator, or the one that the rule needs in its place."""
        known, rule = self.estimators.by_name(), self.rule_config
        if isinstance(rule, NeedsEstimator):
            name, constants = rule.estimator
            return set_constants(find_part("estimator", name, known), constants)
        return find_part("estimator", self.estimator, known)

    @property
    def generator_config(self) -> GeneratorConfig:
        """The chosen generator of high-level plans."""
        return find_part("generator", self.generator, self.generators.by_name())

    @property
    def rule_config(self) -> RuleConfig:
        """The chosen selection rule."""
        return find_part("planner", self.planner, self.planners.by_name())

    @property
    def verification(self) -> PhysicsConfig | None:
        """Physics of another execution of a found plan; None if there is none."""
        if self.verify == "none":
            return None
        step = min(FINE_STEP, self.physics.time_step) if self.verify == "fine" else self.physics.time_step
        return replace(self.physics, sleep=False, time_step=step)

    @property
    def total_time_limit(self) -> float:
        """Longest time of one problem, the time for a better plan included [s]."""
        return self.time_limit + self.improve

    @property
    def decisive(self) -> dict[str, Any]:
        """All options that affect the result: all but the constants of parts that are not chosen."""
        values, rule = dataclasses.asdict(self), self.rule_config
        if not self.improve:
            del values["improve"]  # runs of versions without this option compare equal
        for option, (chosen, known) in self._choices().items():
            if not isinstance(chosen, str):
                values[option] = name_part(chosen)
            used = rule.estimator[0] if option == "estimator" and isinstance(rule, NeedsEstimator) else chosen
            name = used if isinstance(used, str) else name_part(used)
            constants = list_constants(find_part(option, used, known))
            values[f"{option}s"] = {name.replace("-", "_") if name in known else name: constants}
        for action, skill in {"pick": self.skills.pick, "place": self.skills.place}.items():
            if type(skill) not in (PickConfig, PlaceConfig):
                values["skills"][action] = {"class": name_part(skill), **list_constants(skill)}
        return values

    def _choices(self) -> dict[str, tuple[object, Mapping[str, object]]]:
        """The chosen part of each kind, and those of the package."""
        return {
            "sampler": (self.sampler, self.samplers.by_name()),
            "estimator": (self.estimator, self.estimators.by_name()),
            "generator": (self.generator, self.generators.by_name()),
            "planner": (self.planner, self.planners.by_name()),
        }

    def budget(self, elapsed: float, cpu_elapsed: float) -> Budget:
        """The budget of the search after `elapsed` [s] of the time limit and `cpu_elapsed` [s] of processor time."""
        cpu_seconds = None if self.cpu_limit is None else max(0.0, self.cpu_limit - cpu_elapsed)
        return Budget(max(0.0, self.time_limit - elapsed), self.max_steps, cpu_seconds)


def _is_foreign(part: object, robot: str) -> TypeGuard[Trained]:
    """Whether the part was trained with another robot."""
    return isinstance(part, Trained) and part.robot != robot


SCENE_METHOD = Method(
    generator="best-first",
    planner="adaptive",
    sweep=True,
    planners=Planners(completion_tree=ProportionalConfig(W=3.0)),
    skills=SkillsConfig(look_ahead=64, motion=MotionConfig(carrying=CarryingConfig(slide=0.0015))),
)
"""Default for planning in the user's own scenes; experiments keep the defaults of `Method`.

Adaptive allocation solves as many small scenes as the paper's rule, with fewer skills (`benchmarks/shortest.py`).
Best-first search finds a plan of n actions with little more than n expansions, breadth-first search with up to tens of
thousands. With W = 30 the paper's rule would open plans all the time; with 3 it opens about as many as with
breadth-first search and 30 (`benchmarks/opening.py`). Looking ahead keeps towers within reach (`benchmarks/reach.py`).
Boxes are carried slowly enough to stay where they are in the fingers (`benchmarks/grip.py`). What is impossible is said
before the search (`benchmarks/infeasible.py`).
"""
