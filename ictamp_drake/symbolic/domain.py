"""The ground domain of one scene: the actions that apply in a state s, and the state each of them leads to."""

from collections import Counter
from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import Action, Atom, Obstruction, State
from ictamp_drake.symbolic.atoms import IN_HAND, LYING, MOVED, ON, TIPPED, UPRIGHT
from ictamp_drake.symbolic.grounding import GroundAction, ground
from ictamp_drake.symbolic.pddl import boxes_domain


@dataclass(frozen=True)
class Domain:
    """All ground actions of a scene in a fixed order. `Domain.create` reads them from `domain.pddl`.

    Actions on supports come before those on boxes, each group in the given order, and so do their plans among plans of
    equal length. A support offers many places and a box hardly any, and a box on top of another can be in the way
    later. Regions and poses count as supports. Of the `supports`, `poses` have room for one box.
    """

    boxes: tuple[str, ...]
    supports: tuple[str, ...]
    actions: tuple[GroundAction, ...]
    poses: tuple[str, ...] = ()

    @classmethod
    def create(
        cls, boxes: Sequence[str], supports: Sequence[str], initial: State, kinds: Mapping[str, str] | None = None
    ) -> "Domain":
        """Ground the domain for the objects.

        Args:
            boxes: Names of the boxes.
            supports: Names of the supports, regions and poses, in the order in which plans should prefer them.
            initial: State that decides which boxes are upright and which are tipped, for good.
            kinds: "region" or "pose" for those of `supports` that are one.

        Raises:
            IctampError: The name of an object is taken, or a box of the initial state is not in exactly one place.
        """
        for box in boxes:
            _check_place(box, initial)
        objects = _typed_objects(boxes, supports, kinds or {})
        rank = {place: number for number, place in enumerate((*supports, *boxes))}
        actions = sorted(
            ground(boxes_domain(), objects, initial),
            key=lambda each: (each.action.name, rank[each.action.args[1]], each.action),
        )
        poses = tuple(name for name in supports if objects[name] == "pose")
        return cls(tuple(boxes), tuple(supports), tuple(actions), poses)

    def successors(self, state: State) -> tuple[tuple[Action, State], ...]:
        """Return the applicable actions in their order, each with the state that it promises."""
        numbers = sorted(number for atom in (None, *state) for number in self.by_rarest.get(atom, ()))
        candidates = map(self.actions.__getitem__, numbers)
        return tuple((each.action, each.apply(state)) for each in candidates if each.applies(state))

    def successor(self, state: State, action: Action) -> State:
        """Return the state that the action promises.

        Raises:
            ValueError: The action is not applicable in the state, or does not belong to this domain.
        """
        found = self._by_name.get(action)
        if found is None or not found.applies(state):
            raise ValueError(f"{action} is not applicable in the given state.")
        return found.apply(state)

    def with_obstructions(self, obstructions: Collection[Obstruction]) -> "Domain":
        """Return a domain in which boxes that obstruct an action must be moved before it.

        Its states contain moved(box) once such a box has been placed. Picking such a box comes last in the order of
        actions, so plans follow those without obstructions as long as possible.
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
        """Indices of the actions by the precondition they share with the fewest others, or None without one."""
        shared_by = Counter(atom for each in self.actions for atom in each.preconditions)
        found: dict[Atom | None, list[int]] = {}
        for number, each in enumerate(self.actions):
            rarest = min(each.preconditions, key=lambda atom: (shared_by[atom], atom), default=None)
            found.setdefault(rarest, []).append(number)
        return found


def _typed_objects(boxes: Sequence[str], supports: Sequence[str], kinds: Mapping[str, str]) -> dict[str, str]:
    """Return the types of the objects by name. Refuse names that are taken."""
    domain = boxes_domain()
    taken = {*domain.types, *domain.predicates, *(operator.name for operator in domain.operators)}
    types: dict[str, str] = {}
    for usual, names in (("box", boxes), ("support", supports)):
        for name in names:
            kind = kinds.get(name, usual)
            if name in taken or name in types:
                problem = f"the name {{value}} of a {kind} is that of another object or a word of the planning domain"
                field = f"{'boxes' if kind == 'box' else f'{kind}s'}.{name}"
                advice = "choose another name"
                raise IctampError(Code.BAD_NAME, problem, field=field, value=name, advice=advice)
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
