"""What a search learns about its own steps: how likely they succeed, and how long they take to compute."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from functools import cache
from statistics import fmean
from typing import Generic

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.protocols import Estimator
from ictamp_drake.core.types import Action, C, Skeleton, State
from ictamp_drake.planning.estimates import Estimates
from ictamp_drake.planning.rule import RunStep
from ictamp_drake.planning.tree import Step, Tree


@dataclass(frozen=True)
class BeliefsConfig:
    """Constants of the Beta beliefs.

    Attributes:
        strength: attempts that the prior P is worth (`python benchmarks/beliefs.py`).
        transfer: what an attempt of the same action from another node is worth.
        floor: least prior, so that no step is ever given up.
        hope: P of an action before any of its name was estimated.
        duration: computing time of a step before any of its name succeeded [s].
        step: what a step counts for besides its computing time, so that those which are refused at once are not
            repeated hundreds of times [s].
    """

    strength: float = 4.0
    transfer: float = 0.25
    floor: float = 0.1
    hope: float = 0.9
    duration: float = 0.5
    step: float = 0.03

    def __post_init__(self) -> None:
        for name in ("strength", "floor", "hope", "duration"):
            if not getattr(self, name) > 0:
                raise IctampError(f"{name} of the beliefs is {getattr(self, name)}, but must be more than 0.")
        for name in ("transfer", "step"):
            if not getattr(self, name) >= 0:
                raise IctampError(f"{name} of the beliefs is {getattr(self, name)}, but must be 0 or more.")


class Beliefs(Generic[C]):
    """Beta beliefs about each edge (s, a) from each node, with P as the prior and the attempts as evidence.

    A node that is not reached yet may be any of those that were and hold the same edge, or one from which P is what it
    mostly is for actions of this name.
    """

    def __init__(self, config: BeliefsConfig, estimator: Estimator[C]) -> None:
        self._config = config
        self._estimates = Estimates(estimator)
        self._P: defaultdict[_Edge, dict[int, float]] = defaultdict(dict)
        self._here: defaultdict[tuple[int, Action], _Evidence] = defaultdict(_Evidence)
        self._anywhere: defaultdict[_Edge, _Evidence] = defaultdict(_Evidence)
        self._usual: defaultdict[str, _Mean] = defaultdict(_Mean)
        self._seconds: defaultdict[tuple[str, bool], _Mean] = defaultdict(_Mean)

    def learn(self, tree: Tree[C], step: Step[C]) -> None:
        """Take in an attempt; a failed one counts as often as it tried a k.

        One that finished a plan which was then refused as a whole is a failure.
        """
        action = step.attempt.action
        success = step.child is not None and tree.candidates.get(step.child, True)
        tried = 1 if success else len(step.attempt.rejections) + 1
        self._here[step.node, action].add(success, tried)
        self._anywhere[tree.nodes[step.node].s, action].add(success, tried)
        self._seconds[action.name, success].add(step.attempt.effort)

    def remaining(self, tree: Tree[C], runs: Sequence[RunStep]) -> list[float]:
        """Computing time that running each plan from its node is believed to take until the plan is finished [s]."""
        estimates = [max(self._config.floor, P) for P in self._estimates.of(tree, runs)]
        steps = [(run, _edges(tree.plans[run.plan])[0], P) for run, P in zip(runs, estimates, strict=True)]
        for run, edge, P in steps:
            self._note(edge, run.node, P)
        ahead = cache(self._ahead)
        rest = {run.plan: sum(map(ahead, _edges(tree.plans[run.plan])[1:])) for run in runs}
        return [self._first(run.node, edge, P) + rest[run.plan] for run, edge, P in steps]

    def hoped(self, plan: Skeleton) -> float:
        """What `remaining` would be had nothing been attempted yet [s]."""
        return sum(self._time(action, self._hope(action)) for action in plan.actions)

    def _note(self, edge: "_Edge", node: int, P: float) -> None:
        """Keep an estimate; as that of a step never changes, the first one stays."""
        if node not in self._P[edge]:
            self._P[edge][node] = P
            self._usual[edge[1].name].add(P)

    def _first(self, node: int, edge: "_Edge", P: float) -> float:
        """Time of an action from this node: attempts from here count in full."""
        _, action = edge
        return self._time(action, self._posterior(P, self._anywhere[edge], self._here[node, action]))

    def _ahead(self, edge: "_Edge") -> float:
        """Time of an action from a node that is not reached yet: the mean over all that it may be."""
        _, action = edge
        estimates = [self._hope(action), *self._P[edge].values()]
        return fmean(self._time(action, self._posterior(P, self._anywhere[edge])) for P in estimates)

    def _hope(self, action: Action) -> float:
        """Mean P of actions of its name."""
        return self._usual[action.name].or_else(self._config.hope)

    def _posterior(self, P: float, anywhere: "_Evidence", here: "_Evidence | None" = None) -> float:
        """Mean of Beta(strength * P + successes, strength * (1 - P) + failures)."""
        own, transfer, strength = here or _Evidence(), self._config.transfer, self._config.strength
        successes = own.successes + transfer * (anywhere.successes - own.successes)
        attempts = own.attempts + transfer * (anywhere.attempts - own.attempts)
        return (strength * P + successes) / (strength + attempts)

    def _time(self, action: Action, belief: float) -> float:
        """Of repeating the action until it succeeds: 1 / belief - 1 failures on average, and then the success."""
        success = self._seconds[action.name, True].or_else(self._config.duration)
        failure = self._seconds[action.name, False].or_else(success)
        return success + self._config.step + (1 / belief - 1) * (failure + self._config.step)


_Edge = tuple[State, Action]
"""An edge of the high-level graph."""


def _edges(plan: Skeleton) -> list[_Edge]:
    return list(zip(plan.states, plan.actions, strict=False))


@dataclass
class _Evidence:
    attempts: int = 0
    successes: int = 0

    def add(self, success: bool, tried: int) -> None:
        self.attempts += tried
        self.successes += success


@dataclass
class _Mean:
    total: float = 0.0
    count: int = 0

    def add(self, value: float) -> None:
        self.total += value
        self.count += 1

    def or_else(self, value: float) -> float:
        """The mean, or the value when there is none."""
        return self.total / self.count if self.count else value
