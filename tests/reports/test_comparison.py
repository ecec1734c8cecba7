"""Paired comparisons claim no more than the runs show."""

import math
from dataclasses import replace
from itertools import pairwise, product

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy import stats

from ictamp_drake.reports.comparison import (
    ALL,
    LEAST,
    Comparison,
    adjust_for_multiplicity,
    compare_strategies,
    even_split,
)
from ictamp_drake.runs.records import Record
from tests.runs.recorded import run, table

outcomes = st.lists(st.tuples(st.booleans(), st.booleans()), min_size=1, max_size=40)
times = st.lists(st.tuples(st.floats(0.1, 100), st.floats(0.1, 100)), min_size=1, max_size=20)


def pairs(seconds: list[tuple[float, float]]) -> list[Record]:
    """Runs of the strategies a and b on one problem after the other."""
    return [run("ab"[which], number, pair[which]) for number, pair in enumerate(seconds) for which in (0, 1)]


def only(comparisons: list[Comparison]) -> Comparison:
    (comparison,) = comparisons
    return comparison


@given(outcomes)
def test_with_one_seed_the_test_is_mcnemars(pairs: list[tuple[bool, bool]]) -> None:
    records = [run("ab"[which], number, solved=pair[which]) for number, pair in enumerate(pairs) for which in (0, 1)]
    found = only(compare_strategies(table(*records), "a", "b"))
    won, lost = pairs.count((True, False)), pairs.count((False, True))
    assert found.only == (won, lost)
    assert found.solved == (sum(a for a, _ in pairs), sum(b for _, b in pairs))
    assert found.p == pytest.approx(stats.binomtest(won, won + lost).pvalue if won + lost else 1.0)


@given(st.lists(st.integers(-3, 3), min_size=1, max_size=8))
def test_with_several_seeds_the_signs_of_whole_problems_are_flipped(differences: list[int]) -> None:
    flips = np.array(np.meshgrid(*[[-1, 1]] * len(differences))).reshape(len(differences), -1)
    sums = np.abs(differences @ flips)
    assert even_split(differences) == pytest.approx(np.mean(sums >= abs(sum(differences))))


def test_seeds_of_one_problem_are_no_further_evidence() -> None:
    records = [run(name, seed=seed, solved=name == "a") for seed in range(10) for name in "ab"]
    found = only(compare_strategies(table(*records), "a", "b"))
    assert (found.only, found.both) == ((10, 0), 0)
    assert found.p == 1.0


@given(times)
def test_the_other_way_round_is_the_inverse(seconds: list[tuple[float, float]]) -> None:
    runs = table(*pairs(seconds))
    there, back = (only(compare_strategies(runs, *names)).time for names in ("ab", "ba"))
    assert there is not None
    assert back is not None
    np.testing.assert_allclose([there.value, there.low, there.high], 1 / np.array([back.value, back.high, back.low]))


@given(times)
def test_a_ratio_lies_in_its_interval_and_that_among_the_problems(seconds: list[tuple[float, float]]) -> None:
    found = only(compare_strategies(table(*pairs(seconds)), "a", "b")).time
    assert found is not None
    ratios = [a / b for a, b in seconds]
    assert min(ratios) <= found.value * (1 + 1e-9)
    if len(seconds) < LEAST:
        assert math.isnan(found.low)
        assert math.isnan(found.high)
    else:
        bounds = [min(ratios), found.low, found.value, found.high, max(ratios)]
        assert all(below <= above * (1 + 1e-9) for below, above in pairwise(bounds))


def test_the_interval_covers_the_median_as_often_as_it_says() -> None:
    rng = np.random.default_rng(0)
    covered = 0
    for _ in range(100):
        found = only(
            compare_strategies(table(*pairs([(value, 1.0) for value in rng.lognormal(size=25)])), "a", "b")
        ).time
        assert found is not None
        covered += found.low <= 1.0 <= found.high
    assert 0.9 <= covered / 100 <= 0.99


def test_more_seeds_do_not_narrow_the_interval() -> None:
    seconds = [(float(value), 1.0) for value in np.linspace(0.5, 2.0, 9)]
    often = [replace(each, seed=seed) for each, seed in product(pairs(seconds), range(5))]
    assert (
        only(compare_strategies(table(*pairs(seconds)), "a", "b")).time
        == only(compare_strategies(table(*often), "a", "b")).time
    )


def test_only_what_both_solved_has_a_ratio() -> None:
    records = [run("a", 0, 2.0), run("b", 0, 4.0), run("a", 1, 1.0), run("b", 1, 60.0, solved=False)]
    found = only(compare_strategies(table(*records), "a", "b"))
    assert found.both == 1
    assert found.time is not None
    assert found.time.value == pytest.approx(0.5)
    assert found.steps is not None
    assert found.steps.value == 1.0


def test_without_a_common_solved_problem_there_is_no_ratio() -> None:
    found = only(compare_strategies(table(run("a", 0), run("b", 0, solved=False)), "a", "b"))
    assert (found.both, found.time, found.steps) == (0, None, None)
    assert found.p == 1.0


@pytest.mark.parametrize(("unknown", "told"), [(0, True), (3, True), (4, False)])
def test_the_pace_is_told_where_it_is_known_of_most_runs(unknown: int, told: bool) -> None:
    records = [run("a", number, plan_duration_s=10.0, replay_time_s=1.0) for number in range(12)]
    records += [replace(record, strategy="b") for record in records]
    records[:unknown] = [replace(record, plan_duration_s=None) for record in records[:unknown]]
    found = only(compare_strategies(table(*records), "a", "b"))
    assert found.both == 12
    assert (found.pace is not None) == told


def test_the_pace_is_that_of_the_machine_whatever_the_plans_take() -> None:
    slow = run("a", 0, 9.0, replay_time_s=6.0, plan_duration_s=30.0)
    fast = run("b", 0, 3.0, replay_time_s=6.0, plan_duration_s=60.0)
    found = only(compare_strategies(table(slow, fast), "a", "b"))
    assert found.pace is not None
    assert found.pace.value == pytest.approx(2.0)
    assert found.time is not None
    assert found.time.value == pytest.approx(3.0 / 2.0)
    for other in (run("b", 0, 3.0), run("b", 0, 3.0, replay_time_s=0.1, plan_duration_s=0.0)):
        found = only(compare_strategies(table(slow, other), "a", "b"))
        assert found.pace is None
        assert found.time is not None
        assert found.time.value == pytest.approx(3.0)


def test_runs_without_steps_have_no_ratio_of_steps() -> None:
    records = [run(name, 0, low_level_steps=0, steps_by_depth=()) for name in "ab"]
    found = only(compare_strategies(table(*records), "a", "b"))
    assert found.time is not None
    assert found.steps is None


def test_levels_stand_alone_and_together() -> None:
    records = [run(name, level=level, solved=level == "easy") for name in "ab" for level in ("hard", "easy")]
    found = compare_strategies(table(*records), "a", "b")
    assert [each.level for each in found] == ["easy", "hard", ALL]
    assert [each.solved for each in found] == [(1, 1), (0, 0), (1, 1)]


def test_a_strategy_that_is_missing_on_a_level_has_no_pairs_there() -> None:
    records = [run("a"), run("b"), run("a", level="hard")]
    easy, hard, both = compare_strategies(table(*records), "b", "a")
    assert (easy.pairs, hard.pairs, both.pairs) == (1, 0, 1)
    assert (hard.solved, hard.p, hard.time) == ((0, 0), 1.0, None)


def test_problems_of_the_same_name_on_two_levels_are_two() -> None:
    records = [
        replace(run(name, level=level), problem="x", seed=len(level)) for name in "ab" for level in ("easy", "medium")
    ]
    assert compare_strategies(table(*records), "a", "b")[-1].both == 2


@given(st.lists(st.floats(0, 1), max_size=12))
def test_looking_at_many_tests_makes_each_less_surprising(p: list[float]) -> None:
    found = adjust_for_multiplicity(p)
    assert all(raw <= raised <= 1 for raw, raised in zip(p, found, strict=True))
    assert [found[number] for number in np.argsort(p)] == sorted(found)
    if p:
        assert min(found) == pytest.approx(min(1.0, len(p) * min(p)))
        assert max(found) >= max(p)


def test_holms_example() -> None:
    assert adjust_for_multiplicity([0.01, 0.04, 0.03, 0.005]) == pytest.approx([0.03, 0.06, 0.06, 0.02])
