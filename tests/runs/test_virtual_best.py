"""The virtual best is as good as the best strategy of each problem, and no better."""

from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.runs.records import Record
from ictamp_drake.runs.virtual_best import headroom, virtual_best
from tests.runs.recorded import run, table

outcomes = st.lists(st.tuples(st.booleans(), st.floats(0.1, 50)), min_size=3, max_size=30)


def of_three(outcomes: list[tuple[bool, float]]) -> list[Record]:
    """Runs of the strategies a, b and c on one problem after the other."""
    return [
        run("abc"[number % 3], number // 3, seconds, solved=solved) for number, (solved, seconds) in enumerate(outcomes)
    ]


@given(outcomes)
def test_it_solves_what_any_strategy_solves_as_quickly_as_the_quickest(outcomes: list[tuple[bool, float]]) -> None:
    runs = table(*of_three(outcomes))
    best = virtual_best(runs)
    assert set(best["problem"]) == set(runs["problem"])
    assert best["problem"].is_unique
    for row in best.itertuples():
        solved = runs[(runs["problem"] == row.problem) & runs["solved"]]
        assert row.solved == bool(len(solved))
        assert not row.solved or row.seconds == solved["seconds"].min()


def test_each_seed_has_a_best_of_its_own() -> None:
    runs = table(run("a", 0, 2.0), run("b", 0, 3.0), run("a", 0, 5.0, seed=1), run("b", 0, 4.0, seed=1))
    assert list(virtual_best(runs)["seconds"]) == [2.0, 4.0]


def test_what_is_left_to_gain() -> None:
    runs = table(*(run(name, number, seconds) for number in range(7) for name, seconds in (("a", 2.0), ("b", 4.0))))
    assert headroom(runs) == [
        "| strategy | easy |",
        "| --- | ---: |",
        "| a | 1.00 (1.00 to 1.00) |",
        "| b | 0.50 (0.50 to 0.50) |",
    ]


def test_a_single_strategy_has_nothing_to_choose_from() -> None:
    assert headroom(table(run("a", 0), run("a", 1))) == []


def test_a_strategy_that_did_not_run_on_a_level_has_no_figure_there() -> None:
    runs = table(run("a", 0, 2.0), run("b", 0, 4.0), run("a", 0, 2.0, level="hard"))
    assert headroom(runs)[3] == "| b | 0.50 | - | 0.50 |"
