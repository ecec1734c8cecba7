"""What a search learns about its own steps: how likely they succeed, and how long they take to compute."""

from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
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
        self._seconds: defaultdict[tuple[str, bool], list[float]] = defaultdict(list)

    def learn(self, tree: Tree[C], step: Step[C]) -> None:
        """Take in an attempt; a failed one counts as often as it tried a k.

        One that finished a plan which was then refused as a whole is a failure.
        """
        action = step.attempt.action
        success = step.child is not None and tree.candidates.get(step.child, True)
        tried = 1 if success else len(step.attempt.rejections) + 1
        self._here[step.node, action].add(success, tried)
        self._anywhere[tree.nodes[step.node].s, action].add(success, tried)
        self._seconds[action.name, success].append(step.attempt.effort)

    def remaining(self, tree: Tree[C], runs: Sequence[RunStep]) -> list[float]:
        """Computing time that running each plan from its node is believed to take until the plan is finished [s]."""
        estimates = [max(self._config.floor, P) for P in self._estimates.of(tree, runs)]
        edges = [(tree.plans[run.plan].states[0], tree.plans[run.plan].actions[0]) for run in runs]
        steps = list(zip(runs, edges, estimates, strict=True))
        for run, edge, P in steps:
            self._P[edge][run.node] = P
        rest = {run.plan: self._rest(tree.plans[run.plan]) for run in runs}
        return [self._first(run.node, edge, P) + rest[run.plan] for run, edge, P in steps]

    def hoped(self, plan: Skeleton) -> float:
        """What `remaining` would be had nothing been attempted yet [s]."""
        return sum(self._time(action, self._usual(action.name)) for action in plan.actions)

    def _first(self, node: int, edge: "_Edge", P: float) -> float:
        """Time of an action from this node: attempts from here count in full."""
        _, action = edge
        return self._time(action, self._posterior(P, self._anywhere[edge], self._here[node, action]))

    def _rest(self, plan: Skeleton) -> float:
        """Time of all later actions, from nodes that are not reached yet."""
        return sum(self._ahead(edge) for edge in list(zip(plan.states, plan.actions, strict=False))[1:])

    def _ahead(self, edge: "_Edge") -> float:
        """Time of an action from a node that is not reached yet: the mean over all that it may be."""
        _, action = edge
        estimates = [self._usual(action.name), *self._P[edge].values()]
        return fmean(self._time(action, self._posterior(P, self._anywhere[edge])) for P in estimates)

    def _usual(self, name: str) -> float:
        """Mean P of actions of this name."""
        estimates = [P for (_, action), of in self._P.items() if action.name == name for P in of.values()]
        return fmean(estimates) if estimates else self._config.hope

    def _posterior(self, P: float, anywhere: "_Evidence", here: "_Evidence | None" = None) -> float:
        """Mean of Beta(strength * P + successes, strength * (1 - P) + failures)."""
        own, transfer, strength = here or _Evidence(), self._config.transfer, self._config.strength
        successes = own.successes + transfer * (anywhere.successes - own.successes)
        attempts = own.attempts + transfer * (anywhere.attempts - own.attempts)
        return (strength * P + successes) / (strength + attempts)

    def _time(self, action: Action, belief: float) -> float:
        """Of repeating the action until it succeeds: 1 / belief - 1 failures on average, and then the success."""
        success = self._seconds[action.name, True] or [self._config.duration]
        failure = self._seconds[action.name, False] or success
        return fmean(success) + self._config.step + (1 / belief - 1) * (fmean(failure) + self._config.step)


_Edge = tuple[State, Action]
"""An edge of the high-level graph."""


@dataclass
class _Evidence:
    attempts: int = 0
    successes: int = 0

    def add(self, success: bool, tried: int) -> None:
        self.attempts += tried
        self.successes += success
