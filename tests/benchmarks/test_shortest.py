"""The count of needless skills: when other strategies are asked, and what the report says."""

from pathlib import Path
from typing import Any

import pytest

import ictamp_drake as ict
from benchmarks import shortest
from benchmarks.small_scenes import SMALL

SCENE = SMALL / "evaluation" / "03.yaml"
TASK = ict.load(SCENE)


def answers(monkeypatch: pytest.MonkeyPatch, skills: dict[tuple[str, int], int]) -> list[tuple[str, int]]:
    """Let the strategies find plans with that many skills, none by default; returns the list of those asked."""
    asked: list[tuple[str, int]] = []

    def solve(_: Path, planner: str, __: float, seed: int = 0) -> tuple[Any, int | None, float]:
        asked.append((planner, seed))
        return TASK, skills.get((planner, seed)), 1.0

    monkeypatch.setattr(shortest, "solve", solve)
    return asked


def test_a_plan_as_short_as_the_shortest_high_level_plan_needs_no_other(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = answers(monkeypatch, {("adaptive", 0): 2})
    row = shortest.measure(SCENE, shortest.Options())
    assert (row["bound"], row["least"]) == (2, 2)
    assert asked == [("adaptive", 0)]


def test_other_strategies_are_asked_until_one_needs_the_least(monkeypatch: pytest.MonkeyPatch) -> None:
    asked = answers(monkeypatch, {("adaptive", 0): 6, ("els", 0): 4, ("stap", 3): 2, ("els", 4): 1})
    assert shortest.measure(SCENE, shortest.Options())["least"] == 2
    assert asked[-1] == ("stap", 3)
    assert ("els", 4) not in asked


def test_what_nothing_solves_has_no_least_number(monkeypatch: pytest.MonkeyPatch) -> None:
    answers(monkeypatch, {})
    row = shortest.measure(SCENE, shortest.Options(planners=("adaptive", "els")))
    assert row["least"] is None
    *_, line = shortest.report([row], ["adaptive"])
    assert "0 of 1 solved" in line
