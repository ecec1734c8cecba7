"""Protocols of the replaceable parts. Each has one or two methods, and one contract test for all implementations.

A `Config`, a frozen dataclass of a part's constants, creates the part. Types that core does not know are type
parameters here: the tree, the refusal of a motion, the context from which a part is created.
"""

from collections.abc import Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Generic, NamedTuple, Protocol, TypeVar, runtime_checkable

import numpy as np
from numpy.typing import NDArray

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
    """Configuration of a part: a frozen dataclass of its constants. Parts of all kinds are created by the same call."""

    def create(self, context: Context_contra, /) -> Part_co:
        """Create the part for one search from the context that parts of its kind receive."""


@runtime_checkable
class Learned(Protocol):
    """Configuration of a part that needs trained networks."""

    def check(self) -> None:
        """Raise IctampError when the networks are missing or damaged, without loading torch."""


@runtime_checkable
class Trained(Protocol):
    """Configuration of a part that was trained with one robot; with other robots, another part serves in its place."""

    @property
    def robot(self) -> str:
        """Name of the robot that the part was trained with."""

    @property
    def stand_in(self) -> str:
        """Name of the part that serves with other robots."""


@runtime_checkable
class Selective(Protocol[C_contra]):
    """A sampler that serves some actions only, e.g. those that are like the ones it was trained for."""

    def applies(self, c: C_contra, action: Action) -> bool:
        """Whether the part serves the action from c."""


class PlanGenerator(Protocol):
    """A resumable search for high-level plans from one start state."""

    @property
    def exhausted(self) -> bool:
        """Whether no further plan can come."""

    @property
    def expanded(self) -> int:
        """Number of nodes expanded since the start."""

    def next_plan(self, max_expansions: int, obstructions: frozenset[Obstruction] = frozenset()) -> Skeleton | None:
        """Expand at most `max_expansions` nodes and return the first new plan found (Algorithm 3), else None.

        Args:
            max_expansions: Limit for this call.
            obstructions: Boxes that the plan should move out of the way, if the generator supports that.
        """


class InverseKinematics(Protocol):
    """Inverse kinematics of one arm."""

    @property
    def free(self) -> int | None:
        """Index of the joint whose angles the caller chooses, or None: an arm of seven joints has one too many."""

    @property
    def finds_all(self) -> bool:
        """Whether no posture at the given angles is missed, so that a pose without one is out of reach."""

    def postures(
        self, X_BG: FloatArray, angles: FloatArray, limits: FloatArray, /
    ) -> tuple[FloatArray, NDArray[np.intp]]:
        """Return all known postures with the hand at each pose, in any order that is the same each time.

        Args:
            X_BG: Poses of G in the arm's base frame, shape (n, 4, 4).
            angles: Angles of the free joint, all tried for every pose, shape (a,) [rad]. Ignored if none is free.
            limits: Lower and upper limits of the joints, which may be infinite, shape (2, joints) [rad].

        Returns:
            Postures within the limits, shape (m, joints) [rad], and the number of each one's pose, shape (m,).
        """


class Abstraction(Protocol[C_contra]):
    """H: C -> S."""

    def __call__(self, c: C_contra) -> State:
        """Evaluate the symbolic state of c; it is never assumed."""


class SkillRunner(Protocol[C]):
    """ψ, all skills behind one interface: the planner chooses the plan, and the runner tries its first action once."""

    @property
    def draws(self) -> int:
        """Maximum number of parameters k that an attempt draws until one has a motion."""

    def attempt(self, c: C, plan: Skeleton, rng: np.random.Generator, k: Parameter | None = None) -> Attempt[C]:
        """Run ψ_a of the plan's first action once from c, with the given or a drawn k.

        The attempt succeeds when H(c') equals the state that the action promises, `plan.states[1]`.
        """


class Estimator(Protocol[C_contra]):
    """P: estimated probability that ψ_a, run from c, ends in the state that a promises."""

    def estimate(self, options: Sequence[tuple[C_contra, Skeleton]]) -> FloatArray:
        """Estimate P of the first action of each plan, run from c; shape (len(options),), each in [0, 1].

        A plan starts in H(c) and has at least one action. Later actions matter only to estimators that look ahead.
        """


class PlanParameters(NamedTuple):
    """Best parameters found for a whole plan.

    Attributes:
        value: Estimated probability that the whole plan succeeds.
        k: Parameters of the plan's actions, shape (len(plan), 4).
    """

    value: float
    k: FloatArray


@runtime_checkable
class PlanOptimizer(Protocol[C_contra]):
    """An estimator that can also find the parameters with which a whole plan is most likely to succeed."""

    def optimize(self, options: Sequence[tuple[C_contra, Skeleton]], rng: np.random.Generator) -> list[PlanParameters]:
        """Return the best parameters found for each plan from its configuration."""


class Sampler(Protocol[C_contra]):
    """A source of skill parameters k."""

    def draws(self, c: C_contra, action: Action, rng: np.random.Generator) -> Iterator[Parameter | Failure]:
        """Yield any number of k for the action from c, the most promising first, or the failure if there is none.

        An attempt tries them one after the other until one has a motion. A failure ends the attempt, whatever follows.
        """


class Skill(Protocol[Refusal_co]):
    """ψ_a, which turns k into a motion."""

    def plan(self, c: Configuration, action: Action, k: Parameter, rng: np.random.Generator) -> Motion | Refusal_co:
        """Return the motion that carries out the action from c with parameter k, or the reason why there is none."""

    def promise(self, c: Configuration, action: Action, k: Parameter, motion: Motion) -> Configuration:
        """Predict where the motion ends if all goes well; called only when plans run in physics as a whole."""


class SelectionRule(Protocol[Tree_contra, Option_co]):
    """A search strategy. One rule serves one search, so it may cache values of nodes."""

    def choose(self, tree: Tree_contra, rng: np.random.Generator, /) -> Option_co:
        """Choose the next computational action.

        Called as long as the generator is not exhausted or a plan is open. Rules decide anew after every single step;
        a rule that rolls plans out looks at `tree.log[-1]` to continue the rollout.
        """


@dataclass(frozen=True)
class RuleContext(Generic[C]):
    """Context from which a selection rule is created.

    Attributes:
        estimator: Estimator of P.
    """

    estimator: Estimator[C]


@runtime_checkable
class NeedsEstimator(Protocol):
    """Configuration of a rule that works with one estimator only, whichever the user chose."""

    @property
    def estimator(self) -> tuple[str, Mapping[str, object]]:
        """Name of the estimator, and the constants that the rule sets for it."""


class Guide(Protocol):
    """An order of the search for high-level plans, see `symbolic.skeletons.PlanStream`."""

    @property
    def horizon(self) -> float:
        """Number of actions up to which plans are ordered correctly; `grow` raises it."""

    def estimate_distance(self, state: State) -> float:
        """Estimate the number of actions from the state to the goal; infinite when no way is known."""

    def grow(self) -> None:
        """Expand one state to learn more; called only while the horizon is finite."""
