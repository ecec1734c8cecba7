"""Symbolic side of a scene: its goal and its ground domain."""

import math

from ictamp_drake.core.types import State
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.symbolic.goal import Goal
from ictamp_drake.symbolic.goal_reading import parse_goal


def goal_of(spec: SceneSpec) -> Goal:
    """Read the goal of a scene.

    Raises:
        IctampError: It is not a goal, or it contradicts itself.
    """
    supports = {name: area.on for name, area in spec.areas.items()}
    return parse_goal(spec.goal, sorted(spec.boxes), sorted(spec.supports), kinds_of(spec), supports)


def domain_of(spec: SceneSpec, state: State) -> Domain:
    """Ground the domain of a scene, with roomy places first; the state says which boxes are upright.

    Raises:
        IctampError: The name of an object is taken, or a box of the state is not in exactly one place.
    """
    roomiest_first = sorted(spec.places, key=lambda name: -math.prod(spec.places[name].size[:2]))
    return Domain.create(sorted(spec.boxes), roomiest_first, state, kinds_of(spec))


def kinds_of(spec: SceneSpec) -> dict[str, str]:
    """Return "region" or "pose" by the name of each region and pose."""
    return {**dict.fromkeys(spec.regions, "region"), **dict.fromkeys(spec.poses, "pose")}
