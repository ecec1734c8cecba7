"""Training scenes: packing problems under other seeds, and wider scenes.

Wider scenes have one to six boxes of random sizes, alone, stacked or tipped. They are on the table, on racks and blocks
anywhere within reach, behind the arm's base, and close to each other. All scenes are drawn from the stream DATA, which
no problem uses.
"""

import numpy as np

from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.models.things import WIDEST
from ictamp_drake.scenes.clutter import random_boxes, random_supports
from ictamp_drake.scenes.levels import PAPER_LEVELS
from ictamp_drake.scenes.packing import make_problem
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, Vector

CYCLE = 8
"""Period of the mix of scenes: one easy, one medium, one hard, and the rest wider ones."""

MAX_BOXES = 6


def training_scene(number: int, seed: int = 0) -> SceneSpec:
    """Create the scene of that number. The same arguments always give the same scene."""
    kind = number % CYCLE
    if kind < len(PAPER_LEVELS):
        return make_problem(list(PAPER_LEVELS)[kind], number // CYCLE, seed, Stream.DATA)
    rng = generator(Stream.DATA, seed, kind, number)
    boxes: dict[str, BoxSpec] = {}
    while not boxes:
        supports = random_supports(rng)
        sizes = {f"box_{number}": _size(rng) for number in range(rng.integers(1, MAX_BOXES + 1))}
        boxes, _ = random_boxes(supports, sizes, rng)
    return SceneSpec(
        supports=supports,
        boxes=boxes,
        goal=f"(on {min(boxes)} table)",
        seed=number,
        description=f"Boxes of random sizes on {', '.join(supports)}.",
    )


def _size(rng: np.random.Generator) -> Vector:
    """Random sides of a box that the hand can grip, whichever way it lies [m]."""
    wide = rng.random() < 0.15
    depth, height = ((WIDEST, 0.095), (0.04, WIDEST)) if wide else ((0.035, WIDEST), (0.04, 0.13))
    return round(rng.uniform(0.035, WIDEST), 3), round(rng.uniform(*depth), 3), round(rng.uniform(*height), 3)
