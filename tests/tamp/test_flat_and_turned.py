"""Flat and small boxes, bars that are half covered, and boxes on their heads are planned with by default."""

from collections import Counter
from pathlib import Path

import pytest

from ictamp_drake.planning.events import Event, StepDone
from ictamp_drake.tamp.solve import solve
from ictamp_drake.tamp.task import load

CASES = Path(__file__).parents[1] / "scenes" / "cases"
SKILLS = {
    "04-thin-plate": 4,
    "19-upside-down-and-round-and-round": 6,
    "dice": 6,
    "f4-flat-plate": 2,
    "f5-upside-down": 2,
    "half-covered-bar": 2,
}
"""Fewest skills that solve each scene."""


@pytest.mark.parametrize("planner", ["completion-tree", "adaptive"])
@pytest.mark.parametrize("case", SKILLS)
def test_it_is_solved_with_few_executed_attempts(case: str, planner: str) -> None:
    executed: Counter[str] = Counter()

    def count(event: Event) -> None:
        if isinstance(event, StepDone) and event.attempt.motion:
            executed[str(event.attempt.action)] += 1

    solution = solve(load(CASES / f"{case}.yaml"), listeners=[count], planner=planner, time_limit=200, max_steps=60)
    assert solution.plan is not None
    assert len(solution.plan.attempts) >= SKILLS[case]
    assert max(executed.values()) <= 10
