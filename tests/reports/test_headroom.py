"""The virtual best equals the best strategy of each problem, and every plan is executed."""

from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.reports.headroom import headroom, quickest_executions, virtual_best
from ictamp_drake.runs.records import Record
from tests.runs.recorded import run, table

outcomes = st.lists(st.tuples(st.booleans(), st.floats(0.1, 50)), min_size=3, max_size=30)


def runs_of_three(outcomes: list[tuple[bool, float]]) -> list[Record]:
    """Runs of the strategies a, b and c on one problem after the other."""
    return [
        run("abc"[number % 3], number // 3, seconds, solved=solved) for number, (solved, seconds) in enumerate(outcomes)
    ]


@given(outcomes)
def test_it_solves_what_any_strategy_solves_as_quickly_as_the_quickest(outcomes: list[tuple[bool, float]]) -> None:
    runs = table(*runs_of_three(outcomes))
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
    assert headroom(runs, virtual_best) == [
        "| strategy | easy |",
        "| --- | ---: |",
        "| a | 1.00 (1.00 to 1.00) |",
        "| b | 0.50 (0.50 to 0.50) |",
    ]


def test_no_name_of_a_strategy_is_taken() -> None:
    runs = table(*(run(name, 0, seconds) for name, seconds in (("bound", 2.0), ("b", 4.0))))
    assert headroom(runs, virtual_best)[2:] == ["| bound | 1.00 |", "| b | 0.50 |"]


def test_a_single_strategy_has_nothing_to_choose_from() -> None:
    assert headroom(table(run("a", 0), run("a", 1)), virtual_best) == []


def test_a_strategy_that_did_not_run_on_a_level_has_no_figure_there() -> None:
    runs = table(run("a", 0, 2.0), run("b", 0, 4.0), run("a", 0, 2.0, level="hard"))
    assert headroom(runs, virtual_best)[3] == "| b | 0.50 | - | 0.50 |"


def test_what_no_search_saves_is_to_execute_the_quickest_plan() -> None:
    runs = table(
        *(run("a", number, 8.0, replay_time_s=3.0, cpu_time_s=8.0) for number in range(7)),
        *(run("b", number, 10.0, replay_time_s=4.0, cpu_time_s=9.0) for number in range(7)),
    )
    assert list(quickest_executions(runs)["seconds"]) == [3.0] * 7


def test_earlier_versions_executed_each_plan_twice() -> None:
    runs = table(
        *(run("a", number, 8.0, replay_time_s=3.0) for number in range(7)),
        *(run("b", number, 10.0, replay_time_s=2.0) for number in range(7)),
    )
    assert list(quickest_executions(runs)["seconds"]) == [4.0] * 7
    assert headroom(runs, quickest_executions)[2:] == ["| a | 0.50 (0.50 to 0.50) |", "| b | 0.40 (0.40 to 0.40) |"]


def test_plans_that_were_not_found_or_not_timed_bound_nothing() -> None:
    runs = table(
        run("a", 0, 8.0), run("a", 1, solved=False), run("b", 0, 8.0, replay_time_s=3.0), run("b", 1, solved=False)
    )
    assert quickest_executions(runs)[["problem", "seconds"]].to_numpy().tolist() == [["easy-000", 6.0]]
    assert headroom(table(run("a", 0), run("b", 0)), quickest_executions)[2:] == ["| a | - |", "| b | - |"]
