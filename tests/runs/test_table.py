"""Table at the end of a run."""

import pytest
from rich.console import Console

from ictamp_drake.runs.records import Record
from ictamp_drake.runs.table import figures, format_results


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


def test_failures_of_other_versions_keep_their_names() -> None:
    counts = {"FROZEN": 3, "SLIPPED": 2}
    output = text(
        record("a", high_level_plans=1, low_level_steps=5, failures=counts),
        record("b", blocked={"pick(x, y)": counts}),
    )
    rows = [line.split() for line in output.splitlines()]
    assert ["FROZEN", "3"] in rows
    assert "3 FROZEN, 2 object slipped" in " ".join(output.split())


@pytest.mark.parametrize(
    "values",
    [
        {"blocked": {"pick(red_box, rack)": {"NO_INVERSE_KINEMATICS": 30}}},
        {"high_level_plans": 1, "low_level_steps": 9, "failures": {"SLIPPED": 2, "NO_PATH": 1}},
        {"verified": False},
    ],
    ids=["blocked", "nothing blocked", "not verified"],
)
def test_an_unsolved_problem_says_why(values: dict[str, object]) -> None:
    unsolved = record("hard-003", **values)
    output = " ".join(text(unsolved).split())
    assert f"hard-003: {unsolved.explanation.reason}" in output
    for line in unsolved.explanation.lines():
        assert line in output


def test_a_broken_problem_shows_its_error() -> None:
    output = text(record("a", stop_reason="CRASHED", error="Traceback:\nRuntimeError: [bold]odd[/bold]"))
    assert "a: CRASHED" in output
    assert "RuntimeError: [bold]odd[/bold]" in output
