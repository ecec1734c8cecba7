"""Counts of attempts by case."""

from pathlib import Path

import numpy as np
import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.learning.cases import count_outcomes, halves, read_cases
from ictamp_drake.learning.dataset import scene
from ictamp_drake.scenes.training import training_scene
from tests.learning.counted import case, folder_of, picks
from tests.refusals import refusal

YES, NO = True, False


def test_attempts_at_one_action_from_one_c_are_a_case(tmp_path: Path) -> None:
    first, second = [YES, NO, YES], [NO, NO, YES, NO]
    folder = folder_of(tmp_path, picks(3, first, "box_0"), picks(3, second, "box_1"), picks(4, second), picks(5, [YES]))
    cases = read_cases(folder, "pick", least=3)
    assert [(each.scene, each.outcomes.tolist()) for each in cases] == [(3, first), (3, second[:3]), (4, second[:3])]
    assert cases[0].action.args[0] == "box_0"
    assert scene(cases[2].spec) == training_scene(4)
    assert set(cases[2].c.poses) == set(training_scene(4).boxes)


def test_only_attempts_of_the_sampler_count(tmp_path: Path) -> None:
    best = [picks(number, [NO] * 5, sampler="best") for number in (3, 4)]
    folder = folder_of(tmp_path, picks(3, [YES, NO]), picks(4, [NO, NO]), *best)
    assert [len(each) for each in read_cases(folder, "pick", least=7)] == [7, 7]
    assert [each.outcomes.tolist() for each in read_cases(folder, "pick", 2, "policy")] == [[YES, NO], [NO, NO]]


def test_the_halves_are_all_executions_and_each_is_tested_on_the_other() -> None:
    cases = [case(0, [YES, NO, YES, NO, YES]), case(1, [NO, YES])]
    whole, (known, tested) = count_outcomes(cases), halves(cases)
    np.testing.assert_array_equal(whole.share, [0.6, 0.5])
    np.testing.assert_array_equal(known.attempts, [3, 1, 2, 1])
    np.testing.assert_array_equal(known.successes, [3, 0, 0, 1])
    np.testing.assert_array_equal(known.scene, [0, 1, 0, 1])
    for half, other in (known, tested), (tested, known):
        np.testing.assert_array_equal(half.attempts[:2] + other.attempts[:2], whole.attempts)
        np.testing.assert_array_equal(half.successes[:2] + other.successes[:2], whole.successes)


@pytest.mark.parametrize(
    ("outcomes", "least", "found"),
    [
        (([YES, NO], [YES]), 3, 2),  # attempts from the same c
        (([YES, YES], [YES]), 1, 2),  # successes
        (([NO, NO], [NO]), 1, 0),
        (([YES, NO], [YES]), 2, 1),  # scenes
    ],
)
def test_what_cannot_be_judged_is_refused(
    tmp_path: Path, outcomes: tuple[list[bool], list[bool]], least: int, found: int
) -> None:
    folder = folder_of(tmp_path, *(picks(number, each) for number, each in zip((3, 4), outcomes, strict=True)))
    with refusal(Code.TOO_FEW_DATA, file=folder, value=found):
        read_cases(folder, "pick", least)


def test_a_folder_without_attempts_is_refused(tmp_path: Path) -> None:
    with refusal(Code.NOT_FOUND):
        read_cases(tmp_path / "nowhere", "pick", 2)
