"""A ground domain encoded as integers, for searches that visit tens of thousands of states."""

from collections.abc import Iterator

from ictamp_drake.core.types import Atom, State
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.symbolic.formulas import leaves
from ictamp_drake.symbolic.goal import Goal
from ictamp_drake.symbolic.grounding import GroundAction


class Masks:
    """States as integers, with one bit for each atom that an action or the goal mentions. All others never change."""

    def __init__(self, domain: Domain, goal: Goal) -> None:
        self._actions = domain.actions
        atoms = sorted(goal.mentioned.union(*map(_atoms, self._actions)))
        self._bits = {atom: 1 << number for number, atom in enumerate(atoms)}
        self._goal = [
            (self.encode(each.atoms | each.absent), self.encode(each.atoms), list(map(self.encode, each.either)))
            for each in goal.alternatives
        ]
        self._masks = [
            (self.encode(each.preconditions), self.encode(each.add), ~self.encode(each.delete))
            for each in self._actions
        ]
        self._always = domain.by_rarest.get(None, [])
        self._by_bit = {self._bits[atom]: numbers for atom, numbers in domain.by_rarest.items() if atom is not None}
        self._rarest = sum(self._by_bit)

    def encode(self, state: State) -> int:
        """Encode a state, or any other set of atoms, as an integer."""
        return sum([self._bits.get(atom, 0) for atom in state])

    def is_goal(self, mask: int) -> bool:
        """Whether the goal holds in the state."""
        for decisive, wanted, either in self._goal:
            if mask & decisive == wanted and all(mask & atoms for atoms in either):
                return True
        return False

    def successors(self, mask: int) -> Iterator[int]:
        """Yield the states that the applicable actions promise, in the order of the actions."""
        numbers, waiting = list(self._always), mask & self._rarest
        while waiting:
            bit = waiting & -waiting
            numbers += self._by_bit[bit]
            waiting ^= bit
        numbers.sort()
        for number in numbers:
            preconditions, add, kept = self._masks[number]
            if mask & preconditions == preconditions:
                action = self._actions[number]
                if action.is_plain:
                    yield mask & kept | add
                elif action.applies(state := self._state(mask)):
                    yield self.encode(action.apply(state))

    def _state(self, mask: int) -> State:
        return frozenset(atom for atom, bit in self._bits.items() if mask & bit)


def _atoms(action: GroundAction) -> set[Atom]:
    formulas = [action.further, *(effect.condition for effect in action.conditional)]
    conditions = {leaf for formula in formulas for leaf in leaves(formula) if isinstance(leaf, Atom)}
    effects = (effect.add | effect.delete for effect in action.conditional)
    return conditions.union(action.preconditions, action.add, action.delete, *effects)
