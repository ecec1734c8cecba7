"""Random walks through the states that planning meets, and what became of the attempts on the way."""

from collections.abc import Iterator
from dataclasses import dataclass, replace
from time import perf_counter

import numpy as np

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.failures import Failure
from ictamp_drake.core.protocols import Sampler
from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.core.types import Action, Attempt, Configuration, State
from ictamp_drake.learning.dataset import Row, scene_text
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.scenes.training import training_scene
from ictamp_drake.skills.optimisation import OptimisationConfig
from ictamp_drake.skills.perturbed import PerturbedConfig, PerturbedSampler
from ictamp_drake.skills.runner import Skills, SkillsConfig
from ictamp_drake.skills.uniform import UniformConfig, UniformSampler
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.world.abstraction import Abstraction
from ictamp_drake.world.simulate import PhysicsConfig
from ictamp_drake.world.start import start_configuration
from ictamp_drake.world.world import World


@dataclass(frozen=True)
class WalkConfig:
    """How attempts are drawn.

    Attributes:
        states: rounds of a walk; in each a high-level action is drawn and tried from one configuration.
        draws: attempts in a round, each with a k of its own.
        optimisation, perturbed, uniform: probabilities of the sources of k; they add up to one.
        stray: probability that the walk goes on from where a failed round ended rather than from where it began.
        patience: failed rounds in a row after which the walk goes back to a configuration that it met before.
        on_support: probability that a box is placed on a support when there is a box it could be placed on.
        noise: of the perturbed source.
        drop: greatest height of a placement of the uniform source [m].
    """

    states: int = 24
    draws: int = 4
    optimisation: float = 0.1
    perturbed: float = 0.65
    uniform: float = 0.25
    stray: float = 0.3
    patience: int = 3
    on_support: float = 0.5
    noise: PerturbedConfig = PerturbedConfig()
    drop: float = 0.05


def walk(number: int, seed: int, config: WalkConfig) -> list[Row]:
    """The attempts of a random walk in one training scene; the same arguments give the same rows apart from times.

    No rows when the scene is not at rest at its start.
    """
    spec = training_scene(number, seed)
    try:
        course = _Course(spec, config, generator(Stream.DATA, seed, number))
    except IctampError:
        return []
    text = scene_text(spec)
    return [Row(number, text, *each) for each in course.attempts()]


class _Course:
    """One scene with all that is needed to walk through it."""

    def __init__(self, spec: SceneSpec, config: WalkConfig, rng: np.random.Generator) -> None:
        self._config = config
        self._rng = rng
        self._world = World(spec)
        self._abstraction = Abstraction(self._world)
        self._physics = PhysicsConfig().create(spec)
        self._skills: Skills = SkillsConfig().create(
            self._world, self._abstraction, self._physics, OptimisationConfig()
        )
        self._samplers: dict[str, Sampler[Configuration]] = {
            "optimisation": self._skills.sampler,
            "perturbed": PerturbedSampler(self._world, self._skills.sampler, config.noise),
            "uniform": UniformSampler(self._world, UniformConfig(max_height=config.drop)),
        }
        self._domains: dict[State, Domain] = {}
        self._met = [start_configuration(self._world, self._abstraction, self._physics, spec.description)]
        self._drawn = [0]

    def attempts(self) -> Iterator[tuple[int, int, str, Configuration, Attempt[Configuration]]]:
        """State, draw, sampler, c and what came of it, for each attempt of the walk."""
        here, failed = 0, 0
        for _ in range(self._config.states):
            action, promised = self._action(self._met[here])
            tried = []
            for _ in range(self._config.draws):
                sampler, attempt = self._attempt(self._met[here], action, promised)
                tried.append(attempt)
                yield here, self._drawn[here], sampler, self._met[here], attempt
                self._drawn[here] += 1
            failed = 0 if any(attempt.succeeded for attempt in tried) else failed + 1
            onward = self._onward(tried)
            if onward is not None:
                self._met.append(onward)
                self._drawn.append(0)
                here = len(self._met) - 1
            elif failed >= self._config.patience:
                here, failed = int(self._rng.integers(len(self._met))), 0

    def _action(self, c: Configuration) -> tuple[Action, State]:
        """An applicable action and the state that it promises."""
        options = list(self._successors(c))
        supports = self._world.spec.supports
        apart = [[o for o in options if (o[0].args[1] in supports) == wanted] for wanted in (False, True)]
        if options[0][0].name == "place" and all(apart):
            options = apart[int(self._rng.random() < self._config.on_support)]
        return options[self._rng.integers(len(options))]

    def _attempt(self, c: Configuration, action: Action, promised: State) -> tuple[str, Attempt[Configuration]]:
        config = self._config
        weights = [config.optimisation, config.perturbed, config.uniform]
        sampler = str(self._rng.choice(list(self._samplers), p=weights))
        started = perf_counter()
        k = self._samplers[sampler].sample(c, action, self._rng)
        seconds = {"sampling": perf_counter() - started}
        if isinstance(k, Failure):
            return sampler, Attempt(action, k, seconds=seconds)
        attempt = self._skills.execute(c, action, k, promised, self._rng)
        return sampler, replace(attempt, seconds={**attempt.seconds, **seconds})

    def _onward(self, tried: list[Attempt[Configuration]]) -> Configuration | None:
        """Where one of the successes, or now and then of the failures, ended, if planning could go on from there."""
        ends = [attempt.successor for attempt in tried if attempt.succeeded]
        if not ends and self._rng.random() < self._config.stray:
            ends = [self._settled(attempt.successor) for attempt in tried]
        known = [c for c in ends if c is not None and self._successors(c)]
        return known[self._rng.integers(len(known))] if known else None

    def _settled(self, c: Configuration | None) -> Configuration | None:
        """c at rest, since a failed attempt can end in the midst of its motion."""
        if c is None:
            return None
        try:
            outcome = self._physics.run(c, ())
        except RuntimeError:  # the contact solver diverges in a few jammed situations
            return None
        return outcome.c if outcome.settled else None

    def _successors(self, c: Configuration) -> tuple[tuple[Action, State], ...]:
        """Applicable actions, none in a state that the domain does not know, e.g. when a box leans on another."""
        state = self._abstraction(c)
        posture = frozenset(atom for atom in state if atom.predicate in ("upright", "tipped"))
        spec = self._world.spec
        try:
            known = self._domains.get(posture) or Domain.create(sorted(spec.boxes), sorted(spec.supports), state)
        except IctampError:
            return ()
        self._domains[posture] = known
        return known.successors(state)
