"""H: C -> S, always computed from the configuration, never assumed (paper, Problem Formulation)."""

from collections.abc import Iterator

from ictamp_drake.core.types import Atom, Configuration, State
from ictamp_drake.symbolic.atoms import CLEAR, HAND_EMPTY, IN_HAND, LYING, ON, TIPPED, UPRIGHT
from ictamp_drake.world.config import PredicateConfig
from ictamp_drake.world.predicates import Scene
from ictamp_drake.world.world import World


class SceneAbstraction:
    """H of one scene.

    - on(a, b): b carries a, and a is upright. b is a box, a support, or a region or pose on a support.
    - lying(a, b): b carries a, and a is tipped over, onto a side that makes it higher or lower.
    - in-hand(a): both fingers touch a, neither cuts into it, and nothing carries a.
    - clear(a): nothing touches a from above, and a is not in the hand.
    - hand-empty: nothing is in the hand.
    - upright(a): a is as high as it was specified, so that it looks as if it stood on its bottom face.
    - tipped(a): a is higher or lower than that.
    """

    def __init__(self, world: World, config: PredicateConfig | None = None) -> None:
        self._world = world
        self.config = config or PredicateConfig()
        self._boxes = sorted(world.spec.boxes)
        self._bodies = sorted([*world.spec.boxes, *world.spec.supports])
        self._receptacles = sorted([*world.spec.boxes, *world.spec.places])

    def __call__(self, c: Configuration) -> State:
        """Return all atoms that hold in c."""
        scene = Scene(self._world, c, self.config)
        atoms = [atom for a in self._boxes for atom in (*self._describe_box(scene, a), *self._describe_rest(scene, a))]
        held = any(atom.predicate == IN_HAND for atom in atoms)
        return frozenset(atoms if held else [*atoms, Atom(HAND_EMPTY, ())])

    def _describe_box(self, scene: Scene, a: str) -> Iterator[Atom]:
        """The atoms about a alone."""
        yield Atom(UPRIGHT if scene.boxes[a].is_upright else TIPPED, (a,))
        if self._is_in_hand(scene, a):
            yield Atom(IN_HAND, (a,))
        elif not any(scene.is_above(b, a) for b in self._boxes if b != a):
            yield Atom(CLEAR, (a,))

    def _describe_rest(self, scene: Scene, a: str) -> Iterator[Atom]:
        """The atoms about what carries a."""
        predicate = ON if scene.boxes[a].is_upright else LYING
        yield from (Atom(predicate, (a, b)) for b in self._receptacles if b != a and scene.is_carried(a, b))

    def _is_in_hand(self, scene: Scene, a: str) -> bool:
        resting = any(scene.is_above(a, b) for b in self._bodies if b != a)
        return scene.is_gripped(a) and not resting
