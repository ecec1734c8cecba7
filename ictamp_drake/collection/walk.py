"""Random walks through the states that planning meets, which record the attempts on the way."""

from collections.abc import Callable, Collection, Iterator
from dataclasses import asdict, dataclass, replace
from functools import partial
from itertools import count
from pathlib import Path

import numpy as np

from ictamp_drake.collection.shards import Shards
from ictamp_drake.core.checks import check_range
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.protocols import Sampler
from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.core.types import Action, Attempt, Configuration, Skeleton, State
from ictamp_drake.learning.dataset import AttemptRow, scene_text
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.scenes.training import training_scene
from ictamp_drake.skills.config import OptimizationConfig, PolicyConfig, SkillsConfig, UniformConfig
from ictamp_drake.skills.context import SamplerContext
from ictamp_drake.skills.perturbed import PerturbedConfig, PerturbedSampler
from ictamp_drake.skills.uniform import UniformSampler
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.start import start_configuration
from ictamp_drake.world.world import World


@dataclass(frozen=True)
class Sources:
    """Weights of the sources of k; each attempt draws its source in proportion to them.

    Attributes:
        optimization: Weight of the optimization-based sampler.
        perturbed: Weight of the optimization-based sampler with noise.
        uniform: Weight of k drawn anywhere on the target.
        policy: Weight of a plain draw from the trained policy, as in the paper.
        best: Weight of the k with the highest Q among 16 draws from the policy.
        product: Weight of the k with the highest Q among those of 16 draws from the policy that have a motion.
        reference: Weight of a plain draw from another trained policy.
    """

    optimization: float = 0.1
    perturbed: float = 0.65
    uniform: float = 0.25
    policy: float = 0.0
    best: float = 0.0
    product: float = 0.0
    reference: float = 0.0

    def __post_init__(self) -> None:
        for name, weight in asdict(self).items():
            check_range(f"walk.sources.{name}", weight, 0, 1e6)
        check_range("walk.sources", sum(asdict(self).values()), 1e-9, 1e9)

    @property
    def weights(self) -> dict[str, float]:
        """Weights above zero, by name."""
        return {name: weight for name, weight in asdict(self).items() if weight > 0}


@dataclass(frozen=True)
class WalkConfig:
    """Settings of a random walk and its attempts.

    Attributes:
        states: Number of rounds of a walk. Each round draws one high-level action and tries it from one configuration.
        draws: Number of attempts in a round, each with its own k.
        sources: Weights of the sources of k.
        compare: Make the attempts of every round from each of the sources, so that the sources can be compared.
        checkpoints: Folder of the trained policy; by default the one in the package.
        reference: Folder of the policy that the source `reference` draws from.
        stray: Probability that the walk continues from the end of a failed round rather than from its start.
        patience: Number of failed rounds in a row after which the walk returns to an earlier configuration.
        on_support: Probability that a box is placed on a support when it could also be placed on a box.
        noise: Noise of the source `perturbed`.
        drop: Maximum height of a placement from the source `uniform` [m].
    """

    states: int = 24
    draws: int = 4
    sources: Sources = Sources()
    compare: bool = False
    checkpoints: Path | None = None
    reference: Path | None = None
    stray: float = 0.3
    patience: int = 3
    on_support: float = 0.5
    noise: PerturbedConfig = PerturbedConfig()
    drop: float = 0.05

    def __post_init__(self) -> None:
        check_range("walk.states", self.states, 1, 1e4)
        check_range("walk.draws", self.draws, 1, 1e4)
        if self.sources.reference and self.reference is None:
            problem = "expected a folder of checkpoints, since walk.sources.reference is above 0"
            raise IctampError(Code.CONFLICT, problem, field="walk.reference")

    def check(self) -> None:
        """Raise IctampError at once, rather than in every scene, when a trained policy cannot be loaded."""
        for source in self.sources.weights:
            if source in _LEARNED:
                self.choose_policy(source).check()

    def choose_policy(self, source: str) -> PolicyConfig:
        """Configuration with which a source draws from a trained policy."""
        folder = self.reference if source == "reference" else self.checkpoints
        candidates = _CANDIDATES if source in ("best", "product") else 1
        return PolicyConfig(folder, candidates, haste=0.0, trust=_CANDIDATES)


_LEARNED = ("policy", "best", "product", "reference")
_CANDIDATES = 16
"""Number of draws of which the best is taken."""


def walk(
    number: int,
    seed: int,
    config: WalkConfig,
    *,
    spared: Collection[int] = (),
    begin: Callable[[int], None] = lambda _: None,
) -> list[AttemptRow]:
    """Walk through one training scene and record the attempts; the same arguments give the same rows, except for times.

    Args:
        number: Number of the scene.
        seed: Random seed of scenes and walks.
        config: Settings of the walk.
        spared: Numbers of attempts to skip, since the process died or hung in them.
        begin: Function called with the number of each attempt before it is made.

    Returns:
        Rows of the attempts; none when the scene is not at rest at its start.
    """
    spec = training_scene(number, seed)
    try:
        course = _Course(spec, config, generator(Stream.DATA, seed, number))
    except IctampError:
        return []
    text = scene_text(spec)
    return [AttemptRow(number, text, *each) for each in course.attempts(spared, begin)]


class _Course:
    """One scene, with everything needed to walk through it."""

    def __init__(self, spec: SceneSpec, config: WalkConfig, rng: np.random.Generator) -> None:
        self._config = config
        self._rng = rng
        self._world = World(spec)
        self._arm = ArmKinematics(self._world.robot, to_transform(spec.arm.X_WB))
        self._abstraction = SceneAbstraction(self._world)
        self._physics = PhysicsConfig().create(self._world)
        plain = SkillsConfig(draws=1).create(self._world, self._abstraction, self._physics, OptimizationConfig())
        self._sources = {
            source: replace(
                plain, sampler=self._sampler(source, plain.sampler), draws=_CANDIDATES if source == "product" else 1
            )
            for source in config.sources.weights
        }
        self._domains: dict[State, Domain] = {}
        self._met = [start_configuration(self._world, self._abstraction, self._physics)[0]]
        self._drawn = [0]

    def _sampler(self, source: str, optimization: Sampler[Configuration]) -> Sampler[Configuration]:
        config, world = self._config, self._world
        if source == "perturbed":
            return PerturbedSampler(world, optimization, config.noise)
        if source == "uniform":
            return UniformSampler(world, UniformConfig(max_height=config.drop))
        if source in _LEARNED:
            return config.choose_policy(source).create(SamplerContext(world, self._arm))
        return optimization

    def attempts(
        self, spared: Collection[int], begin: Callable[[int], None]
    ) -> Iterator[tuple[int, int, str, Configuration, Attempt[Configuration]]]:
        """Walk, and yield the state, draw, sampler, c and attempt of each attempt on the way."""
        here, failed = 0, 0
        numbers = count()
        for _ in range(self._config.states):
            step = self._draw_step(self._met[here])
            tried = []
            for source in self._round():
                number = next(numbers)
                if number in spared:
                    continue
                begin(number)
                attempt = self._sources[source].attempt(self._met[here], step, self._rng)
                tried.append(attempt)
                yield here, self._drawn[here], source, self._met[here], attempt
                self._drawn[here] += 1
            failed = 0 if any(attempt.succeeded for attempt in tried) else failed + 1
            onward = self._choose_next(tried)
            if onward is not None:
                self._met.append(onward)
                self._drawn.append(0)
                here = len(self._met) - 1
            elif failed >= self._config.patience:
                here, failed = int(self._rng.integers(len(self._met))), 0

    def _round(self) -> Iterator[str]:
        """Sources of the attempts of one round."""
        names, weights = zip(*self._config.sources.weights.items(), strict=True)
        for _ in range(self._config.draws):
            if self._config.compare:
                yield from names
            else:
                yield str(self._rng.choice(names, p=np.divide(weights, sum(weights))))

    def _draw_step(self, c: Configuration) -> Skeleton:
        """Draw an applicable action, as a plan of one step."""
        options = list(self._successors(c))
        supports = self._world.spec.supports
        apart = [[o for o in options if (o[0].args[1] in supports) == wanted] for wanted in (False, True)]
        if options[0][0].name == "place" and all(apart):
            options = apart[int(self._rng.random() < self._config.on_support)]
        action, promised = options[self._rng.integers(len(options))]
        return Skeleton((self._abstraction(c), promised), (action,))

    def _choose_next(self, tried: list[Attempt[Configuration]]) -> Configuration | None:
        """Choose the end of a success, or sometimes of a failure, if planning could continue from there."""
        ends = [attempt.successor for attempt in tried if attempt.succeeded]
        if not ends and self._rng.random() < self._config.stray:
            ends = [self._settle(attempt.successor) for attempt in tried]
        known = [c for c in ends if c is not None and self._successors(c)]
        return known[self._rng.integers(len(known))] if known else None

    def _settle(self, c: Configuration | None) -> Configuration | None:
        """Let c come to rest, since a failed attempt can end in the middle of its motion; None when it cannot."""
        if c is None:
            return None
        try:
            outcome = self._physics.run(c, ())
        except RuntimeError:  # the contact solver diverges in a few jammed situations
            return None
        return outcome.c if outcome.settled else None

    def _successors(self, c: Configuration) -> tuple[tuple[Action, State], ...]:
        """Applicable actions; none in a state that the domain does not know, e.g. when a box leans on another."""
        state = self._abstraction(c)
        posture = frozenset(atom for atom in state if atom.predicate in ("upright", "tipped"))
        spec = self._world.spec
        try:
            known = self._domains.get(posture) or Domain.create(sorted(spec.boxes), sorted(spec.supports), state)
        except IctampError:
            return ()
        self._domains[posture] = known
        return known.successors(state)


def write_walk(out: Path, scene: int, seed: int, config: WalkConfig, spared: Collection[int]) -> tuple[int, int]:
    """Walk through a scene, write the attempts to a folder, and return the numbers of attempts and of executions."""
    shards = Shards(out)
    rows = walk(scene, seed, config, spared=spared, begin=partial(shards.begin, scene))
    shards.add(scene, rows)
    return len(rows), sum(bool(row.attempt.motion) for row in rows)
