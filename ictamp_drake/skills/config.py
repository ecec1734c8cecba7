"""Constants of samplers and skills. Imports neither Drake nor torch, so that programs show their help at once."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, ClassVar

import numpy as np
import tyro

from ictamp_drake.core.checks import check_fields, check_interval, check_range, check_vector
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.protocols import Sampler
from ictamp_drake.core.types import Configuration
from ictamp_drake.learning.checkpoint import SHIPPED, SKILLS, check_all
from ictamp_drake.motion.config import MotionConfig
from ictamp_drake.observation.situations import LIFT
from ictamp_drake.robots.grip import LEAST_FORCE, SAFETY
from ictamp_drake.robots.spec import DEFAULT
from ictamp_drake.skills.context import SamplerConfig, SamplerContext, SkillConfig, SkillContext

if TYPE_CHECKING:
    from ictamp_drake.skills.chain import ChainSampler
    from ictamp_drake.skills.ik_sampler import OptimizationSampler
    from ictamp_drake.skills.pick import Pick
    from ictamp_drake.skills.place import Place
    from ictamp_drake.skills.policy import PolicySampler
    from ictamp_drake.skills.runner import Skills
    from ictamp_drake.skills.uniform import UniformSampler
    from ictamp_drake.world.abstraction import SceneAbstraction
    from ictamp_drake.world.simulate import Physics
    from ictamp_drake.world.world import World

CLEARANCES = (0.01, 0.006, 0.003)
"""Distances of each finger from the box while the hand comes down to it or leaves it [m].

The first one tolerates a box 3 mm and 2 deg from its expected pose. The last one tolerates only the arm's own errors.
"""

HEIGHTS = (0.001, 0.002)
"""Minimum and maximum height of a placement above the top face [m]."""

GRID_STEP, GRID_TURN = 0.005, 10.0
"""Distance [m] and angle [deg] between neighboring hand poses in a sweep, see `skills.sweep`."""


def check_clearances(field: str, clearances: Sequence[float]) -> None:
    """Raise IctampError unless there is a clearance and all are between 0 and 0.1 m."""
    if not clearances:
        raise IctampError(Code.EMPTY, "expected one number or more, got {value}", field=field, value=clearances)
    check_vector(field, clearances, 0, 0.1, " m", count=None)


@dataclass(frozen=True)
class UniformConfig:
    """Ranges of k.

    Attributes:
        yaw: Smallest and largest yaw [rad]. Half a turn covers every grasp of a gripper with two fingers.
        max_height: Maximum height of a placement above the receptacle's top face [m].
    """

    yaw: tuple[float, float] = (-np.pi / 4, 3 * np.pi / 4)
    max_height: float = 0.01

    def __post_init__(self) -> None:
        check_interval("samplers.uniform.yaw", self.yaw, -10, 10)
        check_fields(self, "samplers.uniform", max_height=(0, 1))

    def create(self, context: SamplerContext) -> "UniformSampler":
        """The sampler for one scene."""
        from ictamp_drake.skills.uniform import UniformSampler

        return UniformSampler(context.world, self)


@dataclass(frozen=True)
class OptimizationConfig:
    """Constants of the programs that are solved for k.

    Attributes:
        restarts: Maximum number of programs tried for one k.
        max_width: Widest side that is gripped [m]. By default what fits between the fingers.
        depth: Minimum and maximum distance of G below the box's top [m].
        ground: Minimum distance of G above the box's bottom [m].
        grip_offset: Maximum distance of G from the box's center, across the fingers' direction and along it [m].
        turn: Maximum deviation of yaw from the directions of the faces [rad].
        height: Minimum and maximum height of a placement above the top face [m].
        overhang: Maximum horizontal distance of a box's center from the center of the box below [m].
        play: Distance of each finger from the box before it closes [m].
        clearance: Distance kept from the outlines of neighbors [m].
        spots: Number of random spots compared for a placement on a support. The roomiest one becomes the aim.
        room: Room beyond the clearance above which spots count as equal [m].
        reach: Minimum and maximum horizontal distance of a placement from the arm's base [m].
        centring: Weight of the squared distance from the aim [1/m^2].
        comfort: Weight of the squared distance from the comfortable posture [1/rad^2].
        spread: Maximum distance of each joint's random start from the comfortable posture [rad].
    """

    restarts: int = 6
    max_width: float | None = None
    depth: tuple[float, float] = (0.012, 0.034)
    ground: float = 0.014
    grip_offset: tuple[float, float] = (0.008, 0.001)
    turn: float = 0.02
    height: tuple[float, float] = HEIGHTS
    overhang: float = 0.004
    play: float = CLEARANCES[0]
    clearance: float = 0.015
    spots: int = 12
    room: float = 0.08
    reach: tuple[float, float] = (0.3, 0.75)
    centring: float = 1000.0
    comfort: float = 0.1
    spread: float = 0.3

    def __post_init__(self) -> None:
        for name in ("depth", "height", "reach"):
            check_interval(f"samplers.optimization.{name}", getattr(self, name), 0, 10)
        check_vector("samplers.optimization.grip-offset", self.grip_offset, 0, 1, count=2)
        check_fields(
            self,
            "samplers.optimization",
            restarts=(1, 1e6),
            ground=(0, 1),
            turn=(0, 3),
            overhang=(0, 1),
            play=(0, 0.1),
            clearance=(0, 1),
            spots=(1, 1e6),
            room=(0, 10),
            centring=(0, 1e9),
            comfort=(0, 1e9),
            spread=(0, 10),
        )
        if self.max_width is not None:
            check_range("samplers.optimization.max-width", self.max_width, 1e-3, 1)

    @property
    def tight(self) -> "OptimizationConfig":
        """Configuration for grasps with hardly any room for the fingers: centered, square to the box, and shallow."""
        offset, depth = (self.grip_offset[0], 1e-4), (self.depth[0], self.depth[0] + 0.004)
        return replace(self, grip_offset=offset, depth=depth, turn=1e-3, play=CLEARANCES[-1], clearance=0.0)

    def create(self, context: SamplerContext) -> "OptimizationSampler":
        """The sampler for one scene."""
        from ictamp_drake.skills.ik_sampler import OptimizationSampler

        return OptimizationSampler(context.world, context.arm, self)


@dataclass(frozen=True)
class GeometricConfig:
    """Constants of the sampler that draws k from geometry and at random, in turns.

    Attributes:
        turn: Number of candidates from geometry tried before random ones have their turn, and the other way round.
    """

    turn: int = 4

    def __post_init__(self) -> None:
        check_range("samplers.geometric.turn", self.turn, 1, 4096)

    def create(self, context: SamplerContext) -> "ChainSampler":
        """The sampler for one scene."""
        from ictamp_drake.skills.chain import ChainSampler
        from ictamp_drake.skills.geometric import GeometricSampler

        geometric = GeometricSampler(context.world, context.arm)
        return ChainSampler([geometric, UniformConfig().create(context)], self.turn)


@dataclass(frozen=True)
class PolicyConfig:
    """Constants of the sampler that draws k from the learned policy, which was trained with the Panda.

    Attributes:
        checkpoints: Folder of the trained policies. The default is the package's own.
        candidates: Number of candidates drawn at once. An attempt tries the best first until one has a motion, at most
            `skills.draws` of them. 1 is a plain draw, as in the paper.
        haste: Probability of success that one second less of travel time is worth [1/s]. With 0, Q alone ranks the
            candidates.
        trust: Maximum number of the policy's candidates tried before random ones have their turn. As many of the best
            random candidates are tried before the policy draws again. Where the policy was not trained, as many from
            geometry come before its own each time.
        belief: Minimum Q of a random candidate that is tried.
    """

    checkpoints: Path | None = None
    candidates: int = 64
    haste: float = 0.05
    trust: int = 4
    belief: float = 0.5
    robot: ClassVar[str] = DEFAULT
    stand_in: ClassVar[str] = "geometric"

    def __post_init__(self) -> None:
        check_range("samplers.policy.candidates", self.candidates, 1, 4096)
        check_range("samplers.policy.haste", self.haste, 0, 1)
        check_range("samplers.policy.trust", self.trust, 1, 4096)
        check_range("samplers.policy.belief", self.belief, 0, 1)

    def create(self, context: SamplerContext) -> "PolicySampler":
        """The sampler for one scene.

        Raises:
            IctampError: A checkpoint is missing, damaged or of another kind.
        """
        from ictamp_drake.learning.models import load_skill
        from ictamp_drake.skills.policy import PolicySampler

        folder = self.checkpoints or SHIPPED
        models = {skill: load_skill(folder, skill) for skill in SKILLS}
        return PolicySampler(context.world, context.arm, models, self)

    def check(self) -> None:
        """Check the checkpoints and raise the errors of `create`, without loading torch."""
        check_all(self.checkpoints or SHIPPED, "policy")


@dataclass(frozen=True)
class PickConfig:
    """Constants of a pick.

    Attributes:
        force: Minimum grip force of each finger [N], or the hand's limit if that is lower. A heavy or smooth box is
            gripped harder, up to that limit.
        safety: Ratio of the load that the friction of the fingers can bear to the load of the box at rest.
        clearances: Distances between box and fingers as the hand comes down [m]. The first one that the neighbors leave
            room for is used.
        margin: Height of the finger tips above the box before they are lowered [m].
        lift: Rise of the hand with the box [m].
    """

    force: float = LEAST_FORCE
    safety: float = SAFETY
    clearances: tuple[float, ...] = CLEARANCES
    margin: float = 0.015
    lift: float = LIFT

    def __post_init__(self) -> None:
        check_fields(self, "skills.pick", force=(0.1, 1e4), safety=(0, 100), margin=(0, 1), lift=(1e-3, 1))
        check_clearances("skills.pick.clearances", self.clearances)

    def create(self, context: SkillContext) -> "Pick":
        """The skill in one scene."""
        from ictamp_drake.skills.pick import Pick

        return Pick(context.world, context.planner, self)


@dataclass(frozen=True)
class PlaceConfig:
    """Constants of a placement.

    Attributes:
        clearances: Distances between box and fingers as the hand leaves [m]. The first one that the neighbors leave
            room for is used.
        drop: Height above its final place from which the box is lowered straight down [m].
        margin: Height of the finger tips above the box after the retreat [m].
    """

    clearances: tuple[float, ...] = CLEARANCES
    drop: float = 0.04
    margin: float = 0.015

    def __post_init__(self) -> None:
        check_fields(self, "skills.place", drop=(0, 1), margin=(0, 1))
        check_clearances("skills.place.clearances", self.clearances)

    def create(self, context: SkillContext) -> "Place":
        """The skill in one scene."""
        from ictamp_drake.skills.place import Place

        return Place(context.world, context.planner, self)


@dataclass(frozen=True)
class SkillsConfig:
    """Constants of a low-level step.

    Attributes:
        draws: Maximum number of parameters k drawn in one attempt until one has a motion. 1 is as in the paper.
        look_ahead: Number of the sampler's placements, and then of random ones, among which an attempt prefers those
            from which the hand will reach what the plan stacks on top later. 0 turns looking ahead off.
        pick: Constants of ψ_pick.
        place: Constants of ψ_place.
        motion: Constants of motion planning.
    """

    draws: int = 8
    look_ahead: int = 0
    pick: Annotated[SkillConfig, tyro.conf.arg(constructor=PickConfig)] = PickConfig()
    place: Annotated[SkillConfig, tyro.conf.arg(constructor=PlaceConfig)] = PlaceConfig()
    motion: MotionConfig = MotionConfig()

    def __post_init__(self) -> None:
        check_range("skills.draws", self.draws, 1, inf)
        check_range("skills.look-ahead", self.look_ahead, 0, inf)

    def create(
        self, world: "World", abstraction: "SceneAbstraction", physics: "Physics", sampler: SamplerConfig
    ) -> "Skills":
        """The skills in one scene."""
        from ictamp_drake.motion.planner import MotionPlanner
        from ictamp_drake.skills.areas import AreaSampler
        from ictamp_drake.skills.lookahead import Lookahead
        from ictamp_drake.skills.runner import Skills

        planner = MotionPlanner(world, self.motion, physics.config.time_step)
        configs: dict[str, SkillConfig] = {"pick": self.pick, "place": self.place}
        skills = {name: config.create(SkillContext(world, planner)) for name, config in configs.items()}
        context = SamplerContext(world, planner.kinematics)
        drawing: Sampler[Configuration] = sampler.create(context)
        random: Sampler[Configuration] = UniformConfig().create(context)
        if world.spec.areas:
            drawing, random = AreaSampler(world, drawing, random), AreaSampler(world, random, random)
        place = self.place if isinstance(self.place, PlaceConfig) else PlaceConfig()
        lookahead = Lookahead(world, planner.kinematics, random, self.look_ahead, place) if self.look_ahead else None
        return Skills(self.draws, abstraction, physics, drawing, skills, lookahead)
