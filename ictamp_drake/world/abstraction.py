"""H: C -> S, always computed from the configuration, never assumed (paper, Problem Formulation)."""

from collections.abc import Callable, Mapping

from ictamp_drake.core.types import Atom, Configuration, State
from ictamp_drake.world.predicates import Evaluation, PredicateConfig, Scene
from ictamp_drake.world.world import World


class SceneAbstraction:
    """H of one scene.

    - on(a, b): b carries a, and a is upright.
    - lying(a, b): b carries a, and a is tipped over, onto a side or its head.
    - in-hand(a): both fingers touch a, neither cuts into it, and nothing carries a.
    - clear(a): nothing touches a from above, and a is not in the hand.
    - hand-empty: nothing is in the hand.
    - upright(a): the bottom face of a is the face nearest to the ground.
    - tipped(a): another face of a is.
    """

    def __init__(self, world: World, config: PredicateConfig | None = None) -> None:
        self._world = world
        self._config = config or PredicateConfig()
        self._boxes = sorted(world.spec.boxes)
        self._receptacles = sorted([*world.spec.boxes, *world.spec.supports])
        self._predicates: dict[str, Callable[..., Evaluation]] = {
            "on": self._evaluate_on,
            "lying": self._evaluate_lying,
            "in-hand": self._evaluate_in_hand,
            "clear": self._evaluate_clear,
            "hand-empty": self._evaluate_hand_empty,
            "upright": self._evaluate_upright,
            "tipped": self._evaluate_tipped,
        }

    def __call__(self, c: Configuration) -> State:
        """Return all atoms that hold in c."""
        scene = Scene(self._world, c, self._config)
        return frozenset(atom for atom in self._candidates() if self._evaluate(scene, atom).holds)

    def eval(self, c: Configuration, atom: Atom) -> bool:
        """Whether one atom holds in c."""
        return self._evaluate(Scene(self._world, c, self._config), atom).holds

    def eval_detailed(self, c: Configuration, atom: Atom) -> Mapping[str, float]:
        """Return the quantities that decide whether the atom holds in c, by name [m, rad]."""
        return self._evaluate(Scene(self._world, c, self._config), atom).quantities

    def _candidates(self) -> list[Atom]:
        unary = [Atom(p, (a,)) for p in ("in-hand", "clear", "upright", "tipped") for a in self._boxes]
        pairs = [(a, b) for a in self._boxes for b in self._receptacles if a != b]
        return [Atom("hand-empty", ()), *unary, *(Atom(p, pair) for p in ("on", "lying") for pair in pairs)]

    def _evaluate(self, scene: Scene, atom: Atom) -> Evaluation:
        return self._predicates[atom.predicate](scene, *atom.args)

    def _evaluate_on(self, scene: Scene, a: str, b: str) -> Evaluation:
        carried = scene.evaluate_carried(a, b)
        return Evaluation(carried.holds and scene.boxes[a].is_upright, carried.quantities)

    def _evaluate_lying(self, scene: Scene, a: str, b: str) -> Evaluation:
        carried = scene.evaluate_carried(a, b)
        return Evaluation(carried.holds and not scene.boxes[a].is_upright, carried.quantities)

    def _evaluate_in_hand(self, scene: Scene, a: str) -> Evaluation:
        gripped = scene.evaluate_gripped(a)
        resting = any(scene.evaluate_above(a, b).holds for b in self._receptacles if b != a)
        return Evaluation(gripped.holds and not resting, gripped.quantities)

    def _evaluate_clear(self, scene: Scene, a: str) -> Evaluation:
        covered = any(scene.evaluate_above(b, a).holds for b in self._boxes if b != a)
        return Evaluation(not covered and not self._evaluate_in_hand(scene, a).holds, {})

    def _evaluate_hand_empty(self, scene: Scene) -> Evaluation:
        return Evaluation(not any(self._evaluate_in_hand(scene, a).holds for a in self._boxes), {})

    def _evaluate_upright(self, scene: Scene, a: str) -> Evaluation:
        return Evaluation(scene.boxes[a].is_upright, scene.evaluate_tilt(a).quantities)

    def _evaluate_tipped(self, scene: Scene, a: str) -> Evaluation:
        return Evaluation(not scene.boxes[a].is_upright, scene.evaluate_tilt(a).quantities)
