"""Options of the programs: frozen dataclasses from which the command line is derived.

A choice between implementations is a dataclass with one field for each; its field names are what one can choose.
"""

import dataclasses
from collections.abc import Iterable
from dataclasses import dataclass, replace
from typing import Annotated, Any, Literal, get_args

import tyro

from ictamp_drake.core.checks import check_choice, check_range
from ictamp_drake.core.protocols import Config, Learned, NeedsEstimator
from ictamp_drake.core.spelling import respell
from ictamp_drake.estimators.constant import ConstantConfig
from ictamp_drake.estimators.context import EstimatorConfig
from ictamp_drake.estimators.monte_carlo import MonteCarloConfig
from ictamp_drake.estimators.p_score import PScoreConfig
from ictamp_drake.estimators.q_value import QValueConfig
from ictamp_drake.planning.adaptive import AdaptiveConfig
from ictamp_drake.planning.els import ElsConfig
from ictamp_drake.planning.planner import Budget, PlannerConfig
from ictamp_drake.planning.proportional import ProportionalConfig
from ictamp_drake.planning.round_robin import RoundRobinConfig
from ictamp_drake.planning.rule import RuleConfig
from ictamp_drake.planning.stap import StapConfig
from ictamp_drake.planning.uniform import UniformAllocationConfig
from ictamp_drake.skills.config import (
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
from ictamp_drake.tamp.parts import GROUPS, find_part, list_constants, load_installed, name_part, set_constants
from ictamp_drake.world.config import PhysicsConfig, PredicateConfig


@dataclass(frozen=True)
class Samplers:
    """Sources of the skill parameter k."""

    policy: PolicyConfig = PolicyConfig()
    optimization: OptimizationConfig = OptimizationConfig()
    uniform: UniformConfig = UniformConfig()

    def by_name(self) -> dict[str, SamplerConfig]:
        """Each by the name that chooses it."""
        return {"policy": self.policy, "optimization": self.optimization, "uniform": self.uniform}


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
"""What a found plan must pass besides the execution of its skills; see `Method`."""

Execution = Literal["each-step", "whole-plan"]
"""When physics runs the skills; see `Method`."""

FINE_STEP = 1e-3
"""Time step of the strictest verification [s]."""


def describe_choices(names: tuple[str, ...]) -> Any:
    """How the help shows an option that takes one of the names."""
    return tyro.conf.arg(metavar=f"{{{','.join(names)}}}")


def _describe_part(option: str, known: Iterable[str]) -> Any:
    """How the help shows an option that takes the name of a part; installed ones are among them."""
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
    """How a problem is solved. A run that is continued keeps all of these that are `decisive`.

    Attributes:
        time_limit: of one problem, from the start of loading its scene [s].
        max_steps: low-level steps of one problem.
        seed: of everything random in the search.
        sampler: where skill parameters k come from.
        estimator: where P, the estimated probability that a step succeeds, comes from.
        generator: in which order high-level plans come.
        planner: which computational action comes next; completion-tree is the paper's rule. els (unless weighted),
            round-robin and uniform ask no estimator, and stap asks STAP's product of Q along the plan.
        max_expansions: nodes expanded in one call for a new high-level plan (Algorithm 3, line 1).
        verify: What a found plan must pass besides the execution of its skills one after the other, which is one
            execution of the whole, bit for bit. none: nothing more. awake: another execution, in a fresh simulator in
            which no box sleeps. fine: the same with a time step of 1 ms.
        execution: When physics runs the skills. each-step: each at once, so that the search goes on from where physics
            ended. whole-plan: a plan as a whole once its motions are found; until then a skill ends where it promises.
            A step that physics refuses is blamed, and the search goes on from the one before.
        skills: constants of the skills and of motion planning.
        physics: how the scene is simulated.
        predicates: tolerances of H.
        samplers: constants of each sampler.
        estimators: constants of each estimator.
        generators: constants of each plan generator.
        planners: constants of each planner.
    """

    time_limit: float = 60.0
    max_steps: int | None = None
    seed: int = 0
    sampler: Annotated[str | SamplerConfig, _describe_part("sampler", Samplers().by_name())] = "policy"
    estimator: Annotated[str | EstimatorConfig, _describe_part("estimator", Estimators().by_name())] = "p-score"
    generator: Annotated[str | GeneratorConfig, _describe_part("generator", Generators().by_name())] = "breadth-first"
    planner: Annotated[str | RuleConfig, _describe_part("planner", Planners().by_name())] = "completion-tree"
    max_expansions: int = PlannerConfig.max_expansions
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
        check_range("max-steps", self.max_steps or 0, 0, 1e9)
        check_range("seed", self.seed, 0, 2**63 - 1)
        check_range("max-expansions", self.max_expansions, 1, 1e9)
        check_choice("verify", self.verify, get_args(Verification))
        check_choice("physics", self.execution, get_args(Execution))
        for option in GROUPS:
            if isinstance(name := getattr(self, option), str):
                is_text = ":" in name or "(" in name
                object.__setattr__(self, option, name if is_text else respell(name.replace("_", "-")))
        self.check_parts()

    def with_options(self, **options: Any) -> "Method":
        """The same method with other values of some fields.

        Raises:
            IctampError: A field or its value does not exist.
        """
        for name in options:
            check_choice("option", name, [field.name for field in dataclasses.fields(self)])
        return replace(self, **options)

    def check_parts(self) -> None:
        """Raise IctampError when a part does not exist or cannot be made."""
        for config in (self.sampler_config, self.estimator_config, self.generator_config, self.rule_config):
            assert config

    def check(self) -> None:
        """Raise IctampError at once, rather than in every problem, when what was learned is not to be had."""
        for config in self.learned:
            config.check()

    @property
    def learned(self) -> list[Learned]:
        """Those of the chosen sampler and estimator that need trained networks."""
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
        """How a found plan is executed once more, None when it is not."""
        if self.verify == "none":
            return None
        step = min(FINE_STEP, self.physics.time_step) if self.verify == "fine" else self.physics.time_step
        return replace(self.physics, sleep=False, time_step=step)

    @property
    def decisive(self) -> dict[str, Any]:
        """Every option that decides how a problem is solved: all but the constants of what is not chosen."""
        rule, generator = self.rule_config, self.generator_config
        estimator = rule.estimator[0] if isinstance(rule, NeedsEstimator) else self.estimator
        used: dict[str, tuple[object, object]] = {
            "sampler": (self.sampler, self.sampler_config),
            "estimator": (estimator, find_part("estimator", estimator, self.estimators.by_name())),
            "generator": (self.generator, generator),
            "planner": (self.planner, rule),
        }
        values = dataclasses.asdict(self)
        for option, (chosen, config) in used.items():
            if not isinstance(values[option], str):
                values[option] = name_part(config)
            name = chosen if isinstance(chosen, str) else name_part(config)
            values[f"{option}s"] = {name.replace("-", "_"): list_constants(config)}
        for action, skill in {"pick": self.skills.pick, "place": self.skills.place}.items():
            if type(skill) not in (PickConfig, PlaceConfig):
                values["skills"][action] = {"class": name_part(skill), **list_constants(skill)}
        return values

    def budget(self, elapsed: float) -> Budget:
        """What the search may spend when `elapsed` [s] of the time limit are spent."""
        return Budget(max(0.0, self.time_limit - elapsed), self.max_steps)


SCENE_METHOD = Method(generator="best-first", planners=Planners(completion_tree=ProportionalConfig(W=3.0)))
"""Default of everything that plans in a scene of one's own; experiments keep the defaults of `Method`.

Best-first search finds a plan of n actions with little more than n expansions, breadth-first search with up to tens of
thousands. With W = 30 the rule would open plans all the time; with 3 it opens about as many as with breadth-first
search and 30 (`benchmarks/opening.py`).
"""
