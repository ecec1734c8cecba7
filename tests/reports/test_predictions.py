"""Estimates of recorded cases."""

from collections.abc import Hashable, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np
import pytest

from ictamp_drake.core.types import Action, FloatArray, Skeleton
from ictamp_drake.estimators.context import EstimatorContext
from ictamp_drake.estimators.p_score import PScoreConfig
from ictamp_drake.learning.cases import Case, read_cases
from ictamp_drake.reports.predictions import ask_contenders, group_by_scene
from ictamp_drake.scenes.training import training_scene
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.world import World
from tests.learning.counted import folder_of, picks
from tests.learning.synthetic import write_untrained

EASY = 8  # number of a training scene whose goal takes several actions


@pytest.fixture(scope="module")
def cases(tmp_path_factory: pytest.TempPathFactory) -> list[Case]:
    """Picks in two scenes, two boxes in the second one."""
    tried = [(EASY, None), (EASY + 1, None)]
    rows = [picks(number, [True, False], box) for number, box in tried]
    found = read_cases(folder_of(tmp_path_factory.mktemp("attempts"), *rows), "pick", least=2)
    below = [_support_of(case) for case in found]
    return [
        replace(case, action=Action("pick", (case.action.args[0], on))) for case, on in zip(found, below, strict=True)
    ]


def _support_of(case: Case) -> str:
    """Object on which the case's box stands."""
    state = SceneAbstraction(World(training_scene(case.scene)))(case.c)
    (on,) = (
        atom.args[1] for atom in state if atom.predicate in ("on", "lying") and atom.args[0] == case.action.args[0]
    )
    return on


@dataclass
class Lengths:
    """An estimator that records its queries and answers with the lengths of the plans."""

    asked: list[tuple[Hashable, Skeleton]] = field(default_factory=list)

    def create(self, _: object) -> "Lengths":
        return self

    def estimate(self, options: Sequence[tuple[Hashable, Skeleton]]) -> FloatArray:
        self.asked += options
        return np.array([1 / len(plan) for _, plan in options])


def test_contenders_are_asked_about_c_and_a_plan_from_it_to_the_goal(cases: list[Case]) -> None:
    lengths = Lengths()
    for group in group_by_scene(cases):
        predictions = ask_contenders(group, {"lengths": lengths})
        assert [each.case for each in predictions] == group
        for each in predictions:
            world = World(training_scene(each.case.scene))
            assert each.plan.states[0] == SceneAbstraction(world)(each.case.c)
            assert each.plan.actions[0] == each.case.action
            assert each.estimates.tolist() == [1 / len(each.plan)]
    assert [c for c, _ in lengths.asked] == [case.c for case in cases]
    assert len(lengths.asked[0][1]) >= 4


def test_estimates_are_those_of_the_estimators(cases: list[Case], tmp_path: Path) -> None:
    config = PScoreConfig(write_untrained(tmp_path))
    for case in cases:
        (prediction,) = ask_contenders([case], {"lengths": Lengths(), "P": config})
        world = World(training_scene(case.scene))
        alone = config.create(EstimatorContext(world)).estimate(
            [(case.c, Skeleton((frozenset(), frozenset()), (case.action,)))]
        )
        np.testing.assert_allclose(prediction.estimates[1], alone[0], rtol=1e-5)


def test_cases_come_scene_by_scene(cases: list[Case]) -> None:
    assert group_by_scene([cases[1], cases[0], cases[1]]) == [[cases[0]], [cases[1], cases[1]]]


def test_an_action_that_does_not_apply_in_c_is_left_out(cases: list[Case]) -> None:
    impossible = replace(cases[0], action=Action("place", cases[0].action.args))
    predictions = ask_contenders([impossible, cases[0]], {"lengths": Lengths()})
    assert [each.case for each in predictions] == [cases[0]]
    assert ask_contenders([impossible], {"lengths": Lengths()}) == []
