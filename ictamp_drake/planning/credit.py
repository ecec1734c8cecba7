"""Credit assignment: which of the earlier steps decides whether a later one succeeds."""

from collections import defaultdict
from collections.abc import Sequence
from statistics import fmean
from typing import NamedTuple

Lineage = Sequence[int]
"""Numbers of the nodes from the root to a node, both included."""


class _Evidence(NamedTuple):
    """Attempts and how many succeeded; of nodes, how many and the sum of their P."""

    weight: float = 0.0
    total: float = 0.0

    def plus(self, other: "_Evidence") -> "_Evidence":
        return _Evidence(self.weight + other.weight, self.total + other.total)

    def minus(self, other: "_Evidence") -> "_Evidence":
        return _Evidence(self.weight - other.weight, self.total - other.total)

    def posterior(self, mean: float, strength: float) -> float:
        """Mean of a Beta distribution that had this mean and strength before the evidence."""
        return (strength * mean + self.total) / (strength + self.weight)

    def for_others(self, strength: float) -> "_Evidence":
        """What it says about another draw from the same Beta distribution, of this strength: at most so much."""
        share = strength / (strength + self.weight)
        return _Evidence(share * self.weight, share * self.total)


class EdgeBelief:
    """How likely an edge (s, a) succeeds from a node, reached or not: the mean over what may decide that.

    Hypothesis r: the first r steps do. Nodes that share them form a group with one success probability, drawn from a
    Beta distribution whose mean all groups share. To repeat a step founds a new group under every r that includes it:
    the earlier the step, the more there is to hope for; and the less, the more such groups have failed.

    Args:
        strength: of the Beta distributions, and of P as a first guess at their mean [attempts].
    """

    def __init__(self, strength: float) -> None:
        self._strength = strength
        self._P: defaultdict[int, _Evidence] = defaultdict(_Evidence)
        self._groups: defaultdict[int, _Evidence] = defaultdict(_Evidence)
        self._all_groups = [_Evidence()]

    def see(self, lineage: Lineage, P: float) -> None:
        """Take in P of a node."""
        for node in lineage:
            self._P[node] = self._P[node].plus(_Evidence(1.0, P))

    def learn(self, lineage: Lineage, success: bool) -> None:
        """Take in an attempt from a node."""
        before = self._groups_of(lineage)
        for node in lineage:
            self._groups[node] = self._groups[node].plus(_Evidence(1.0, success))
        for r, (old, new) in enumerate(zip(before, self._groups_of(lineage), strict=True)):
            news = new.for_others(self._strength).minus(old.for_others(self._strength))
            self._all_groups[r] = self._all_groups[r].plus(news)

    def at(self, lineage: Lineage, P: float) -> float:
        """Success from a node with this P."""
        groups = self._groups_of(lineage)
        return self._mean(groups, [P] * len(groups))

    def ahead(self, lineage: Lineage, depth: int, usual: float) -> float:
        """Success from a node of this depth that is still to be reached from the last one here.

        Its P is guessed from that of the nodes in its group; the usual P counts as one of them.
        """
        self._allow(depth)
        fresh = len(self._all_groups) - len(lineage)
        anywhere = self._P[lineage[0]].posterior(usual, strength=1.0)
        nearby = [self._P[node].posterior(anywhere, strength=1.0) for node in lineage]
        groups = [self._groups[node] for node in lineage]
        return self._mean(groups + [_Evidence()] * fresh, nearby + [anywhere] * fresh)

    def _groups_of(self, lineage: Lineage) -> list[_Evidence]:
        """What was seen in a node's group, for each r; where r is more steps than it has, it is alone."""
        self._allow(len(lineage) - 1)
        alone = [lineage[-1]] * (len(self._all_groups) - len(lineage))
        return [self._groups[node] for node in (*lineage, *alone)]

    def _allow(self, depth: int) -> None:
        """Consider every r up to this depth; every node so far was alone where r is more than were considered."""
        self._all_groups += self._all_groups[-1:] * (depth + 1 - len(self._all_groups))

    def _mean(self, groups: Sequence[_Evidence], P: Sequence[float]) -> float:
        beliefs = []
        for group, all_groups, first in zip(groups, self._all_groups, P, strict=True):
            others = all_groups.minus(group.for_others(self._strength))
            beliefs.append(group.posterior(others.posterior(first, self._strength), self._strength))
        return fmean(beliefs)
