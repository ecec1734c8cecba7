"""Table at the end of a run."""

import pytest
from rich.console import Console

from ictamp_drake.runs.records import Record
from ictamp_drake.runs.table import blocker, figures, format_results


def record(problem: str, **values: object) -> Record:
    defaults = {"level": "easy", "seed": 0, "stop_reason": "OUT_OF_TIME", "planning_time_s": 60.0}
    return Record(**{**defaults, **values}, problem=problem)  # type: ignore[arg-type]


def solved_record(problem: str, seconds: float, steps: int, **values: object) -> Record:
    figures = {"planning_time_s": seconds, "low_level_steps": steps, "replay_time_s": 2.0, "plan_length": 6}
    return record(problem, solved=True, verified=True, stop_reason="SOLVED", high_level_plans=1, **figures, **values)


def text(*records: Record) -> str:
    console = Console(width=120, record=True, quiet=True)
    with console.capture() as capture:
        console.quiet = False
        console.print(format_results(records))
    return capture.get()


@pytest.mark.parametrize(
    ("action", "refusals", "line"),
    [
        (
            "pick(red_box, rack)",
            {"NO_INVERSE_KINEMATICS": 30},
            "pick(red_box, rack): 30 of 30 grasps: no inverse-kinematics solution",
        ),
        (
            "place(red_box, rack)",
            {"NO_PATH": 7, "TOPPLED": 5},
            "place(red_box, rack): 12 of 12 placements: 7 no collision-free path, 5 object toppled",
        ),
        ("push(red_box, rack)", {"SLIPPED": 1}, "push(red_box, rack): 1 of 1 parameters k: object slipped"),
    ],
)
def test_a_blocked_action_says_what_refused_it(action: str, refusals: dict[str, int], line: str) -> None:
    assert blocker(action, refusals, {}) == line


def test_a_blocked_action_names_what_was_most_often_in_its_way() -> None:
    line = blocker("pick(low, table)", {"GOAL_IN_COLLISION": 9}, {"far": 1, "tall": 5, "rack": 2, "table": 1})
    assert (
        line
        == "pick(low, table): 9 of 9 grasps: grasp or placement in collision; in the way: tall (5), rack (2), far (1)"
    )


def test_figures_are_of_the_solved_problems() -> None:
    records = [
        solved_record("a", 4.0, 6),
        solved_record("b", 6.0, 12),
        solved_record("c", 20.0, 9),
        record("d", low_level_steps=500),
    ]
    assert figures(records) == ["3 of 4", "6", "10", "1", "9", "1.5", "3"]


def test_without_a_solved_problem_there_are_no_figures() -> None:
    assert figures([record("a")]) == ["0 of 1", *["-"] * 6]


def test_problems_are_told_apart_by_interference() -> None:
    output = text(
        solved_record("a", 4.0, 6),
        solved_record("b", 6.0, 12, interference=("behind", "tipped")),
        record("c", interference=("behind",)),
    )
    rows = {line.split("  ")[0].strip(): line for line in output.splitlines()}
    assert "1 of 1" in rows["plain"]
    assert "1 of 2" in rows["with behind"]
    assert "1 of 1" in rows["with tipped"]
    assert "2 of 3" in rows["all"]


def test_failures_are_counted_over_all_problems() -> None:
    output = text(
        solved_record("a", 4.0, 6, failures={"SLIPPED": 1}),
        record("b", low_level_steps=10, failures={"SLIPPED": 2, "NO_PATH": 1}, blocked={"pick(x, y)": {"NO_PATH": 1}}),
    )
    assert "failures in 16 low-level steps" in output
    assert next(line.split() for line in output.splitlines() if "slipped" in line)[-1] == "3"


def test_an_unsolved_problem_says_why() -> None:
    output = text(record("hard-003", blocked={"pick(red_box, rack)": {"NO_INVERSE_KINEMATICS": 30}}))
    assert "hard-003: the time limit was reached" in output
    assert "  pick(red_box, rack): 30 of 30 grasps: no inverse-kinematics solution" in output


def test_an_unsolved_problem_without_a_blocked_action_says_what_failed() -> None:
    output = text(record("a", high_level_plans=1, low_level_steps=9, failures={"SLIPPED": 2, "NO_PATH": 1}))
    assert "of 9 steps 3 failed: 2 object slipped, 1 no collision-free path" in " ".join(output.split())


def test_a_problem_without_a_plan_says_so() -> None:
    assert "no high-level plan was found" in text(record("a"))


def test_a_search_that_went_into_plans_says_so() -> None:
    slow = record("a", planning_time_s=42.8, seconds_by_stage={"plan_generator": 26.2}, high_level_plans=1)
    assert "26 of 43 s went to finding high-level plans; --generator best-first" in text(slow)
    assert "best-first" not in text(record("a", planning_time_s=42.8, seconds_by_stage={"plan_generator": 1.0}))


def test_a_plan_that_did_not_pass_its_replay_is_mentioned() -> None:
    assert "failed when it was executed once more" in text(record("a", verified=False))


def test_a_broken_problem_shows_its_error() -> None:
    output = text(record("a", stop_reason="CRASHED", error="Traceback:\nRuntimeError: [bold]odd[/bold]"))
    assert "a: CRASHED" in output
    assert "RuntimeError: [bold]odd[/bold]" in output
