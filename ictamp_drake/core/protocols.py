"""The plug-in points. Each is one or two methods; one file per implementation, one contract test for all."""

from collections.abc import Hashable, Iterator, Sequence
from typing import NamedTuple, Protocol, TypeVar, runtime_checkable

import numpy as np

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Attempt, C, FloatArray, Obstruction, Parameter, Skeleton, State

C_contra = TypeVar("C_contra", bound=Hashable, contravariant=True)


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
