"""Generator of the constrained packing problems. `scenes.extreme` and `scenes.varied` make those of our own levels.

A tower stands on the table and must stand in the same order on the rack. The boxes outside the goal interfere (paper,
Experiments). Problems whose number is a multiple of three are plain: the other boxes, of which hard has none, are
bystanders that stand on the table. In all other problems they are stacked (on the tower or on each other), behind the
arm's base, or tipped (lying on a long side). The problems cycle through the mixes of these kinds.

`python -m ictamp_drake.scenes.packing --level easy --seed 1 --count 10 --out FOLDER` makes more problems.
"""

import itertools
import sys
from pathlib import Path

import numpy as np
import tyro

from ictamp_drake.core.checks import check_choice
from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.scenes.extreme import make_extreme
from ictamp_drake.scenes.layout import Stack, Zone, build_stack, outline_radius, place_stacks
from ictamp_drake.scenes.levels import LEVELS, PAPER_LEVELS, SIZES, SUPPORTS, Level, boxes_of, goal_of
from ictamp_drake.scenes.spec import INTERFERENCES, BoxSpec, SceneSpec, save_scene
from ictamp_drake.scenes.varied import make_varied

MAX_STACK = 5
"""Maximum number of boxes in a tower. Higher towers sway, and the arm cannot lift boxes off them everywhere."""

Kinds = frozenset[str]
Roles = dict[str, Kinds]
"""Kinds of interference of each box outside the goal; none for a plain bystander."""

_BOX_KINDS = tuple(frozenset(kinds) for kinds in ((), ("stacked",), ("behind",), ("tipped",), ("behind", "tipped")))
_OWN = {"extreme": make_extreme, "varied": make_varied}
"""Generators of the levels that are not in the paper."""
_MIXES = tuple(frozenset(mix) for n in (1, 2, 3) for mix in itertools.combinations(INTERFERENCES, n))


def make_problem(level: str, number: int, seed: int = 0, stream: Stream = Stream.SCENES) -> SceneSpec:
    """Create the problem of that number. The same arguments always give the same problem.

    The committed files have seed 0 in the stream SCENES. Training scenes use another stream, e.g. DATA, and therefore
    never coincide with them, whatever their seeds.

    Raises:
        IctampError: The level does not exist.
    """
    check_choice("level", level, LEVELS)
    if level in _OWN:
        return _OWN[level](number, seed, stream)
    rng = generator(stream, seed, LEVELS.index(level), number)
    spec = PAPER_LEVELS[level]
    roles = _draw_roles(spec, number, rng)
    stacks = _build_stacks(spec.tower, roles, rng)
    zones = [Zone.TOWER, *(_zone(roles[stack[0].name]) for stack in stacks[1:])]
    interfering = any(roles.values())
    nearby = [zone is Zone.FRONT and interfering and bool(rng.integers(2)) for zone in zones]
    spots = place_stacks([outline_radius(stack) for stack in stacks], zones, nearby, rng)
    boxes = dict[str, BoxSpec]()
    for stack, spot in zip(stacks, spots, strict=True):
        boxes |= boxes_of(stack, spot)
    return SceneSpec(
        supports=SUPPORTS,
        boxes=boxes,
        goal=goal_of(("rack", *spec.tower)),
        seed=number,
        interference=tuple(kind for kind in INTERFERENCES if any(kind in kinds for kinds in roles.values())),
        description=_describe(level, roles),
    )


def _draw_roles(level: Level, number: int, rng: np.random.Generator) -> Roles:
    """Boxes outside the goal, each with its kinds of interference."""
    if number % 3 == 0:
        return dict.fromkeys(level.bystanders, frozenset())
    least = 1 if level.extras else 0
    casts = [level.bystanders + level.extras[:n] for n in range(least, len(level.extras) + 1)]
    mixes = [mix for mix in _MIXES if _assignments(mix, level, len(casts[-1]))]
    mix = mixes[(number - number // 3 - 1) % len(mixes)]
    fitting = [cast for cast in casts if _assignments(mix, level, len(cast))]
    cast = fitting[rng.integers(len(fitting))]
    assignments = _assignments(mix, level, len(cast))
    return dict(zip(cast, assignments[rng.integers(len(assignments))], strict=True))


def _assignments(mix: Kinds, level: Level, count: int) -> list[tuple[Kinds, ...]]:
    """All ways in which `count` boxes together show exactly the kinds of the mix without too high a tower."""
    every = itertools.product(_BOX_KINDS, repeat=count)
    room = MAX_STACK - len(level.tower)
    return [
        kinds
        for kinds in every
        if frozenset().union(*kinds) == mix and sum("stacked" in kind for kind in kinds) <= room
    ]


def _build_stacks(tower: tuple[str, ...], roles: Roles, rng: np.random.Generator) -> list[Stack]:
    """The tower first, with what is stacked on it, then all other stacks."""
    columns = [list(tower), *([name] for name, kinds in roles.items() if "stacked" not in kinds)]
    carriers = [column for column in columns if not roles.get(column[0])]
    for name, kinds in roles.items():
        if "stacked" in kinds:
            carriers[rng.integers(len(carriers))].append(name)
    return [build_stack(column, SIZES, "tipped" in roles.get(column[0], ()), rng) for column in columns]


def _zone(kinds: Kinds) -> Zone:
    return Zone.BEHIND if "behind" in kinds else Zone.FRONT


def _describe(level: str, roles: Roles) -> str:
    others = [f"{name} {' and '.join(sorted(kinds)) or 'stands by'}" for name, kinds in roles.items()]
    return f"{level.capitalize()}: rebuild the tower on the rack; {', '.join(others) or 'no other box'}."


def write_problems(level: str, out: Path, count: int = 10, seed: int = 0) -> None:
    """Write problem files 000.yaml, 001.yaml, … of a level.

    Args:
        level: Name of the level: easy, medium, hard, extreme or varied.
        out: Folder for the files, created if it does not exist.
        count: Number of problems.
        seed: Random seed. 0 gives the committed problems, any other gives new ones.
    """
    out.mkdir(parents=True, exist_ok=True)
    for number in range(count):
        save_scene(make_problem(level, number, seed), out / f"{number:03d}.yaml")


def main() -> None:
    """Run the command line of `write_problems`. An error is printed as one sentence and gives exit code 2."""
    try:
        tyro.cli(write_problems)
    except (IctampError, OSError) as error:
        print(error, file=sys.stderr)
        sys.exit(2)


if __name__ == "__main__":
    main()
