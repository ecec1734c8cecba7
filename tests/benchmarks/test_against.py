"""The comparison of two trees: what it measures in which order, how it continues, and what it reports."""

import json
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest
from hypothesis import given
from hypothesis import strategies as st

from benchmarks.against import (
    AFTER,
    BEFORE,
    ROOT,
    TREES,
    Options,
    choose_problems,
    key,
    list_missing,
    pair_rows,
    part,
    ratios,
    read,
)
from benchmarks.scenes import SCENES

LEVEL = "easy"
PROBLEMS = [{"level": LEVEL, "problem": f"easy-{number:03d}", "number": number} for number in range(3)]

times = st.lists(st.floats(0.1, 100), min_size=1, max_size=12)


def row(tree: str, number: int, seconds: float, turn: int = 0, **values: Any) -> dict[str, Any]:
    """Measurement of a solved problem."""
    name = {"round": turn, "tree": tree, "level": LEVEL, "problem": f"easy-{number:03d}"}
    return name | {"solved": True, "cpu_s": seconds, "plan_duration_s": 10.0} | values


def pairs(before: list[float], after: list[float], **values: Any) -> list[dict[str, Any]]:
    """Rows of both trees on one problem after the other; values are those of the working tree."""
    rows = [row(BEFORE, number, seconds) for number, seconds in enumerate(before)]
    return rows + [row(AFTER, number, seconds, **values) for number, seconds in enumerate(after)]


def cells(rows: list[dict[str, Any]]) -> dict[str, str]:
    """The only row of the table, by headings."""
    headings, _, line = ([cell.strip() for cell in line.split("|")[1:-1]] for line in ratios(pair_rows(rows)))
    return dict(zip(headings, line, strict=True))


def test_trees_take_turns_and_the_other_one_begins_the_next_round() -> None:
    first, second = list_missing(PROBLEMS, 2, [])
    assert [turn["tree"] for turn in first] == [BEFORE, AFTER] * 3
    assert [turn["tree"] for turn in second] == [AFTER, BEFORE] * 3
    assert [turn["number"] for turn in first] == [0, 0, 1, 1, 2, 2]
    assert [turn["round"] for turn in (*first, *second)] == [0] * 6 + [1] * 6


@given(st.sets(st.integers(0, 11)), st.sets(st.integers(0, 11)))
def test_what_is_done_is_not_measured_again_but_what_broke_down_is(done: set[int], broken: set[int]) -> None:
    everything = [turn for turns in list_missing(PROBLEMS, 2, []) for turn in turns]
    rows = [everything[index] | ({"error": "it broke"} if index in broken else {}) for index in done]
    left = [turn for turns in list_missing(PROBLEMS, 2, rows) for turn in turns]
    assert left == [turn for index, turn in enumerate(everything) if index not in done - broken]


def test_of_rows_with_the_same_name_the_last_one_counts(tmp_path: Path) -> None:
    rows = [row(BEFORE, 0, 3.0, error="it broke"), row(AFTER, 0, 1.0), row(BEFORE, 0, 2.0)]
    path = tmp_path / "results.jsonl"
    path.write_text("".join(json.dumps(each) + "\n" for each in rows))
    assert {key(each): each["cpu_s"] for each in read(path)} == {key(rows[1]): 1.0, key(rows[2]): 2.0}
    assert read(tmp_path / "none.jsonl") == []


@given(times, st.floats(0.05, 20))
def test_a_constant_factor_is_found_whatever_the_problems_take(before: list[float], factor: float) -> None:
    found = part(pair_rows(pairs(before, [factor * seconds for seconds in before])), "cpu_s")
    exact = f"{factor:.3f}"
    assert found == (exact if len(before) < 6 else f"{exact} ({exact} to {exact})")


def test_the_interval_is_over_problems_and_rounds_are_no_further_evidence() -> None:
    once = pairs([1.0] * 7, [0.2, 0.3, 0.4, 0.5, 0.6, 0.7, 0.8])
    again = [each | {"round": turn} for turn in range(5) for each in once]
    found = cells(once)["CPU after / before (95 %)"]
    assert found.startswith("0.500 (0.")
    assert cells(again)["CPU after / before (95 %)"] == found


def test_rounds_of_a_problem_count_by_their_median() -> None:
    rows = [row(BEFORE, 0, 1.0, turn) for turn in range(3)]
    rows += [row(AFTER, 0, seconds, turn) for turn, seconds in enumerate((0.5, 0.4, 9.0))]
    assert part(pair_rows(rows), "cpu_s") == "0.500"


def test_the_first_geometric_plan_is_compared_with_the_verified_plan_of_the_commit() -> None:
    rows = pairs([4.0], [2.0], geometric_time_s=0.5, plan_duration_s=8.0)
    found = cells(rows)
    assert found["CPU after / before (95 %)"] == "0.500"
    assert found["first geometric plan / CPU before (95 %)"] == "0.125"
    assert found["plan duration (95 %)"] == "0.800"
    assert "first geometric plan / CPU before (95 %)" not in cells(pairs([4.0], [2.0]))


def test_what_one_tree_did_not_solve_has_no_ratio() -> None:
    lost = {"solved": False, "plan_duration_s": None}
    rows = [*pairs([4.0, 5.0], [2.0]), row(AFTER, 1, 60.0, **lost)]
    found = cells(rows)
    assert (found["solved before"], found["solved after"]) == ("2 of 2", "1 of 2")
    assert (found["CPU before [s]"], found["CPU after [s]"]) == ("4.00", "2.00")
    assert found["CPU after / before (95 %)"] == "0.500"


def test_problems_of_a_level_and_scenes_of_ones_own() -> None:
    levels = choose_problems(Options("HEAD", Path("out"), levels=("easy", "hard"), problems="1:3"))
    assert [each["problem"] for each in levels] == ["easy-001", "easy-002", "hard-001", "hard-002"]
    (own,) = choose_problems(Options("HEAD", Path("out"), scenes=(SCENES / "tower_2" / "05.yaml",)))
    assert (own["level"], own["problem"]) == ("tower_2", "05")


def test_options_of_both_trees_and_of_one() -> None:
    options = Options("HEAD", Path("out"), shared="--planner adaptive", options="--seed 1", options_before="--seed 2")
    assert options.by_tree == {BEFORE: "--planner adaptive --seed 2", AFTER: "--planner adaptive --seed 1"}


@pytest.mark.slow
def test_both_trees_are_measured_once_and_nothing_is_left_behind(tmp_path: Path) -> None:
    def git(*arguments: str) -> str:
        return subprocess.run(["git", "-C", str(ROOT), *arguments], capture_output=True, text=True, check=True).stdout

    try:
        before = {line.split()[0] for line in git("worktree", "list").splitlines()}
    except (OSError, subprocess.CalledProcessError):
        pytest.skip("this is no checkout")
    command = [sys.executable, str(ROOT / "benchmarks" / "against.py"), "--commit", "HEAD", "--rounds", "1"]
    command += ["--scenes", str(SCENES / "tower_2" / "05.yaml"), "--out", str(tmp_path / "out")]
    for _ in range(2):  # nothing is left to do the second time
        done = subprocess.run(command, capture_output=True, text=True, check=False)
        assert done.returncode == 0, done.stderr
        assert "| tower_2 | 1 | 1 of 1 | 1 of 1 |" in done.stdout
        rows = [json.loads(line) for line in (tmp_path / "out" / "results.jsonl").read_text().splitlines()]
        assert [each["tree"] for each in rows] == list(TREES)
        assert all(each["cpu_s"] > 0 for each in rows)
    assert (tmp_path / "out" / "table.md").read_text().strip() == done.stdout.strip()
    assert {line.split()[0] for line in git("worktree", "list").splitlines()} == before
