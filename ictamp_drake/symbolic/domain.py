"""The ground domain of one scene: which actions apply in a state s and where each of them leads."""

from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.types import Action, Atom, Obstruction, State
from ictamp_drake.symbolic.atoms import IN_HAND, LYING, MOVED, ON, TIPPED, UPRIGHT


@dataclass(frozen=True)
class GroundAction:
    """An action a in STRIPS: applicable where all of `preconditions` hold, ends where they are replaced.

    Attributes:
        action: name and objects.
        preconditions, add, delete: ground atoms; upright and tipped are never among them.
    """

    action: Action
    preconditions: frozenset[Atom]
    add: frozenset[Atom]
    delete: frozenset[Atom]

    def applied(self, state: State) -> State:
        """The state after the action."""
        return (state - self.delete) | self.add


@dataclass(frozen=True)
class Domain:
    """All ground actions of a scene in a fixed order; `Domain.create` reads them from `domain.pddl`.

    Actions on supports come before those on boxes, both in the order given, and so do their plans among plans of equal
    length: a support has room to choose from, a box hardly any, and what stands on a box can be in the way later.
    """

    boxes: tuple[str, ...]
    supports: tuple[str, ...]
    actions: tuple[GroundAction, ...]

    @classmethod
    def create(cls, boxes: Sequence[str], supports: Sequence[str], initial: State) -> "Domain":
        """Ground the domain for the objects; `initial` settles who is upright and who is tipped, for good.

        Raises:
            IctampError: the name of an object is taken, or a box of the initial state is not in exactly one place.
        """
        from ictamp_drake.symbolic import pddl  # noqa: PLC0415  (takes 0.7 s, more than a whole search)

        for box in boxes:
            _check_place(box, initial)
        problem = pddl.planning_problem(boxes, supports, initial, frozenset())
        places = [*supports, *boxes]
        actions = sorted(
            (GroundAction(action, *effects) for action, effects in pddl.ground(problem)),
            key=lambda ground: (ground.action.name, places.index(ground.action.args[1]), ground.action),
        )
        return cls(tuple(boxes), tuple(supports), tuple(actions))

    def successors(self, state: State) -> tuple[tuple[Action, State], ...]:
        """The applicable actions in their order, each with the state that it promises."""
        return tuple((g.action, g.applied(state)) for g in self.actions if g.preconditions <= state)

    def successor(self, state: State, action: Action) -> State:
        """The state that the action promises.

        Raises:
            ValueError: the action is not applicable in the state, or not of this domain.
        """
        ground = self._by_name.get(action)
        if ground is None or not ground.preconditions <= state:
            raise ValueError(f"{action} is not applicable in the given state.")
        return ground.applied(state)

    def minding(self, obstructions: Collection[Obstruction]) -> "Domain":
        """The domain in which the boxes that are in the way of an action must have been moved before it.

        Its states remember that as moved(box), from when the box is placed. To pick such a box comes last in the order
        of actions, so that plans follow those without obstructions for as long as they can.
        """
        boxes = {obstruction.box for obstruction in obstructions}
        in_order = sorted(
            self.actions, key=lambda ground: ground.action.name == "pick" and ground.action.args[0] in boxes
        )
        return replace(
            self,
            actions=tuple(
                replace(
                    ground,
                    preconditions=ground.preconditions
                    | {Atom(MOVED, (box,)) for action, box in obstructions if action == ground.action},
                    add=ground.add | {Atom(MOVED, (box,)) for box in boxes if Atom(IN_HAND, (box,)) in ground.delete},
                )
                for ground in in_order
            ),
        )

    @cached_property
    def _by_name(self) -> dict[Action, GroundAction]:
        return {ground.action: ground for ground in self.actions}


def _check_place(box: str, initial: State) -> None:
    place, posture = (_about(box, predicates, initial) for predicates in ((ON, LYING, IN_HAND), (UPRIGHT, TIPPED)))
    if len(place) != 1 or len(posture) != 1:
        found = ", ".join(map(str, (*place, *posture))) or "nothing"
        needed = "one of on, lying and in-hand, and one of upright and tipped"
        raise IctampError(f'The initial state says {found} of the box "{box}", but must say {needed}.')


def _about(box: str, predicates: tuple[str, ...], state: State) -> list[Atom]:
    return sorted(atom for atom in state if atom.predicate in predicates and atom.args[0] == box)
