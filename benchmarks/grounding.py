"""Computing time until the first high-level plan: `python benchmarks/grounding.py`, half a minute.

Rebuilds towers of two boxes upside down on a second support, with every fourth box tipped over; in the last problem,
five of 21 boxes move and none is in the way. Prints the processor time of one thread, the minimum of three rounds.
"""

import time
from collections.abc import Callable
from itertools import pairwise
from typing import TypeVar

from ictamp_drake.core.types import Atom, State
from ictamp_drake.symbolic.atoms import CLEAR, HAND_EMPTY, LYING, ON, TIPPED, UPRIGHT
from ictamp_drake.symbolic.context import GeneratorContext
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.symbolic.goal import Goal
from ictamp_drake.symbolic.skeletons import BreadthFirst
from ictamp_drake.tamp.method import SCENE_METHOD

T = TypeVar("T")
SUPPORTS = ("rack", "table", "tray")
SIZES = (4, 6, 8, 12, 20, 30)
ROUNDS = 3


def time_call(call: Callable[[], T]) -> tuple[float, T]:
    """Return the minimum processor time of several calls [s], and the result of the last call."""
    seconds = []
    for _ in range(ROUNDS):
        start = time.process_time()
        result = call()
        seconds.append(time.process_time() - start)
    return min(seconds), result


def atoms_of_towers(towers: list[tuple[str, ...]], tipped: frozenset[str]) -> State:
    """Return the atoms that tell on what each box of the towers rests. A tower begins with its support."""
    pairs = [pair for tower in towers for pair in pairwise(tower)]
    return frozenset(Atom(LYING if box in tipped else ON, (box, below)) for below, box in pairs)


def initial(towers: list[tuple[str, ...]], tipped: frozenset[str]) -> State:
    """Return the state with these towers and an empty hand."""
    postures = {Atom(TIPPED if box in tipped else UPRIGHT, (box,)) for tower in towers for box in tower[1:]}
    return (
        atoms_of_towers(towers, tipped)
        | postures
        | {Atom(CLEAR, (tower[-1],)) for tower in towers}
        | {Atom(HAND_EMPTY, ())}
    )


def report(name: str, towers: list[tuple[str, ...]], wanted: list[tuple[str, ...]], tipped: frozenset[str]) -> None:
    """Print the row of a problem."""
    boxes = tuple(sorted(box for tower in towers for box in tower[1:]))
    start, goal = initial(towers, tipped), atoms_of_towers(wanted, tipped)
    seconds, domain = time_call(lambda: Domain.create(boxes, SUPPORTS, start))
    row = f"{name:24} {len(domain.actions):8} {seconds:10.3f}"
    for config in (SCENE_METHOD.generator_config, BreadthFirst()):

        def first_plan() -> tuple[int, int]:
            stream = config.create(GeneratorContext(domain, start, Goal.of(goal)))  # noqa: B023  (called at once)
            plan = stream.next_plan(1_000_000)
            return (0 if plan is None else len(plan)), stream.expanded

        seconds, (length, expanded) = time_call(first_plan)
        row += f" {length:8} {expanded:9} {seconds:8.3f}"
    print(row)


def main() -> None:
    """Print the table."""
    print(f"{'':44} {'best-first':>27} {'breadth-first':>27}")
    columns = f" {'actions':>8} {'nodes':>9} {'s':>8}"
    print(f"{'boxes':24} {'actions':>8} {'ground [s]':>10}{columns}{columns}")
    for size in SIZES:
        boxes = [f"box_{number:02}" for number in range(size)]
        pairs = list(zip(boxes[::2], boxes[1::2], strict=True))
        turned = [("rack", above, below) for below, above in pairs]
        report(f"{size} in towers of two", [("table", *pair) for pair in pairs], turned, frozenset(boxes[::4]))
    crowd = [(SUPPORTS[number % 3], f"box_{number:02}") for number in range(21)]
    moved = [(SUPPORTS[(number + 1) % 3], f"box_{number:02}") for number in range(5)]
    report("21, five of them moved", crowd, moved, frozenset())


if __name__ == "__main__":
    main()
