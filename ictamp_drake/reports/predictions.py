"""Predictions of estimators for cases whose success was counted."""

from collections.abc import Iterator, Mapping, Sequence
from itertools import groupby
from typing import NamedTuple

import numpy as np

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.types import FloatArray, Skeleton, State
from ictamp_drake.estimators.context import EstimatorConfig, EstimatorContext
from ictamp_drake.learning.cases import Case
from ictamp_drake.learning.dataset import scene
from ictamp_drake.symbolic.continuation import continue_plan
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.tamp.symbols import domain_of, goal_of
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.world import World


class Prediction(NamedTuple):
    """A case and the estimates of its success.

    Attributes:
        case: Case whose success was counted.
        plan: Plan that begins with the case's action and continues to the goal of the scene.
        estimates: Estimates of all contenders, shape (contenders,).
    """

    case: Case
    plan: Skeleton
    estimates: FloatArray


def group_by_scene(cases: Sequence[Case]) -> list[list[Case]]:
    """Group the cases by scene."""
    ordered = sorted(cases, key=lambda case: case.scene)
    return [list(group) for _, group in groupby(ordered, key=lambda case: case.scene)]


def ask_contenders(cases: Sequence[Case], contenders: Mapping[str, EstimatorConfig]) -> list[Prediction]:
    """Ask all contenders about the cases of one scene.

    Cases whose action does not apply in H(c) are left out: rows hold 32-bit numbers, which can flip a predicate.
    """
    world = World(scene(cases[0].spec))
    planned = list(_plan_cases(world, cases))
    options = [(case.c, plan) for case, plan in planned]
    estimates = np.array([config.create(EstimatorContext(world)).estimate(options) for config in contenders.values()])
    return [Prediction(case, plan, each) for (case, plan), each in zip(planned, estimates.T, strict=True)]


def _plan_cases(world: World, cases: Sequence[Case]) -> Iterator[tuple[Case, Skeleton]]:
    """Yield each case with its plan, except cases without a plan."""
    spec, abstraction = world.spec, SceneAbstraction(world)
    goal = goal_of(spec)
    domains: dict[State, Domain] = {}
    for case in cases:
        state = abstraction(case.c)
        try:
            yield case, continue_plan(_domain(world, state, domains), state, case.action, goal)
        except (IctampError, ValueError):
            continue


def _domain(world: World, state: State, known: dict[State, Domain]) -> Domain:
    """Domain as planning sets it up, created once for each combination of upright and tipped boxes."""
    posture = frozenset(atom for atom in state if atom.predicate in ("upright", "tipped"))
    if posture not in known:
        known[posture] = domain_of(world.spec, state)
    return known[posture]
