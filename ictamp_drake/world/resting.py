"""Reasons why nothing carries a box, each in one sentence with the measure."""

from itertools import product
from typing import NamedTuple

import numpy as np

from ictamp_drake.core.types import Configuration, FloatArray
from ictamp_drake.world.config import PredicateConfig
from ictamp_drake.world.frames import Upright
from ictamp_drake.world.world import World

_BOTTOM: FloatArray = np.array(list(product((-0.5, 0.5), (-0.5, 0.5), (-0.5,))))
"""Corners of the lower face of a box with sides of 1, shape (4, 3)."""


class _Beneath(NamedTuple):
    """Receptacle below a box, and the box's position relative to its top face.

    Attributes:
        gap: Height of the box's lowest corner above the top face [m].
        beyond: Distance of the box's center beyond the edge [m], negative inside.
        overhang: Distance of the box's outermost corner beyond the edge [m].
        name: Name of the receptacle.
    """

    gap: float
    beyond: float
    overhang: float
    name: str


def explain_loose(world: World, c: Configuration, box: str, config: PredicateConfig) -> str:
    """Say why nothing carries the box: its tilt, the gap below it, or its overhang, and what is accepted."""
    lying = world.upright_frame(c, box)
    tilt = float(np.arccos(np.clip(lying.X_WU.rotation().matrix()[2, 2], -1.0, 1.0)))
    if tilt > config.tilt:
        return f"{box} is tilted by {_show_angle(tilt)}, expected at most {_show_angle(config.tilt)}"
    beneath = _find_beneath(world, c, box, lying, -config.contact)
    touching = [each for each in beneath if each.gap <= config.contact]
    if touching:
        nearest = min(touching, key=lambda each: each.beyond)
        if nearest.beyond <= 0:
            return f"{box} does not stand flat on {nearest.name}"
        edge = f"{box} overhangs the edge of {nearest.name} by {show_length(nearest.overhang)}"
        return f"{edge}, its center by {show_length(nearest.beyond)}, expected a center inside the edge"
    if beneath:
        nearest = min(beneath)
        gap, most = show_length(nearest.gap), show_length(config.contact)
        return f"{box} floats {gap} above {nearest.name}, expected at most {most}"
    return f"expected a place on top of something, but nothing is beneath {box}"


def show_length(length: float) -> str:
    """Write a length [m] in millimeters, to a tenth."""
    return f"{round(1000 * length, 1):g} mm"


def _show_angle(angle: float) -> str:
    return f"{round(np.degrees(angle), 1):g} deg"


def _find_beneath(world: World, c: Configuration, box: str, lying: Upright, least: float) -> list[_Beneath]:
    """Find what has an outline that meets the box's, and a top at least `least` [m] below it."""
    found = []
    for name in sorted({*world.spec.boxes, *world.spec.supports} - {box}):
        half = world.top_size(c, name) / 2
        X_TU = world.X_WT(c, name).inverse() @ lying.X_WU
        corners = (X_TU @ (_BOTTOM * lying.size).T).T
        low, high, gap = corners.min(axis=0)[:2], corners.max(axis=0)[:2], float(corners[:, 2].min())
        if np.all(low < half) and np.all(high > -half) and gap >= least:
            beyond = float(np.max(np.abs(X_TU.translation()[:2]) - half))
            found.append(_Beneath(gap, beyond, float(np.max(np.abs(corners[:, :2]) - half)), name))
    return found
