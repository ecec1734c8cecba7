"""Events that a planner sends to its listeners: progress, records and Meshcat. The planner knows none of them."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic

from ictamp_drake.core.types import Action, Attempt, C, Skeleton
from ictamp_drake.planning.tree import Node


@dataclass(frozen=True)
class PlanOpened:
    """The plan generator was called once.

    Attributes:
        plan: New plan, or None when the call ended without one.
        expanded: Number of nodes expanded in this call.
        exhausted: True when there are no further plans.
    """

    plan: Skeleton | None
    expanded: int
    exhausted: bool


@dataclass(frozen=True)
class StepStarted(Generic[C]):
    """A low-level step begins: `action` is about to be attempted from `node`."""

    node: Node[C]
    action: Action


@dataclass(frozen=True)
class StepDone(Generic[C]):
    """A low-level step has ended.

    Attributes:
        node: Node from which the step started.
        attempt: Attempt, with its outcome.
        child: New node, or None when the attempt failed.
    """

    node: Node[C]
    attempt: Attempt[C]
    child: Node[C] | None


@dataclass(frozen=True)
class Verified(Generic[C]):
    """A finished plan was verified as a whole, after all its skills were executed.

    Attributes:
        node: Node at the goal.
        path: Attempts from the root to the node.
        verified: False when verification failed; the search then continues.
    """

    node: Node[C]
    path: tuple[Attempt[C], ...]
    verified: bool


@dataclass(frozen=True)
class PlanFound(Generic[C]):
    """A verified plan is the best so far, and the search goes on.

    Attributes:
        path: Attempts from the root to the goal.
        seconds: Time since the start of the search [s].
    """

    path: tuple[Attempt[C], ...]
    seconds: float


Event = PlanOpened | StepStarted[Any] | StepDone[Any] | Verified[Any] | PlanFound[Any]
Listener = Callable[[Event], None]
