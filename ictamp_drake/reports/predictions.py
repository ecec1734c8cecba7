"""What estimators say of cases whose success was counted."""

import math
from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import NamedTuple

import numpy as np

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.types import FloatArray, Skeleton, State
from ictamp_drake.learning.cases import Case
from ictamp_drake.learning.dataset import scene
from ictamp_drake.reports.contenders import Contender
from ictamp_drake.symbolic.continuation import continue_plan
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.symbolic.goals import parse_goal
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.world import World


class Prediction(NamedTuple):
    """A case and what was said of it.

    Attributes:
        case: what was counted.
        plan: that begins with the case's action and goes on to the goal of the scene.
        estimates: by all contenders, shape (contenders,).
    """

    case: Case
    plan: Skeleton
    estimates: FloatArray


def group_by_scene(cases: Sequence[Case]) -> list[list[Case]]:
    """The cases of each scene."""
    ordered = sorted(cases, key=lambda case: case.scene)
    return [list(group) for _, group in groupby(ordered, key=lambda case: case.scene)]


def ask_contenders(cases: Sequence[Case], contenders: Mapping[str, Contender]) -> list[Prediction]:
    """Ask all contenders about the cases of one scene.

    Left out is a case whose action does not apply in H(c): rows hold 32-bit numbers, which can tip a predicate over.
    """
    world = World(scene(cases[0].spec))
    planned = list(_plan_cases(world, cases))
    options = [(case.c, plan) for case, plan in planned]
    estimates = np.array([config.create(world).estimate(options) for config in contenders.values()])
    return [Prediction(case, plan, each) for (case, plan), each in zip(planned, estimates.T, strict=True)]


def _plan_cases(world: World, cases: Sequence[Case]) -> Iterator[tuple[Case, Skeleton]]:
    """Each case with its plan."""
    spec, abstraction = world.spec, SceneAbstraction(world)
    goal = parse_goal(spec.goal, sorted(spec.boxes), sorted(spec.supports))
    domains: dict[State, Domain] = {}
    for case in cases:
        state = abstraction(case.c)
        try:
            yield case, continue_plan(_domain(world, state, domains), state, case.action, goal)
        except (IctampError, ValueError):
            continue


def _domain(world: World, state: State, known: dict[State, Domain]) -> Domain:
    """The domain as planning sets it up, once for each way in which the boxes are turned."""
    posture = frozenset(atom for atom in state if atom.predicate in ("upright", "tipped"))
    if posture not in known:
        supports = world.spec.supports
        roomiest_first = sorted(supports, key=lambda name: -math.prod(supports[name].size[:2]))
        known[posture] = Domain.create(sorted(world.spec.boxes), roomiest_first, state)
    return known[posture]
