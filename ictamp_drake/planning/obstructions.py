"""What a search learns about boxes in the way that its plans never move."""

from collections import Counter, defaultdict
from collections.abc import Iterable

from ictamp_drake.core.types import Action, Attempt, C, Obstruction, State

_NONE: frozenset[str] = frozenset()


class Obstructions:
    """Boxes that actions failed at where they stood at first, each with its share in a failure, by the k it refused.

    Args:
        patience: failures at a box that an action is expected to have before it succeeds, from which on the box had
            better be moved first. Infinite to leave all boxes where they are.
    """

    def __init__(self, patience: float) -> None:
        self._patience = patience
        self._failures: defaultdict[Action, defaultdict[str, float]] = defaultdict(lambda: defaultdict(float))
        self._successes: defaultdict[Action, list[frozenset[str]]] = defaultdict(list)
        self._found: dict[Action, frozenset[str]] = {}

    def learn(self, initial: State, way: Iterable[Action], attempt: Attempt[C], success: bool) -> None:
        """Take in an attempt that was made after the actions of the way.

        The initial state tells what can be moved: what its atoms are about, the first argument of each.
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
        """Those that had better be moved before these actions."""
        return frozenset(Obstruction(action, box) for action in actions for box in self.boxes(action))

    def boxes(self, action: Action) -> frozenset[str]:
        """Those that had better be moved before the action."""
        return self._found.get(action, _NONE)

    def _expected_failures(self, action: Action, box: str) -> float:
        """At a box that has not been moved, by the rule of succession."""
        successes = sum(box not in moved for moved in self._successes[action])
        return self._failures[action][box] / (1 + successes)


def boxes_moved_by(way: Iterable[Action]) -> frozenset[str]:
    """What these actions move, the first argument of each."""
    return frozenset(moved for action in way for moved in action.args[:1])
