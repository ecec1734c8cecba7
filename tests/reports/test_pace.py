"""Times at equal pace: the delay of a slower machine is removed per level, and nothing else changes."""

import pytest

from ictamp_drake.reports.pace import scale_to_equal_pace
from ictamp_drake.runs.records import Record
from tests.runs.recorded import LIMIT, run, table


def measured_runs(strategy: str, seconds: float, pace: float, **values: object) -> list[Record]:
    """Runs of three problems with the given computing time per second of the plan, and one run without a plan."""
    values |= {"plan_duration_s": 10.0, "replay_time_s": 10.0 * pace}
    solved = [run(strategy, number, seconds, **values) for number in range(3)]
    return [*solved, run(strategy, 3, LIMIT, solved=False, level=values.get("level", "easy"))]


def test_times_of_a_slower_machine_are_scaled_level_by_level() -> None:
    runs = table(
        *measured_runs("a", 6.0, pace=0.2),
        *measured_runs("a", 6.0, pace=0.1, level="hard"),
        *measured_runs("b", 5.0, pace=0.1),
        *measured_runs("b", 5.0, pace=0.1, level="hard"),
    )
    scaled = scale_to_equal_pace(runs, "b")
    solved = scaled[scaled["solved"]].groupby(["strategy", "level"], observed=True)
    assert solved["seconds"].mean().tolist() == pytest.approx([3.0, 6.0, 5.0, 5.0])
    assert solved["counted"].mean().tolist() == pytest.approx([3.0, 6.0, 5.0, 5.0])
    assert solved["replay"].mean().tolist() == pytest.approx([1.0] * 4)
    assert sum(scaled["stages"][0].values()) == pytest.approx(sum(runs["stages"][0].values()) / 2)
    assert scaled[~scaled["solved"]]["counted"].tolist() == [LIMIT] * 4
    assert scaled["steps"].equals(runs["steps"])


def test_where_the_pace_is_not_known_times_stay_as_measured() -> None:
    runs = table(*(run(name, number) for name in "ab" for number in range(4)))
    assert scale_to_equal_pace(runs, "b")[["seconds", "counted", "stages"]].equals(
        runs[["seconds", "counted", "stages"]]
    )
