"""Knowledge that a search gains about boxes that block its actions and that its plans do not move."""

from collections import Counter, defaultdict
from collections.abc import Iterable

from ictamp_drake.core.types import Action, Attempt, C, Obstruction, State

_NONE: frozenset[str] = frozenset()


class Obstructions:
    """Failures caused by boxes still at their initial pose, weighted by the fraction of k that each box blocked.

    Args:
        patience: Expected number of failures at a box, before the action succeeds, from which on the box should be
            moved first. Infinite leaves all boxes where they are.
    """

    def __init__(self, patience: float) -> None:
        self._patience = patience
        self._failures: defaultdict[Action, defaultdict[str, float]] = defaultdict(lambda: defaultdict(float))
        self._successes: defaultdict[Action, list[frozenset[str]]] = defaultdict(list)
        self._found: dict[Action, frozenset[str]] = {}

    def learn(self, initial: State, way: Iterable[Action], attempt: Attempt[C], success: bool) -> None:
        """Learn from an attempt that was made after the actions of the way.

        The initial state names the boxes that can be moved: the first argument of each atom.
        """
        action, moved = attempt.action, boxes_moved_by(way)
        if success:
            self._successes[action].append(moved)
        unmoved = {atom.args[0] for atom in initial if atom.args} - moved - {*action.args}
        for box, refused in Counter(attempt.obstacles).items():
            if box in unmoved:
                self._failures[action][box] += refused / attempt.tried
        found = (box for box in self._failures[action] if self._expected_failures(action, box) >= self._patience)
        self._found[action] = frozenset(found)

    def list_before(self, actions: Iterable[Action]) -> frozenset[Obstruction]:
        """Boxes that should be moved before these actions, each with its action."""
        return frozenset(Obstruction(action, box) for action in actions for box in self.boxes(action))

    def boxes(self, action: Action) -> frozenset[str]:
        """Boxes that should be moved before the action."""
        return self._found.get(action, _NONE)

    def _expected_failures(self, action: Action, box: str) -> float:
        """Expected failures at a box that has not been moved, by the rule of succession."""
        successes = sum(box not in moved for moved in self._successes[action])
        return self._failures[action][box] / (1 + successes)


def boxes_moved_by(way: Iterable[Action]) -> frozenset[str]:
    """Boxes that these actions move: the first argument of each."""
    return frozenset(moved for action in way for moved in action.args[:1])
