"""Effort level search in infinite completion trees (Toussaint et al., ICRA 2024), as a selection rule.

Its computational tree: the root's i-th child is the work on the i-th high-level plan. When that has come, its children
are the attempts at its first action from the root; a successful attempt's children are those at the next action from
the node that it reached; a failed one has none. Children are numbered from 0, and there are infinitely many of them.

level(child i) = level(parent) + (c_parent / c0)^p_c + eps + (i / w0)^p_w
priority(node) = level(node) + (c / c0)^p_c, with c the computing time spent in the node

The node of the least priority is computed next; when it is met for the first time, its next sibling joins the queue.
"""

from dataclasses import dataclass
from heapq import heappop, heappush
from math import inf
from typing import Generic, NamedTuple

import numpy as np

from ictamp_drake.core.checks import POSITIVE, check_fields
from ictamp_drake.core.protocols import Estimator
from ictamp_drake.core.types import C
from ictamp_drake.planning.estimates import ask_estimator
from ictamp_drake.planning.rule import OpenPlan, Option
from ictamp_drake.planning.tree import ROOT, Opening, RunStep, Step, Tree


@dataclass(frozen=True)
class ElsConfig:
    """Constants of effort level search.

    Attributes:
        p_w: exponent of a child's number among its siblings.
        p_c: exponent of computing time.
        w0: number of siblings that weighs 1.
        c0: computing time that weighs 1 [s].
        eps: what every generation adds to the level.
        weighted: ELS augmented with an estimator: an attempt of probability P counts as number (i + 1) / P - 1, so many
            attempts a success takes on average; where P is 1 this is i.
        floor: least estimated probability, for `weighted`.
    """

    p_w: float = 1.0
    p_c: float = 1.0
    w0: float = 1.0
    c0: float = 1.0
    eps: float = 1e-4
    weighted: bool = False
    floor: float = 0.1

    def __post_init__(self) -> None:
        check_fields(self, "planners.els", p_w=(0, inf), p_c=(0, inf), eps=(0, inf))
        check_fields(self, "planners.els", w0=(POSITIVE, inf), c0=(POSITIVE, inf), floor=(POSITIVE, 1))

    def create(self, estimator: Estimator[C]) -> "Els[C]":
        """The rule for one search."""
        return Els(self, estimator)


class _Branch(NamedTuple):
    """Infinitely many siblings.

    Attributes:
        level: of the parent, with its computing time and eps.
        option: what each of them does when it is computed.
        P: estimated probability that one of them succeeds.
    """

    level: float
    option: Option
    P: float


class _Work(NamedTuple):
    """A node of the computational tree that waits for being computed; the least is the next.

    Attributes:
        priority: level + (c / c0)^p_c.
        order: of arrival, which decides among equals.
        branch: its siblings.
        number: i, among them.
        spent: c, computing time so far [s].
        met: whether it was computed before.
    """

    priority: float
    order: int
    branch: _Branch
    number: int
    spent: float
    met: bool


class Els(Generic[C]):
    """One queue of unfinished nodes."""

    def __init__(self, config: ElsConfig, estimator: Estimator[C]) -> None:
        self._config = config
        self._estimator = estimator
        self._queue: list[_Work] = []
        self._arrived = 0
        self._at_work: _Work | None = None
        self._wait(_Branch(config.eps, OpenPlan(), 1.0))

    def choose(self, tree: Tree[C], rng: np.random.Generator) -> Option:  # noqa: ARG002  (nothing is random)
        """Take in what became of the last choice, and serve the least node."""
        if self._at_work is not None:
            self._take_in(tree, self._at_work)
        work = heappop(self._queue)
        while tree.exhausted and isinstance(work.branch.option, OpenPlan):
            work = heappop(self._queue)
        if not work.met:
            self._wait(work.branch, work.number + 1)
        self._at_work = work
        return work.branch.option

    def _take_in(self, tree: Tree[C], work: _Work) -> None:
        match tree.log[-1]:
            case Opening(plan=None, seconds=seconds):  # goes on in another call
                self._wait(work.branch, work.number, work.spent + seconds, met=True)
            case Opening(plan=int(plan), seconds=seconds):
                self._branch(tree, RunStep(ROOT, plan), work, work.spent + seconds)
            case Step(attempt=attempt) if tree.reached is not None:
                self._branch(tree, tree.reached, work, attempt.effort)

    def _branch(self, tree: Tree[C], run: RunStep, parent: _Work, spent: float) -> None:
        """The parent is complete: the attempts at the next action are its children."""
        P = 1.0
        if self._config.weighted:
            (P,) = ask_estimator(self._estimator, [(tree.nodes[run.node].c, tree.plans[run.plan])])
        level = self._level(parent.branch, parent.number) + self._effort(spent) + self._config.eps
        self._wait(_Branch(level, run, max(self._config.floor, P)))

    def _wait(self, branch: _Branch, number: int = 0, spent: float = 0.0, met: bool = False) -> None:
        priority = self._level(branch, number) + self._effort(spent)
        heappush(self._queue, _Work(priority, self._arrived, branch, number, spent, met))
        self._arrived += 1

    def _level(self, branch: _Branch, number: int) -> float:
        siblings = (number + 1) / branch.P - 1
        return float(branch.level + (siblings / self._config.w0) ** self._config.p_w)

    def _effort(self, spent: float) -> float:
        return float((spent / self._config.c0) ** self._config.p_c)
