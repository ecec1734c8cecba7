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
    """Attempts and how many succeeded; of nodes, how many and the sum of their P."""

    weight: float = 0.0
    total: float = 0.0

    def plus(self, other: "_Evidence") -> "_Evidence":
        return _Evidence(self.weight + other.weight, self.total + other.total)

    def minus(self, other: "_Evidence") -> "_Evidence":
        return _Evidence(self.weight - other.weight, self.total - other.total)

    def discount_for_others(self, strength: float) -> "_Evidence":
        """What it says about another draw from the same Beta distribution, of this strength: at most so much."""
        share = strength / (strength + self.weight)
        return _Evidence(share * self.weight, share * self.total)


_Judgement = Callable[["EdgeBelief", Lineage, Way, float], float]


def _cache_until_news(judgement: _Judgement) -> _Judgement:
    """The same, computed once until there are news."""

    @wraps(judgement)
    def cached(self: "EdgeBelief", lineage: Lineage, way: Way, P: float) -> float:
        asked = judgement, lineage, way, P
        known = self._known.get(asked)
        if known is None:
            known = self._known[asked] = judgement(self, lineage, way, P)
        return known

    return cached


class EdgeBelief:
    """How likely an edge (s, a) succeeds from a node, reached or not: a mixture over what may decide that.

    Hypothesis r: the first r steps do. Nodes that share them form a group with one success probability, drawn from a
    Beta distribution whose mean all groups share. To repeat a step founds a new group under every r that includes it:
    the earlier the step, the more there is to hope for; and the less, the more such groups have failed.

    All r are equally likely, until failures tell between what they came about: each is a vote for the last steps that
    moved those objects, and what these were put on, and for r = 0.

    Args:
        strength: of the Beta distributions, and of P as a first guess at their mean [attempts].
    """

    def __init__(self, strength: float) -> None:
        self._strength = strength
        self._P: defaultdict[int, _Evidence] = defaultdict(_Evidence)
        self._groups: defaultdict[int, _Evidence] = defaultdict(_Evidence)
        self._all_groups = [_Evidence()]
        self._blamed = Counter[frozenset[str]]()
        self._known: dict[tuple[_Judgement, Lineage, Way, float], float] = {}

    def see(self, lineage: Lineage, P: float) -> None:
        """Take in P of a node."""
        self._known.clear()
        for node in lineage:
            self._P[node] = self._P[node].plus(_Evidence(1.0, P))

    def learn(self, lineage: Lineage, success: bool) -> None:
        """Take in an attempt from a node."""
        self._add(lineage, _Evidence(1.0, success))

    def withdraw_success(self, lineage: Lineage) -> None:
        """Take back a success from a node."""
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
        """Take in between which objects a failure came about; none when that is not known."""
        self._known.clear()
        self._blamed[frozenset(objects)] += 1

    @_cache_until_news
    def success_at(self, lineage: Lineage, way: Way, P: float) -> float:
        """Success from a node with this P."""
        return self._mean(self._groups_of(lineage), way, P)

    @_cache_until_news
    def success_ahead(self, lineage: Lineage, way: Way, usual: float) -> float:
        """Success from a node that is still to be reached, on this way, from the last one of the lineage.

        Its P is guessed from that of the nodes nearby; the usual P counts as one of them.
        """
        self._allow(len(way))
        P = usual
        for node in lineage:
            weight, total = self._P[node]
            P = (P + total) / (1 + weight)
        fresh = [_Evidence()] * (len(self._all_groups) - len(lineage))
        return self._mean([self._groups[node] for node in lineage] + fresh, way, P)

    def _groups_of(self, lineage: Lineage) -> list[_Evidence]:
        """What was seen in a node's group, for each r; where r is more steps than it has, it is alone."""
        self._allow(len(lineage) - 1)
        alone = [lineage[-1]] * (len(self._all_groups) - len(lineage))
        return [self._groups[node] for node in (*lineage, *alone)]

    def _allow(self, depth: int) -> None:
        """Consider every r up to this depth; every node so far was alone where r is more than were considered."""
        if depth >= len(self._all_groups):
            self._known.clear()
            self._all_groups += self._all_groups[-1:] * (depth + 1 - len(self._all_groups))

    def _mean(self, groups: Sequence[_Evidence], way: Way, P: float) -> float:
        """Of all r: P is updated by what the other groups say about another draw, and then by the group itself."""
        mean, strength = 0.0, self._strength
        for share, group, all_groups in zip(self._shares(way), groups, self._all_groups, strict=True):
            (weight, total), (all_weight, all_total) = group, all_groups
            part = strength / (strength + weight)
            prior = (strength * P + (all_total - part * total)) / (strength + (all_weight - part * weight))
            mean += share * ((strength * prior + total) / (strength + weight))
        return mean

    def _shares(self, way: Way) -> list[float]:
        """How likely each r is; before any vote, and by a failure of which nothing is known, all have the same."""
        count, unknown = len(self._all_groups), 1 + self._blamed[frozenset()]
        votes = [unknown / count] * count
        for objects, failures in self._blamed.items():
            suspects = [0, *_last_moves(way, objects)] if objects else []
            for r in suspects:
                votes[r] += failures / len(suspects)
        total = sum(votes)
        return [vote / total for vote in votes]


def _last_moves(way: Way, objects: Collection[str]) -> list[int]:
    """Numbers of the last steps, counted from 1, that moved the objects and what these were put on."""
    sought, found = {*objects}, dict[str, int]()
    for number, action in zip(range(len(way), 0, -1), reversed(way), strict=True):
        moved = next(iter(action.args), "")
        if moved in sought and moved not in found:
            found[moved] = number
            sought.update(action.args)
    return [*found.values()]
