"""The plug-in points. Each is one or two methods; one file per implementation, one contract test for all.

A part comes from a `Config`, a frozen dataclass of its constants. What core does not know is a type parameter here: the
tree, why there is no motion, what a part is made from.
"""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, NamedTuple, Protocol, TypeVar, runtime_checkable

import numpy as np

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import (
    Action,
    Attempt,
    C,
    Configuration,
    FloatArray,
    Motion,
    Obstruction,
    Parameter,
    Skeleton,
    State,
)

C_contra = TypeVar("C_contra", bound=Hashable, contravariant=True)
Context_contra = TypeVar("Context_contra", contravariant=True)
Option_co = TypeVar("Option_co", covariant=True)
Part_co = TypeVar("Part_co", covariant=True)
Refusal_co = TypeVar("Refusal_co", covariant=True)
Tree_contra = TypeVar("Tree_contra", contravariant=True)


@runtime_checkable
class Config(Protocol[Context_contra, Part_co]):
    """Configuration of a part: a frozen dataclass of its constants. Parts of all kinds are made by the same call."""

    def create(self, context: Context_contra, /) -> Part_co:
        """The part for one search, made from what its kind is given."""


@runtime_checkable
class Learned(Protocol):
    """Configuration of a part that needs trained networks."""

    def check(self) -> None:
        """Raise IctampError when the networks are missing or damaged, without loading torch."""


class PlanGenerator(Protocol):
    """A resumable search for high-level plans from one start state."""

    @property
    def exhausted(self) -> bool:
        """True when no further plan can come."""

    @property
    def expanded(self) -> int:
        """Nodes expanded since the start."""

    def next_plan(self, max_expansions: int, obstructions: frozenset[Obstruction] = frozenset()) -> Skeleton | None:
        """Expand at most `max_expansions` nodes and return the first new plan met (Algorithm 3), else None.

        Args:
            max_expansions: in this call.
            obstructions: what the plan is to get out of the way, as far as the generator can see to it.
        """


class Abstraction(Protocol[C_contra]):
    """H: C -> S."""

    def __call__(self, c: C_contra) -> State:
        """The symbolic state of c, evaluated, never assumed."""


class SkillRunner(Protocol[C]):
    """ψ, all skills behind one door: the planner says which action, the runner tries it once."""

    @property
    def draws(self) -> int:
        """Parameters k that an attempt draws at most, until one has a motion."""

    def attempt(
        self, c: C, action: Action, promised: State, rng: np.random.Generator, k: Parameter | None = None
    ) -> Attempt[C]:
        """Run ψ_a once from c, with k or one that is drawn; the attempt succeeds when H(c') equals `promised`."""


class Estimator(Protocol[C_contra]):
    """P: estimated probability that ψ_a, run from c, ends in the state that a promises."""

    def estimate(self, options: Sequence[tuple[C_contra, Skeleton]]) -> FloatArray:
        """P of running the first action of each plan from c, in one call, shape (len(options),), each in [0, 1].

        A plan starts in H(c) and has an action at least. Those after the first are of interest to estimators that
        look ahead.
        """


class PlanParameters(NamedTuple):
    """What was found for a whole plan.

    Attributes:
        value: estimated probability that all of it succeeds.
        k: of its actions, shape (len(plan), 4).
    """

    value: float
    k: FloatArray


@runtime_checkable
class PlanOptimizer(Protocol[C_contra]):
    """An estimator that can also say with which parameters a whole plan is the most likely to succeed."""

    def optimize(self, options: Sequence[tuple[C_contra, Skeleton]], rng: np.random.Generator) -> list[PlanParameters]:
        """The best parameters that were found for each plan from its configuration."""


class Sampler(Protocol[C_contra]):
    """A source of skill parameters k."""

    def draws(self, c: C_contra, action: Action, rng: np.random.Generator) -> Iterator[Parameter | Failure]:
        """Any number of k for the action from c, the most promising first, or why there is none.

        An attempt takes them one after the other until it has a motion. It ends with a failure, whatever comes after.
        """


class Skill(Protocol[Refusal_co]):
    """ψ_a, what turns k into a motion."""

    def plan(self, c: Configuration, action: Action, k: Parameter, rng: np.random.Generator) -> Motion | Refusal_co:
        """The motion that carries out the action from c with parameter k, or what is in its way."""

    def promise(self, c: Configuration, action: Action, k: Parameter, motion: Motion) -> Configuration:
        """Where the motion ends if all goes well; asked only when plans run in physics as a whole."""


class SelectionRule(Protocol[Tree_contra, Option_co]):
    """A search strategy. One rule serves one search, so it may remember what it computed for a node."""

    def choose(self, tree: Tree_contra, rng: np.random.Generator, /) -> Option_co:
        """The next computational action.

        Called while there is anything to do: the generator is not exhausted, or a plan is open. A rule that rolls
        plans out looks at `tree.log[-1]`: whatever comes next is its own decision after every single step.
        """


@dataclass(frozen=True)
class RuleContext(Generic[C]):
    """What a selection rule is made from.

    Attributes:
        estimator: P.
    """

    estimator: Estimator[C]


@runtime_checkable
class NeedsEstimator(Protocol):
    """Configuration of a rule that works with one estimator only, whatever else is chosen."""

    @property
    def estimator(self) -> tuple[str, Mapping[str, object]]:
        """Name of the estimator, and the constants of it that the rule sets."""


class Guide(Protocol):
    """An order of the search for high-level plans, see `symbolic.skeletons.PlanStream`."""

    @property
    def horizon(self) -> float:
        """Plans of up to this many actions are ordered rightly; raised by `grow`."""

    def estimate_distance(self, state: State) -> float:
        """Actions from the state to the goal, as far as known; infinite when no way is known."""

    def grow(self) -> None:
        """Expand one state to learn more; called only while the horizon is finite."""
