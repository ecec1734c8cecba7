"""Choice of W for each plan generator: `python benchmarks/opening.py 6 8`, a minute.

Solves random rearrangements of the given numbers of boxes on four supports, without physics. Some ways to put a box
aside are barred: they never succeed. A tenth of the actions can succeed from only half of the configurations.
Otherwise an action succeeds nineteen times in twenty. P does not know this. Each row has the mean number of low-level
steps until the goal, at most 150, and the mean number of opened plans, with no, some and many barred ways.
"""

import sys
from dataclasses import dataclass
from itertools import pairwise, product
from typing import NamedTuple

import numpy as np

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.core.types import Atom, Attempt, Parameter, Skeleton, State
from ictamp_drake.estimators.constant import Constant
from ictamp_drake.planning.planner import Budget, PlannerConfig
from ictamp_drake.planning.proportional import ProportionalConfig
from ictamp_drake.symbolic.atoms import CLEAR, HAND_EMPTY, ON, UPRIGHT
from ictamp_drake.symbolic.context import GeneratorContext
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.symbolic.goal import Goal
from ictamp_drake.symbolic.skeletons import BestFirst, BreadthFirst

SUPPORTS = ("east", "north", "south", "west")
SIZES = (6, 8, 12)
BARRED = (0.0, 0.3, 0.6)
TOUCHY = 0.1
SCENES = 20
STEPS = 150
WEIGHTS = (0.03, 0.1, 0.3, 1.0, 3.0, 10.0, 30.0)


class Configuration(NamedTuple):
    """A state, and a number that stands for everything that the state does not determine."""

    state: State
    luck: int


@dataclass(frozen=True)
class Skills:
    """Skills whose actions fail by chance, or never succeed."""

    scene: tuple[int, ...]
    goal: frozenset[Atom]
    barred: float
    draws: int = 1

    def attempt(
        self, c: Configuration, plan: Skeleton, rng: np.random.Generator, k: Parameter | None = None
    ) -> Attempt[Configuration]:
        """Run the action once; k has no effect."""
        del k
        action, promised = plan.actions[0], plan.states[1]
        words = [int.from_bytes(word.encode()[-4:], "big") for word in (action.name, *action.args)]
        kind = generator(Stream.DATA, *self.scene, *words).random()
        aside = action.name == "place" and Atom(ON, action.args) not in self.goal
        never = aside and kind < self.barred
        touchy = kind > 1 - TOUCHY and generator(Stream.DATA, c.luck, *words).random() < 0.5
        if never or touchy or rng.random() < 0.05:
            return Attempt(action, Failure.NO_PATH)
        return Attempt(action, None, Configuration(promised, int(rng.integers(2**31))))


def towers(boxes: list[str], rng: np.random.Generator) -> list[tuple[str, ...]]:
    """Stack the boxes in random towers, each of which begins with its support."""
    found: list[tuple[str, ...]] = []
    for box in rng.permutation(boxes):
        bases = [*((support,) for support in SUPPORTS), *found]
        base = bases[rng.integers(len(bases))]
        found = [tower for tower in found if tower != base] + [(*base, str(box))]
    return found


def atoms_of_towers(arrangement: list[tuple[str, ...]]) -> State:
    """Return the atoms that tell on what each box rests."""
    return frozenset(Atom(ON, (box, below)) for tower in arrangement for below, box in pairwise(tower))


def solve(size: int, number: int, barred: float, config: BreadthFirst | BestFirst, W: float) -> tuple[int, int]:
    """Return the number of steps until the goal and of opened plans."""
    rng = generator(Stream.DATA, size, number)
    boxes = [f"box_{box:02}" for box in range(size)]
    start = towers(boxes, rng)
    final = sorted(atoms_of_towers(towers(boxes, rng)))
    goal = frozenset(final[int(place)] for place in rng.permutation(size)[: 3 + size // 4])
    about = {Atom(UPRIGHT, (box,)) for box in boxes} | {Atom(CLEAR, (tower[-1],)) for tower in start}
    state = atoms_of_towers(start) | about | {Atom(HAND_EMPTY, ())}
    planner = PlannerConfig(Budget(seconds=1e6, steps=STEPS), rule=ProportionalConfig(W=W)).create(
        c=Configuration(state, 0),
        s=state,
        generator=config.create(GeneratorContext(Domain.create(boxes, SUPPORTS, state), state, Goal.of(goal))),
        skills=Skills((size, number), goal, barred),
        estimator=Constant(0.9),
        verify=lambda _: True,
        rng=generator(Stream.EVALUATION, number),
    )
    result = planner.run()
    return len(result.tree.steps) if result.solved else STEPS, sum(o.plan is not None for o in result.tree.openings)


def main(sizes: tuple[int, ...]) -> None:
    """Print one row per generator and W."""
    print(f"{'generator':15} {'W':>5}", *(f"{f'{share:.0%} barred: steps':>20} {'plans':>6}" for share in BARRED))
    for config, W in product((BestFirst(), BreadthFirst(patience=5000)), WEIGHTS):
        row = f"{type(config).__name__:15} {W:5}"
        for barred in BARRED:
            cases = [solve(size, number, barred, config, W) for size in sizes for number in range(SCENES)]
            steps, plans = np.mean(cases, axis=0)
            row += f" {steps:20.1f} {plans:6.1f}"
        print(row, flush=True)


if __name__ == "__main__":
    main(tuple(map(int, sys.argv[1:])) or SIZES)
