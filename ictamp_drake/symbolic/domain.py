"""The ground domain of one scene: which actions apply in a state s and where each of them leads."""

from collections import Counter
from collections.abc import Collection, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import Action, Atom, Obstruction, State
from ictamp_drake.symbolic.atoms import IN_HAND, LYING, MOVED, ON, TIPPED, UPRIGHT
from ictamp_drake.symbolic.grounding import GroundAction, ground
from ictamp_drake.symbolic.pddl import boxes_domain


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
        for box in boxes:
            _check_place(box, initial)
        objects = _typed_objects(boxes, supports)
        rank = {place: number for number, place in enumerate((*supports, *boxes))}
        actions = sorted(
            ground(boxes_domain(), objects, initial),
            key=lambda each: (each.action.name, rank[each.action.args[1]], each.action),
        )
        return cls(tuple(boxes), tuple(supports), tuple(actions))

    def successors(self, state: State) -> tuple[tuple[Action, State], ...]:
        """The applicable actions in their order, each with the state that it promises."""
        numbers = sorted(number for atom in (None, *state) for number in self.by_rarest.get(atom, ()))
        candidates = map(self.actions.__getitem__, numbers)
        return tuple((each.action, each.apply(state)) for each in candidates if each.applies(state))

    def successor(self, state: State, action: Action) -> State:
        """The state that the action promises.

        Raises:
            ValueError: the action is not applicable in the state, or not of this domain.
        """
        found = self._by_name.get(action)
        if found is None or not found.applies(state):
            raise ValueError(f"{action} is not applicable in the given state.")
        return found.apply(state)

    def with_obstructions(self, obstructions: Collection[Obstruction]) -> "Domain":
        """The domain in which the boxes that are in the way of an action must have been moved before it.

        Its states remember that as moved(box), from when the box is placed. To pick such a box comes last in the order
        of actions, so that plans follow those without obstructions for as long as they can.
        """
        boxes = {obstruction.box for obstruction in obstructions}
        in_order = sorted(self.actions, key=lambda each: each.action.name == "pick" and each.action.args[0] in boxes)
        return replace(
            self,
            actions=tuple(
                replace(
                    each,
                    preconditions=each.preconditions
                    | {Atom(MOVED, (box,)) for action, box in obstructions if action == each.action},
                    add=each.add | {Atom(MOVED, (box,)) for box in boxes if Atom(IN_HAND, (box,)) in each.delete},
                )
                for each in in_order
            ),
        )

    @cached_property
    def _by_name(self) -> dict[Action, GroundAction]:
        return {each.action: each for each in self.actions}

    @cached_property
    def by_rarest(self) -> dict[Atom | None, list[int]]:
        """Numbers of the actions by the precondition that they share with the fewest others; None if they have none."""
        shared_by = Counter(atom for each in self.actions for atom in each.preconditions)
        found: dict[Atom | None, list[int]] = {}
        for number, each in enumerate(self.actions):
            rarest = min(each.preconditions, key=lambda atom: (shared_by[atom], atom), default=None)
            found.setdefault(rarest, []).append(number)
        return found


def _typed_objects(boxes: Sequence[str], supports: Sequence[str]) -> dict[str, str]:
    """Types of the objects by name; every name is new to the planning domain."""
    domain = boxes_domain()
    taken = {*domain.types, *domain.predicates, *(operator.name for operator in domain.operators)}
    types: dict[str, str] = {}
    for kind, names in (("box", boxes), ("support", supports)):
        for name in names:
            if name in taken or name in types:
                problem = f"the name {{value}} of a {kind} is that of another object or a word of the planning domain"
                raise IctampError(Code.BAD_NAME, problem, value=name, advice="choose another name")
            types[name] = kind
    return types


def _check_place(box: str, initial: State) -> None:
    place, posture = (
        _atoms_about(box, predicates, initial) for predicates in ((ON, LYING, IN_HAND), (UPRIGHT, TIPPED))
    )
    if len(place) != 1 or len(posture) != 1:
        expected = "expected one of on, lying and in-hand, and one of upright and tipped, in the initial state"
        found = ", ".join(map(str, (*place, *posture))) or "nothing"
        raise IctampError(Code.BAD_STATE, f"{expected}, got {found}", field=box, value=[*place, *posture])


def _atoms_about(box: str, predicates: tuple[str, ...], state: State) -> list[Atom]:
    return sorted(atom for atom in state if atom.predicate in predicates and atom.args[0] == box)
