"""Scenes of cubes for time measurements, ten of each kind: `python benchmarks/scenes.py` writes benchmarks/scenes.

Cubes with sides of 45 mm are spread over the table. Scattered: three to six cubes, two of which must go onto the rack.
A tower of n: n cubes, which must become a tower on the rack. `warm_up.yaml` is another tower of two, which is solved
before the measurements.
"""

import math
from dataclasses import dataclass
from pathlib import Path

import tyro

from ictamp_drake.core.files import write_whole
from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.scenes.layout import Zone, place_stacks
from ictamp_drake.scenes.levels import SUPPORTS, goal_of
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, Vector, to_yaml

SCENES = Path(__file__).with_suffix("")
WARM_UP = SCENES / "warm_up.yaml"
KINDS = ("scattered", "tower_2", "tower_3", "tower_4")
COUNT = 10
SIDE = 0.045
"""Side of a cube [m]."""
COLORS: tuple[Vector, ...] = (
    (0.8, 0.12, 0.1),
    (0.15, 0.3, 0.8),
    (0.95, 0.8, 0.15),
    (0.2, 0.6, 0.2),
    (0.15, 0.75, 0.8),
    (0.5, 0.2, 0.6),
)


@dataclass(frozen=True)
class Options:
    """Write the scenes.

    Attributes:
        out: Folder in which each kind of scene gets a folder.
    """

    out: Path = SCENES


def make_scene(kind: str, number: int) -> SceneSpec:
    """Make the scene of that number; the same arguments always give the same scene.

    Its random generator has four keys, and those of levels and training have three, so that they share no numbers.
    """
    rng = generator(Stream.SCENES, 0, KINDS.index(kind), number, 0)
    count = int(rng.integers(3, 7)) if kind == "scattered" else int(kind[-1])
    names = [f"cube_{index}" for index in range(count)]
    spots = place_stacks([SIDE / math.sqrt(2)] * count, [Zone.FRONT] * count, [False] * count, rng)
    boxes = {
        name: BoxSpec((SIDE,) * 3, (*spot, SIDE / 2), (0.0, 0.0, round(rng.uniform(-180, 180), 1)), color=color)
        for name, spot, color in zip(names, spots, COLORS, strict=False)
    }
    if kind == "scattered":
        goal, description = goal_of(("rack", names[0]), ("rack", names[1])), f"Two of {count} cubes go onto the rack."
    else:
        goal, description = goal_of(("rack", *names)), f"A tower of {count} cubes is built on the rack."
    return SceneSpec(supports=SUPPORTS, boxes=boxes, goal=goal, seed=number, description=description)


def write_scenes(out: Path) -> None:
    """Write all scenes as KIND/00.yaml, 01.yaml, …, and the scene for warming up."""
    for kind in KINDS:
        (out / kind).mkdir(parents=True, exist_ok=True)
        for number in range(COUNT):
            _write(make_scene(kind, number), out / kind / f"{number:02d}.yaml")
    _write(make_scene("tower_2", COUNT), out / WARM_UP.name)


def _write(spec: SceneSpec, path: Path) -> None:
    """Write a scene in the spelling that older commits read, too; `against.py` hands it to both trees."""
    write_whole(path, to_yaml(spec).replace("color:", "colour:"))


if __name__ == "__main__":
    write_scenes(tyro.cli(Options, description=__doc__).out)
