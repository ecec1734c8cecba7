"""Effort level search in infinite completion trees (Toussaint et al., ICRA 2024), as a selection rule.

The computational tree: child i of the root is the search for high-level plan i. Once the plan is found, its children
are the attempts at its first action from the root. The children of a successful attempt are the attempts at the next
action from the node it reached. A failed attempt has no children. Children are numbered from 0, without end.

level(child i) = level(parent) + (c_parent / c0)^p_c + eps + (i / w0)^p_w
priority(node) = level(node) + (c / c0)^p_c, with c the computing time spent in the node

The node with the least priority value is computed next. The first time, its next sibling joins the queue.
"""

from dataclasses import dataclass
from heapq import heappop, heappush
from math import inf
from typing import Generic, NamedTuple

import numpy as np

from ictamp_drake.core.checks import POSITIVE, check_fields
from ictamp_drake.core.protocols import Estimator, RuleContext
from ictamp_drake.core.types import C
from ictamp_drake.planning.estimates import ask_estimator
from ictamp_drake.planning.rule import OpenPlan, Option
from ictamp_drake.planning.tree import ROOT, Opening, RunStep, Step, Tree


@dataclass(frozen=True)
class ElsConfig:
    """Constants of effort level search.

    Attributes:
        p_w: Exponent of a child's number among its siblings.
        p_c: Exponent of computing time.
        w0: Number of siblings that adds 1 to the level.
        c0: Computing time that adds 1 to the level [s].
        eps: Constant that every generation adds to the level.
        weighted: Augment ELS with an estimator: attempt i with success probability P counts as number
            (i + 1) / P - 1, since a success takes 1 / P attempts on average; with P = 1 this is i.
        floor: Lower bound of the estimated probability, used with `weighted`.
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

    def create(self, context: RuleContext[C]) -> "Els[C]":
        """The rule for one search."""
        return Els(self, context.estimator)


class _Branch(NamedTuple):
    """Infinitely many siblings.

    Attributes:
        level: Level of the parent, plus its computing time and eps.
        option: Computational action of each sibling.
        P: Estimated probability that a sibling succeeds.
    """

    level: float
    option: Option
    P: float


class _Work(NamedTuple):
    """A node of the computational tree that waits to be computed; the least is next.

    Attributes:
        priority: Priority value, level + (c / c0)^p_c.
        order: Order of arrival, which breaks ties.
        branch: Siblings of the node.
        number: Number i of the node among its siblings.
        spent: Computing time c so far [s].
        met: Whether the node was computed before.
    """

    priority: float
    order: int
    branch: _Branch
    number: int
    spent: float
    met: bool


class Els(Generic[C]):
    """Effort level search with one queue of unfinished nodes."""

    def __init__(self, config: ElsConfig, estimator: Estimator[C]) -> None:
        self._config = config
        self._estimator = estimator
        self._queue: list[_Work] = []
        self._arrived = 0
        self._at_work: _Work | None = None
        self._wait(_Branch(config.eps, OpenPlan(), 1.0))

    def choose(self, tree: Tree[C], _: np.random.Generator) -> Option:
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
            case Opening(plan=None, seconds=seconds):  # continues in another call
                self._wait(work.branch, work.number, work.spent + seconds, met=True)
            case Opening(plan=int(plan), seconds=seconds):
                self._branch(tree, RunStep(ROOT, plan), work, work.spent + seconds)
            case Step(attempt=attempt) if tree.reached is not None:
                self._branch(tree, tree.reached, work, attempt.effort)

    def _branch(self, tree: Tree[C], run: RunStep, parent: _Work, spent: float) -> None:
        """Give a completed parent its children, the attempts at the next action."""
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
        return branch.level + _power(siblings / self._config.w0, self._config.p_w)

    def _effort(self, spent: float) -> float:
        return _power(spent / self._config.c0, self._config.p_c)


def _power(base: float, exponent: float) -> float:
    """Return a power of a number of at least 0, infinity if it is too large."""
    try:
        return float(base**exponent)
    except OverflowError:
        return inf
