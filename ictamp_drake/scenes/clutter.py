"""Supports and stacks of boxes at random spots around the arm, for training scenes and the level `varied`.

The arm's base is the origin, as in `scenes.layout`, and stands on the table.
"""

import math
from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np

from ictamp_drake.scenes.layout import Spot, Stack, build_stack, outline_radius
from ictamp_drake.scenes.levels import SUPPORTS
from ictamp_drake.scenes.spec import BoxSpec, SupportSpec, Vector

_MAX_STACK = 4
_NEAR, _FAR = 0.27, 0.70
"""Smallest and largest distance of stacks from the arm's base [m]."""
_GAP = 0.003
"""Minimum free space between outlines, and from an outline to the edge of its support [m]."""
_TRIES = 300


class _Circle(NamedTuple):
    spot: Spot
    radius: float


def random_supports(rng: np.random.Generator) -> dict[str, SupportSpec]:
    """A table and, on it, up to two more supports, mostly racks and sometimes blocks."""
    supports, taken = {"table": SUPPORTS["table"]}, list[_Circle]()
    for number in range(rng.choice(3, p=[0.15, 0.55, 0.3])):
        rack = rng.random() < 0.75
        height = round(rng.uniform(0.06, 0.28) if rack else rng.uniform(0.02, 0.08), 3)
        size = (round(rng.uniform(0.14, 0.3), 3), round(rng.uniform(0.14, 0.34), 3), height)
        radius = math.hypot(*size[:2]) / 2
        spots = (_polar(rng.uniform(radius + 0.15, 0.6), rng) for _ in range(_TRIES))
        on_table = (_Circle(spot, radius) for spot in spots if min(_margins(spot, SUPPORTS["table"])) >= 0.7 * radius)
        here = next((circle for circle in on_table if not _crowds(circle, taken)), None)
        if here is not None:
            taken.append(here)
            name = f"{'rack' if rack else 'block'}_{number}"
            supports[name] = SupportSpec("rack" if rack else "table", (*here.spot, height), _turn(rng), size)
    return supports


def random_boxes(
    supports: dict[str, SupportSpec], sizes: dict[str, Vector], rng: np.random.Generator
) -> tuple[dict[str, BoxSpec], dict[str, str]]:
    """Stacks of boxes on the supports, and what each box stands on. Boxes that find no room are left out."""
    crowded = rng.random() < 0.5
    carriers = dict[str, str]()
    boxes, taken = dict[str, BoxSpec](), list[_Circle]()
    for names in _columns(list(sizes), rng):
        stack = build_stack(names, sizes, len(names) == 1 and rng.random() < 0.25, rng)
        where = str(rng.choice(list(supports))) if rng.random() < 0.5 else "table"
        radius = outline_radius(stack)
        spots = _spots(supports[where], taken if crowded else (), radius, rng)
        here = _room(spots, radius, where, supports, taken)
        if here is not None:
            taken.append(here)
            boxes |= _stand(stack, here.spot, supports[where].position[2], sizes, rng)
            carriers |= dict(zip(names, (where, *names), strict=False))
    return boxes, carriers


def _columns(names: Sequence[str], rng: np.random.Generator) -> list[list[str]]:
    columns: list[list[str]] = []
    for name in names:
        growing = [column for column in columns if len(column) < _MAX_STACK]
        if growing and rng.random() < 0.5:
            growing[rng.integers(len(growing))].append(name)
        else:
            columns.append([name])
    return columns


def _spots(support: SupportSpec, beside: Sequence[_Circle], radius: float, rng: np.random.Generator) -> Iterator[Spot]:
    """Random spots on a support, most of them next to the circles of `beside` if there are any."""
    for _ in range(_TRIES):
        if beside and rng.random() < 0.8:
            other = beside[int(rng.integers(len(beside)))]
            yield _polar(other.radius + radius + rng.uniform(2 * _GAP, 10 * _GAP), rng, other.spot)
        elif support == SUPPORTS["table"]:
            yield _polar(rng.uniform(_NEAR, _FAR), rng)
        else:
            x, y, _ = support.position
            yield _polar(rng.uniform(0, max(support.size[:2]) / 2), rng, (x, y))


def _room(
    spots: Iterator[Spot], radius: float, where: str, supports: dict[str, SupportSpec], taken: Sequence[_Circle]
) -> _Circle | None:
    """The first spot on a support that is within reach and clear of everything else, or None."""
    support = supports[where]
    obstacles = [each for name, each in supports.items() if where == "table" != name]
    for spot in spots:
        here = _Circle(spot, radius)
        inside = all(value >= radius + _GAP for value in _margins(here.spot, support))
        apart = all(min(_margins(here.spot, each)) <= -radius - 4 * _GAP for each in obstacles)
        if inside and apart and _NEAR <= math.hypot(*here.spot) <= _FAR and not _crowds(here, taken):
            return here
    return None


def _crowds(here: _Circle, taken: Sequence[_Circle]) -> bool:
    return any(math.dist(here.spot, other.spot) < here.radius + other.radius + _GAP for other in taken)


def _margins(spot: Spot, support: SupportSpec) -> tuple[float, float]:
    """Distances of a point from a support's edges along both of its axes, negative outside [m]."""
    x, y = spot[0] - support.position[0], spot[1] - support.position[1]
    cos, sin = math.cos(math.radians(support.yaw)), math.sin(math.radians(support.yaw))
    return support.size[0] / 2 - abs(cos * x + sin * y), support.size[1] / 2 - abs(cos * y - sin * x)


def _polar(distance: float, rng: np.random.Generator, about: Spot = (0.0, 0.0)) -> Spot:
    angle = rng.uniform(-math.pi, math.pi)
    return round(about[0] + distance * math.cos(angle), 4), round(about[1] + distance * math.sin(angle), 4)


def _turn(rng: np.random.Generator) -> float:
    return round(rng.uniform(-180, 180), 1)


def _stand(
    stack: Stack, spot: Spot, floor: float, sizes: dict[str, Vector], rng: np.random.Generator
) -> dict[str, BoxSpec]:
    boxes = {}
    for piece in stack:
        x, y = round(spot[0] + piece.offset[0], 4), round(spot[1] + piece.offset[1], 4)
        red, green, blue = rng.uniform(0.15, 0.9, 3).round(2).tolist()
        position = (x, y, round(floor + piece.z, 6))
        boxes[piece.name] = BoxSpec(sizes[piece.name], position, piece.rotation, color=(red, green, blue))
    return boxes
