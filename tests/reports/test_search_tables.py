"""Tables of the allocation of effort."""

from ictamp_drake.reports.search_tables import effort, failures, interference, stages
from tests.runs.recorded import run, table

RUNS = table(
    run("a", 0, seconds=4.0),
    run("a", 1, seconds=8.0, low_level_steps=18, failures={"SLIPPED": 3, "NO_PATH": 9}, interference=("behind",)),
    run("b", 0, solved=False, low_level_steps=50, high_level_plans=8, failures={"NO_PATH": 50}),
    run("b", 1, level="hard", seconds=9.0, replay_time_s=3.0, interference=("behind", "tipped")),
)


def rows(lines: list[str]) -> list[list[str]]:
    """Cells of all rows below the headings."""
    return [[cell.strip() for cell in line.strip("|").split("|")] for line in lines[2:]]


def test_effort_is_of_all_runs_but_steps_a_skill_and_overhead_are_of_the_solved_ones() -> None:
    assert rows(effort(RUNS)) == [
        ["easy", "a", "1.00", "1", "12.0", "12 (50.0 %)", "0.46", "2.00", "-"],
        ["easy", "b", "8.00", "8", "50.0", "50 (100.0 %)", "0.07", "-", "-"],
        ["hard", "b", "1.00", "1", "6.0", "0", "1.42", "1.00", "3.00"],
    ]


def test_runs_without_steps_have_no_share_of_failures() -> None:
    nothing = run("a", low_level_steps=0, steps_by_depth=(), seconds_by_stage={}, solved=False)
    assert rows(effort(table(nothing))) == [["easy", "a", "1.00", "1", "0.0", "0", "-", "-", "-"]]


def test_stages_are_means_of_a_run_in_the_order_of_a_run() -> None:
    lines = stages(RUNS)
    assert lines[0] == "| level | strategy | setup | motion | physics |"
    assert rows(lines)[0] == ["easy", "a", "0.50", "1.50", "4.00"]


def test_failures_are_counted_by_strategy() -> None:
    lines = failures(RUNS)
    assert lines[0] == "| failed steps | a | b |"
    assert rows(lines) == [
        ["no collision-free path", "9 (37.5 %)", "50 (89.3 %)"],
        ["object slipped", "3 (12.5 %)", "0"],
        ["all", "12 (50.0 %)", "50 (89.3 %)"],
        ["steps", "24", "56"],
    ]


def test_a_cause_that_is_not_known_keeps_its_name() -> None:
    assert rows(failures(table(run("a", failures={"BORED": 3}))))[0] == ["BORED", "3 (50.0 %)"]


def test_a_problem_with_two_kinds_of_interference_counts_for_both() -> None:
    assert rows(interference(RUNS)) == [
        ["easy", "plain", "1 of 1, 4.0 s", "0 of 1"],
        ["easy", "behind", "1 of 1, 8.0 s", "-"],
        ["hard", "behind", "-", "1 of 1, 9.0 s"],
        ["hard", "tipped", "-", "1 of 1, 9.0 s"],
    ]


def test_a_level_that_names_no_interference_is_no_plain_one() -> None:
    assert interference(table(run("a", 0), run("b", 0, level="varied"))) == []
