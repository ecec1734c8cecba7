"""Small scenes, to count needless skills: `python benchmarks/small_scenes.py` writes benchmarks/scenes/small.

A table, a rack and a block. Fifteen scenes of each kind: put (boxes go onto another support), tower (boxes that stand
around become a tower), swap (boxes change places, or a tower is turned over) and neighbours (a box that stands between
others goes onto another support). Those in `development` have two to five boxes, those in `evaluation` two or three.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import tyro

from benchmarks.scenes import SCENES
from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.scenes.levels import SUPPORTS, goal_of
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, SupportSpec, Vector, save_scene

SMALL = SCENES / "small"
MOST_BOXES = {"development": 5, "evaluation": 3}
KINDS = ("put", "tower", "swap", "neighbours")
COUNT = 60

_ROOM = ((0.3, 0.6), (-0.14, 0.16))
"""Part of the table for boxes, beside the rack and the block: bounds in x and y [m]."""
_GAP = 0.02
"""Minimum distance between the circumscribed circles of boxes that are not neighbours [m]."""
_NEIGHBOUR = (0.005, 0.02)
"""Distance between neighbours [m]."""


@dataclass(frozen=True)
class Options:
    """Write the scenes.

    Attributes:
        out: Folder in which the sets of scenes get a folder each.
    """

    out: Path = SMALL


def make_scene(group: str, number: int) -> SceneSpec:
    """Make the scene of that number; the same arguments always give the same scene."""
    kind = KINDS[number % len(KINDS)]
    rng = generator(Stream.SCENES, [*MOST_BOXES].index(group), number, 0, 0, 0)
    count = int(rng.integers(2, MOST_BOXES[group] + 1))
    names = [f"box_{letter}" for letter in "abcde"[:count]]
    sizes = {name: _size(rng) for name in names}
    height = round(rng.uniform(0.02, 0.15), 3)
    block = SupportSpec("table", (round(rng.uniform(0.38, 0.5), 3), 0.31, height), size=(0.18, 0.18, height))
    supports = {**SUPPORTS, "block": block}
    stacks, towers = _arrange(kind, names, rng)
    boxes = dict[str, BoxSpec]()
    while not boxes:
        boxes = _stand(stacks, sizes, supports, kind == "neighbours", rng)
    goal = goal_of(*towers)
    return SceneSpec(supports=supports, boxes=boxes, goal=goal, seed=number, description=f"{kind}: {goal}")


def write_scenes(out: Path) -> None:
    """Write all scenes as SET/00.yaml, 01.yaml, …."""
    for group in MOST_BOXES:
        (out / group).mkdir(parents=True, exist_ok=True)
        for number in range(COUNT):
            save_scene(make_scene(group, number), out / group / f"{number:02d}.yaml")


def _size(rng: np.random.Generator) -> Vector:
    width, depth, height = (round(rng.uniform(*bounds), 3) for bounds in ((0.04, 0.06), (0.04, 0.07), (0.05, 0.1)))
    return width, depth, height


def _arrange(kind: str, names: list[str], rng: np.random.Generator) -> tuple[list[list[str]], list[list[str]]]:
    """Return the stacks at the start and the towers of the goal, each from its support up."""
    supports = [str(name) for name in rng.permutation([*SUPPORTS, "block"])]
    alone = [["table", name] for name in names]
    chosen = names[: int(rng.integers(1, min(3, len(names)) + 1))]
    if kind == "put":
        here, there, _ = supports
        raised = str(rng.choice(["rack", "block"]))
        return [[here, names[0]], *alone[1:]], [[there, names[0]], [raised, names[1]]][: len(chosen)]
    if kind == "tower":
        return alone, [[supports[0], *names[: max(2, len(chosen))]]]
    if kind == "swap" and rng.random() < 0.5:
        here, there, _ = supports
        (first, second), rest = names[:2], alone[2:]
        return [[here, first], [there, second], *rest], [[there, first], [here, second]]
    if kind == "swap":
        pile = names[: max(2, len(chosen))]
        return [[supports[0], *pile], *alone[len(pile) :]], [[supports[int(rng.integers(2))], *reversed(pile)]]
    return alone, [[str(rng.choice(["rack", "block"])), names[0]]]


def _stand(
    stacks: list[list[str]],
    sizes: dict[str, Vector],
    supports: dict[str, SupportSpec],
    crowded: bool,
    rng: np.random.Generator,
) -> dict[str, BoxSpec]:
    """Stand the stacks at random on their supports; empty if two of them are too close to each other.

    In a crowd, the second box and the third stand on two sides of the first, at a short distance.
    """
    boxes = dict[str, BoxSpec]()
    circles: list[tuple[float, float, float]] = []
    for place, (support, *names) in enumerate(stacks):
        center, yaw = _spot(supports[support], support == "table", rng), round(rng.uniform(-180, 180), 1)
        if crowded and place in (1, 2):
            first, side = boxes[stacks[0][1]], 3 - 2 * place
            yaw = first.rotation[2]
            distance = side * ((first.size[0] + sizes[names[0]][0]) / 2 + rng.uniform(*_NEIGHBOUR))
            along = math.cos(math.radians(yaw)), math.sin(math.radians(yaw))
            center = tuple(round(x + distance * u, 4) for x, u in zip(first.position[:2], along, strict=True))
        else:
            circles.append((*center, max(math.hypot(*sizes[name][:2]) / 2 for name in names)))
        top = supports[support].position[2]
        for name in names:
            z = round(top + sizes[name][2] / 2, 6)
            boxes[name] = BoxSpec(sizes[name], (center[0], center[1], z), (0.0, 0.0, yaw))
            top += sizes[name][2]
    if crowded:
        circles[0] = (*circles[0][:2], 0.13)
    pairs = ((one, other) for place, one in enumerate(circles) for other in circles[:place])
    clear = all(math.dist(a[:2], b[:2]) >= a[2] + b[2] + _GAP for a, b in pairs)
    return boxes if clear else {}


def _spot(support: SupportSpec, is_table: bool, rng: np.random.Generator) -> tuple[float, float]:
    x, y = support.position[:2]
    bounds = _ROOM if is_table else ((x - 0.03, x + 0.03), (y - 0.03, y + 0.03))
    x, y = (round(rng.uniform(*bound), 4) for bound in bounds)
    return x, y


if __name__ == "__main__":
    write_scenes(tyro.cli(Options, description=__doc__).out)
