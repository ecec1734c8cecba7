"""Regions and poses: named places on the top faces of supports, for goals and for boxes put down on the way."""

import math
from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from itertools import combinations, product

import numpy as np

from ictamp_drake.core.checks import check_choice, check_range, check_vector
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.types import FloatArray

MAX_REGIONS = 20
"""Maximum number of regions, and of poses, of a scene."""

Pair = tuple[float, float]


@dataclass(frozen=True)
class RegionSpec:
    """A rectangle on the top face of a support. A box is in it when its center is above it.

    Attributes:
        on: Name of the support.
        size: Sides along x and y of the region's frame [m].
        position: Center in the support's frame T, x and y [m].
        yaw: Rotation about T's z axis [deg].
    """

    on: str
    size: Pair
    position: Pair = (0.0, 0.0)
    yaw: float = 0.0

    def __post_init__(self) -> None:
        check_vector("size", self.size, 0.01, 5, " m", count=2)
        _check_place(self.position, self.yaw)

    @property
    def X_TR(self) -> FloatArray:
        """Pose of the region's frame R in the support's frame T, shape (7,)."""
        return _pose(self.position, self.yaw)

    @property
    def marks(self) -> tuple[Pair, ...]:
        """Sides of the rectangles that show the region, along its frame's x and y [m]."""
        return (self.size,)


@dataclass(frozen=True)
class PoseSpec:
    """A place on the top face of a support for the center of one box, with its yaw.

    A half turn makes no difference to a box, nor does a quarter turn to one with a square footprint.

    Attributes:
        on: Name of the support.
        position: Position of the box's center in the support's frame T, x and y [m].
        yaw: Rotation of the box's upright frame U about T's z axis [deg].
        tolerance: Largest distance from the position [m] and largest deviation from the yaw [deg].
    """

    on: str
    position: Pair
    yaw: float = 0.0
    tolerance: Pair = (0.01, 5.0)

    def __post_init__(self) -> None:
        _check_place(self.position, self.yaw)
        check_range("tolerance[0]", self.tolerance[0], 0.002, 1, " m")
        check_range("tolerance[1]", self.tolerance[1], 1, 180, " deg")

    @property
    def size(self) -> Pair:
        """Sides of the square around the positions within the tolerance [m]."""
        return 2 * self.tolerance[0], 2 * self.tolerance[0]

    @property
    def X_TR(self) -> FloatArray:
        """Pose of the place's frame R in the support's frame T, shape (7,)."""
        return _pose(self.position, self.yaw)

    @property
    def marks(self) -> tuple[Pair, ...]:
        """Sides of the rectangles that show the pose [m]: a cross whose longer arm is along its frame's x."""
        return (0.1, 0.01), (0.01, 0.06)


Area = RegionSpec | PoseSpec


def check_areas(sections: Mapping[str, Mapping[str, Area]], supports: Mapping[str, tuple[float, ...]]) -> None:
    """Raise IctampError unless all areas lie on their supports and none overlaps another one.

    Args:
        sections: Regions and poses by name, by the name of their section.
        supports: Sizes of the supports by name.
    """
    corners: dict[str, FloatArray] = {}
    for section, areas in sections.items():
        if len(areas) > MAX_REGIONS:
            problem = f"expected at most {MAX_REGIONS}, got {{value}}"
            raise IctampError(Code.TOO_LARGE, problem, field=section, value=len(areas))
        for name, area in areas.items():
            check_choice(f"{section}.{name}.on", area.on, supports)
            corners[f"{section}.{name}"] = _corners(area)
            beyond = float((np.abs(_corners(area)) - np.array(supports[area.on][:2]) / 2).max())
            if beyond > 1e-9:
                problem = f"{{value}} reaches beyond the top of {area.on} by {1000 * beyond:.0f} mm"
                advice = "move it, or make it smaller"
                raise IctampError(Code.OUT_OF_RANGE, problem, field=f"{section}.{name}", value=name, advice=advice)
    every = [(f"{section}.{name}", area) for section, areas in sections.items() for name, area in areas.items()]
    for (field, one), (other_field, other) in combinations(every, 2):
        if one.on == other.on and _do_overlap(corners[field], corners[other_field]):
            names = [each.partition(".")[2] for each in (field, other_field)]
            problem = f"{names[0]} and {names[1]} overlap on {one.on}"
            raise IctampError(Code.OVERLAP, problem, field=other_field, value=names, advice="move one of them")


def _check_place(position: Pair, yaw: float) -> None:
    check_vector("position", position, -5, 5, " m", count=2)
    check_range("yaw", yaw, -360, 360, " deg")


def _pose(position: Pair, yaw: float) -> FloatArray:
    half = math.radians(yaw) / 2
    return np.array([math.cos(half), 0.0, 0.0, math.sin(half), *position, 0.0])


def _corners(area: Area) -> FloatArray:
    """Corners of the area in T, shape (4, 2) [m]."""
    c, s = math.cos(math.radians(area.yaw)), math.sin(math.radians(area.yaw))
    halves = np.array(list(product((-0.5, 0.5), repeat=2))) * area.size
    corners: FloatArray = halves @ np.array([[c, s], [-s, c]]) + area.position
    return corners


def _do_overlap(one: FloatArray, other: FloatArray) -> bool:
    """Whether two rectangles overlap, given by their corners, shape (4, 2) [m]: no side of either separates them."""
    return all(
        (one @ normal).max() > (other @ normal).min() + 1e-9 and (other @ normal).max() > (one @ normal).min() + 1e-9
        for normal in (*_normals(one), *_normals(other))
    )


def _normals(corners: FloatArray) -> Iterator[FloatArray]:
    for side in (corners[1] - corners[0], corners[2] - corners[0]):
        yield side / np.linalg.norm(side)
