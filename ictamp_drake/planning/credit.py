"""Credit assignment: which of the earlier steps decides whether a later one succeeds."""

from collections import Counter, defaultdict
from collections.abc import Callable, Collection, Sequence
from functools import wraps
from typing import NamedTuple

from ictamp_drake.core.types import Action

Lineage = tuple[int, ...]
"""Numbers of the nodes from the root to a node, both included."""
Way = tuple[Action, ...]
"""Actions from the root to a node; the first argument of each is what it moves."""


class _Evidence(NamedTuple):
    """Number of attempts and of successes; for P, number of nodes and the sum of their P."""

    weight: float = 0.0
    total: float = 0.0

    def plus(self, other: "_Evidence") -> "_Evidence":
        return _Evidence(self.weight + other.weight, self.total + other.total)

    def minus(self, other: "_Evidence") -> "_Evidence":
        return _Evidence(self.weight - other.weight, self.total - other.total)

    def discount_for_others(self, strength: float) -> "_Evidence":
        """Evidence about another draw from the same Beta distribution; its weight stays below `strength`."""
        share = strength / (strength + self.weight)
        return _Evidence(share * self.weight, share * self.total)


_Judgement = Callable[["EdgeBelief", Lineage, Way, float], float]


def _cache_until_news(judgement: _Judgement) -> _Judgement:
    """Cache a judgement until new evidence arrives."""

    @wraps(judgement)
    def cached(self: "EdgeBelief", lineage: Lineage, way: Way, P: float) -> float:
        asked = judgement, lineage, way, P
        known = self._known.get(asked)
        if known is None:
            known = self._known[asked] = judgement(self, lineage, way, P)
        return known

    return cached


class EdgeBelief:
    """Success probability of an edge (s, a) from a node, reached or not: a mixture over what may decide the success.

    Hypothesis r: the first r steps decide. Nodes that share these steps form a group with one success probability,
    drawn from a Beta distribution whose mean all groups share. Repeating a step founds a new group under every r that
    includes it, so an earlier step offers more hope. The hope falls with the number of such groups that have failed.

    All r are equally likely until failures name the objects involved. Each such failure is a vote for r = 0, and for
    the last steps that moved these objects or the objects they were placed on.

    Args:
        strength: Strength of the Beta distributions, and of P as the first guess at their mean [attempts].
    """

    def __init__(self, strength: float) -> None:
        self._strength = strength
        self._P: defaultdict[int, _Evidence] = defaultdict(_Evidence)
        self._groups: defaultdict[int, _Evidence] = defaultdict(_Evidence)
        self._all_groups = [_Evidence()]
        self._blamed = Counter[frozenset[str]]()
        self._known: dict[tuple[_Judgement, Lineage, Way, float], float] = {}

    def see(self, lineage: Lineage, P: float) -> None:
        """Add the P of a node."""
        self._known.clear()
        for node in lineage:
            self._P[node] = self._P[node].plus(_Evidence(1.0, P))

    def learn(self, lineage: Lineage, success: bool) -> None:
        """Add an attempt from a node."""
        self._add(lineage, _Evidence(1.0, success))

    def withdraw_success(self, lineage: Lineage) -> None:
        """Withdraw a success from a node."""
        self._add(lineage, _Evidence(-1.0, -1.0))

    def _add(self, lineage: Lineage, evidence: _Evidence) -> None:
        self._known.clear()
        before = self._groups_of(lineage)
        for node in lineage:
            self._groups[node] = self._groups[node].plus(evidence)
        for r, (old, new) in enumerate(zip(before, self._groups_of(lineage), strict=True)):
            news = new.discount_for_others(self._strength).minus(old.discount_for_others(self._strength))
            self._all_groups[r] = self._all_groups[r].plus(news)

    def blame(self, objects: Collection[str]) -> None:
        """Add the objects involved in a failure; empty when they are unknown."""
        self._known.clear()
        self._blamed[frozenset(objects)] += 1

    @_cache_until_news
    def success_at(self, lineage: Lineage, way: Way, P: float) -> float:
        """Success probability from a node with this P."""
        return self._mean(self._groups_of(lineage), way, P)

    @_cache_until_news
    def success_ahead(self, lineage: Lineage, way: Way, usual: float) -> float:
        """Success probability from a node still to be reached, at the end of `way`, which extends the lineage.

        Its P is estimated from nearby nodes; `usual` counts as one of them.
        """
        self._allow(len(way))
        P = usual
        for node in lineage:
            weight, total = self._P[node]
            P = (P + total) / (1 + weight)
        fresh = [_Evidence()] * (len(self._all_groups) - len(lineage))
        return self._mean([self._groups[node] for node in lineage] + fresh, way, P)

    def _groups_of(self, lineage: Lineage) -> list[_Evidence]:
        """Evidence of a node's group for each r; a node with fewer than r steps is alone in its group."""
        self._allow(len(lineage) - 1)
        alone = [lineage[-1]] * (len(self._all_groups) - len(lineage))
        return [self._groups[node] for node in (*lineage, *alone)]

    def _allow(self, depth: int) -> None:
        """Consider every r up to this depth; for each new r, every node so far was alone in its group."""
        if depth >= len(self._all_groups):
            self._known.clear()
            self._all_groups += self._all_groups[-1:] * (depth + 1 - len(self._all_groups))

    def _mean(self, groups: Sequence[_Evidence], way: Way, P: float) -> float:
        """Mean over all r: P is updated by the discounted evidence of the other groups, then by the group itself."""
        mean, strength = 0.0, self._strength
        for share, group, all_groups in zip(self._shares(way), groups, self._all_groups, strict=True):
            (weight, total), (all_weight, all_total) = group, all_groups
            part = strength / (strength + weight)
            prior = (strength * P + (all_total - part * total)) / (strength + (all_weight - part * weight))
            mean += share * ((strength * prior + total) / (strength + weight))
        return mean

    def _shares(self, way: Way) -> list[float]:
        """Probability of each r; a failure with unknown objects votes for all equally, as if before any vote."""
        count, unknown = len(self._all_groups), 1 + self._blamed[frozenset()]
        votes = [unknown / count] * count
        for objects, failures in self._blamed.items():
            suspects = [0, *_last_moves(way, objects)] if objects else []
            for r in suspects:
                votes[r] += failures / len(suspects)
        total = sum(votes)
        return [vote / total for vote in votes]


def _last_moves(way: Way, objects: Collection[str]) -> list[int]:
    """Numbers, from 1, of the last steps that moved the objects or the objects they were placed on."""
    sought, found = {*objects}, dict[str, int]()
    for number, action in zip(range(len(way), 0, -1), reversed(way), strict=True):
        moved = next(iter(action.args), "")
        if moved in sought and moved not in found:
            found[moved] = number
            sought.update(action.args)
    return [*found.values()]
