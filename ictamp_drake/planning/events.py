"""What a planner tells its listeners. Progress, records and Meshcat listen; the planner knows none of them."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any, Generic

from ictamp_drake.core.types import Action, Attempt, C, Skeleton
from ictamp_drake.planning.tree import Node


@dataclass(frozen=True)
class PlanOpened:
    """The plan generator was called once.

    Attributes:
        plan: the new plan, None when the call ended without one.
        expanded: nodes expanded in this call.
        exhausted: True when no further plan can come.
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
        node: where it started.
        attempt: what came of it.
        child: the new node, None when the attempt failed.
    """

    node: Node[C]
    attempt: Attempt[C]
    child: Node[C] | None


@dataclass(frozen=True)
class Verified(Generic[C]):
    """A finished plan was judged after its skills had been executed.

    Attributes:
        node: the node at the goal.
        path: the attempts from the root to it.
        verified: False when the check failed; the search then goes on.
    """

    node: Node[C]
    path: tuple[Attempt[C], ...]
    verified: bool


Event = PlanOpened | StepStarted[Any] | StepDone[Any] | Verified[Any]
Listener = Callable[[Event], None]
