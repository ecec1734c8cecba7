"""Generator of the level `extreme`: two towers on a rack that bystanders crowd, with all six boxes.

One or two boxes are bystanders. They stand or lie on the rack and leave just enough room for the two towers of the
goal. One of two may instead be behind the arm's base, or stacked: on a tower on the table, or on the foot of a tower of
the goal, which is on the rack already and must be cleared. The other boxes of the goal stand on the table in one or two
towers, in the order of the goal, so that most must be put aside first. At most one box of each tower of the goal is
tipped: it lies on the table at the start, and at the foot or on top of its tower at the end. If only one box is tipped,
it lies so close to the boxes of the other tower that the hand can hardly reach it before they are gone. Problems whose
number is a multiple of three are plain: two bystanders stand on the rack. The others cycle through the mixes of
interferences.
"""

import itertools
import math
from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.core.types import FloatArray
from ictamp_drake.scenes.layout import (
    RACK_FOOTPRINT,
    Spot,
    Stack,
    Zone,
    build_stack,
    outline_radius,
    place_stacks,
)
from ictamp_drake.scenes.levels import SIZES, SUPPORTS, boxes_of, goal_of
from ictamp_drake.scenes.spec import INTERFERENCES, BoxSpec, SceneSpec

RACK_ROOM = 0.015
"""Minimum free space between the circles around stacks on the rack, including the towers of the goal [m]."""

LEAST_SHARE = 0.05
"""Minimum share of random spots for the goal's towers, clear of each other, that the bystanders leave free."""

Tower = tuple[str, ...]
"""Boxes on top of each other, from the bottom up."""
Kinds = tuple[str, ...]

_STREAM = 8
"""Key of the level's random numbers. Smaller keys belong to the other levels and to training scenes."""
_DRAWS = 300
_PLAIN: tuple[Kinds, ...] = ((), ())
_MIXES: tuple[tuple[Kinds, ...], ...] = (
    (("tipped",),),
    ((), ("stacked",)),
    ((), ("behind",)),
    ((), ("tipped",)),
    (("tipped",), ("stacked",)),
    (("tipped",), ("behind",)),
)
"""Interferences of each bystander. A bystander that is neither stacked nor behind is on the rack."""


class _Cast(NamedTuple):
    """Roles of the boxes in a problem.

    Attributes:
        towers: The two towers of the goal.
        bystanders: Boxes outside the goal, with their interferences.
        tipped: All boxes that lie on a side.
    """

    towers: tuple[Tower, Tower]
    bystanders: dict[str, Kinds]
    tipped: frozenset[str]

    def list_by_kind(self, kind: str) -> list[str]:
        """Bystanders with that kind of interference."""
        return [name for name, kinds in self.bystanders.items() if kind in kinds]

    def find_to_clear(self) -> list[str]:
        """Foot of the second tower, if it is already on the rack with the stacked bystander on it."""
        tower = self.towers[1]
        return [tower[0]] if self.list_by_kind("stacked") and self.tipped.isdisjoint(tower) else []

    def find_barred(self) -> list[str]:
        """Lying box of one tower, if all boxes of the other form a single tower that blocks the hand's way to it."""
        if self.find_to_clear():
            return []
        pairs = self.towers, self.towers[::-1]
        return [name for own, other in pairs if self.tipped.isdisjoint(other) for name in self.tipped.intersection(own)]


def make_extreme(number: int, seed: int, stream: Stream) -> SceneSpec:
    """Create the problem of that number. The same arguments always give the same problem."""
    rng = generator(stream, seed, _STREAM, number)
    kinds = _kinds(number)
    rack_spots = None
    while rack_spots is None:
        cast = _draw_cast(kinds, rng)
        on_table, on_rack = (
            _stacks(columns, cast, rng) for columns in (_stacks_on_table(cast, rng), _stacks_on_rack(cast))
        )
        rack_spots = _rack_spots(on_rack, _radii(cast.towers, [*on_table, *on_rack]), rng)
    boxes = dict[str, BoxSpec]()
    spots = _table_spots(on_table, cast, rng)
    for stack, spot in zip(on_table, spots, strict=True):
        boxes |= boxes_of(_turn_stack(stack, spot, spots[0]) if stack[0].name in cast.find_barred() else stack, spot)
    for stack, spot in zip(on_rack, rack_spots, strict=True):
        boxes |= boxes_of(stack, spot, SUPPORTS["rack"].position[2])
    return SceneSpec(
        supports=SUPPORTS,
        boxes=boxes,
        goal=goal_of(*(("rack", *tower) for tower in cast.towers), tipped=cast.tipped),
        seed=number,
        interference=tuple(kind for kind in INTERFERENCES if any(kind in each for each in kinds)),
        description=_describe(cast),
    )


def _kinds(number: int) -> tuple[Kinds, ...]:
    if number % 3 == 0:
        return _PLAIN
    return _MIXES[(number - number // 3 - 1) % len(_MIXES)]


def _draw_cast(kinds: tuple[Kinds, ...], rng: np.random.Generator) -> _Cast:
    names = sorted(SIZES)
    rng.shuffle(names)
    bystanders = dict(zip(names, kinds, strict=False))
    packed = names[len(kinds) :]
    towers = tuple(packed[:-2]), tuple(packed[-2:])
    tipped = {name for name, each in bystanders.items() if "tipped" in each}
    tipped |= {tower[-rng.integers(2)] for tower in towers if rng.random() < 0.5}
    return _Cast(towers, bystanders, frozenset(tipped))


def _stacks_on_rack(cast: _Cast) -> list[list[str]]:
    """Columns of boxes on the rack, each from the bottom up."""
    alone = [[name] for name, kinds in cast.bystanders.items() if not {"stacked", "behind"} & {*kinds}]
    return alone + [[foot, *cast.list_by_kind("stacked")] for foot in cast.find_to_clear()]


def _stacks_on_table(cast: _Cast, rng: np.random.Generator) -> list[list[str]]:
    """Columns of boxes on the table: one or two towers first, then lying boxes of the goal, then what is behind."""
    towers = sorted(cast.towers, key=lambda tower: not cast.tipped.isdisjoint(tower))
    packed = [name for name in itertools.chain(*towers) if name not in cast.find_to_clear()]
    standing, lying = ([name for name in packed if (name in cast.tipped) is tipped] for tipped in (False, True))
    cut = len(towers[0]) if cast.find_barred() else int(rng.integers(2, len(standing) + 1))
    columns = [column for column in (standing[:cut], standing[cut:]) if column]
    if not cast.find_to_clear():
        columns[rng.integers(len(columns))] += cast.list_by_kind("stacked")
    return columns + [[name] for name in (*lying, *cast.list_by_kind("behind"))]


def _stacks(columns: Sequence[Sequence[str]], cast: _Cast, rng: np.random.Generator) -> list[Stack]:
    return [build_stack(column, SIZES, column[0] in cast.tipped, rng) for column in columns]


def _table_spots(stacks: Sequence[Stack], cast: _Cast, rng: np.random.Generator) -> list[Spot]:
    """Centers of the stacks on the table. The barred box and about half of the others are next to the first stack."""
    feet, behind = [stack[0].name for stack in stacks], cast.list_by_kind("behind")
    zones = [Zone.TOWER, *(Zone.BEHIND if foot in behind else Zone.FRONT for foot in feet[1:])]
    close = [foot in cast.find_barred() or bool(rng.integers(2)) for foot in feet]
    nearby = [zone is Zone.FRONT and near for zone, near in zip(zones, close, strict=True)]
    return place_stacks([outline_radius(stack) for stack in stacks], zones, nearby, rng)


def _turn_stack(stack: Stack, spot: Spot, tower: Spot) -> Stack:
    """The lying box, turned so that its narrow side, across which it is gripped, is in the direction of the tower."""
    (piece,) = stack
    roll, pitch, _ = piece.rotation
    direction = math.degrees(math.atan2(tower[1] - spot[1], tower[0] - spot[0]))
    yaw = round(direction - (90 if piece.footprint[0] > piece.footprint[1] else 0), 1)
    return (piece._replace(rotation=(roll, pitch, yaw)),)


def _radii(towers: Sequence[Tower], stacks: Sequence[Stack]) -> dict[str, float]:
    """Radius of a circle around each tower that contains all its boxes as they lie or stand [m], by its foot."""
    radius = {piece.name: math.hypot(*piece.footprint) / 2 for stack in stacks for piece in stack}
    return {tower[0]: max(radius[name] for name in tower) for tower in towers}


def _rack_spots(stacks: Sequence[Stack], towers: dict[str, float], rng: np.random.Generator) -> list[Spot] | None:
    """Centers of the stacks on the rack where they crowd it most, or None when no draw leaves room for the towers.

    Args:
        stacks: Stacks on the rack at the start.
        towers: Radii of the goal's towers by foot [m].
        rng: Source of random numbers.
    """
    feet = [stack[0].name for stack in stacks]
    radii = [max(outline_radius(stack), towers.get(foot, 0.0)) for stack, foot in zip(stacks, feet, strict=True)]
    to_come = [radius for foot, radius in towers.items() if foot not in feet]
    crowds, pairs = _draws(radii, rng), _draws(to_come, rng)
    distance = np.linalg.norm(crowds[:, None, :, None] - pairs[None, :, None, :], axis=-1)
    fits = np.all(distance >= np.add.outer(radii, to_come) + RACK_ROOM, axis=(2, 3))
    share = fits.sum(axis=1) / max(1, len(pairs))
    usable = np.flatnonzero(share >= LEAST_SHARE)
    if not len(usable):
        return None
    return [(x, y) for x, y in crowds[usable[np.argmin(share[usable])]].tolist()]


def _draws(radii: Sequence[float], rng: np.random.Generator) -> FloatArray:
    """Random centers of circles on the rack that keep clear of each other, shape (m, len(radii), 2) [m]."""
    low, high = np.array(RACK_FOOTPRINT).T
    margin = np.array(radii)[:, None]
    spots = np.round(rng.uniform(low + margin, high - margin, (_DRAWS, len(radii), 2)), 4)
    clear = [
        np.linalg.norm(spots[:, a] - spots[:, b], axis=1) >= radii[a] + radii[b] + RACK_ROOM
        for a, b in itertools.combinations(range(len(radii)), 2)
    ]
    return spots[np.all([np.full(_DRAWS, True), *clear], axis=0)]


def _describe(cast: _Cast) -> str:
    lying = [f"{name} lies" for name in sorted(cast.tipped.difference(cast.bystanders))]
    others = [f"{name} {' and '.join(sorted(kinds)) or 'stands by'}" for name, kinds in cast.bystanders.items()]
    return f"Extreme: build two towers on a crowded rack; {', '.join([*lying, *others])}."
