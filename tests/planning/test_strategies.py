"""All selection rules in worlds where the best allocation of effort is known."""

from dataclasses import dataclass, replace
from statistics import mean
from typing import Any

import pytest

from ictamp_drake.core.types import Attempt
from ictamp_drake.planning.proportional import ProportionalConfig
from ictamp_drake.planning.round_robin import RoundRobinConfig
from ictamp_drake.planning.rule import RuleConfig
from ictamp_drake.planning.uniform import UniformAllocationConfig
from tests.toy_world import ADAPTIVE, ToyConfiguration, ToyWorld, toy_planner

CHAIN = ToyWorld(size=(6, 0), success=0.5)
"""One plan whose steps need only patience: it is best to repeat the last one, which takes 6 / 0.5 steps on average."""
BLOCKED = ToyWorld(size=(3, 3), walls=((2, 0), (1, 1), (0, 3)))
"""Three of twenty plans lead to the goal in 6 steps: it is best to leave the others after one attempt."""


@dataclass(frozen=True)
class Corridor(ToyWorld):
    """Only the step into cell 2 draws an offset; later steps keep it."""

    size: tuple[int, int] = (6, 0)
    max_plans: int | None = 1

    def attempt(self, c: ToyConfiguration, *how: Any, **named: Any) -> Attempt[ToyConfiguration]:
        attempt = super().attempt(c, *how, **named)
        after = attempt.successor
        return replace(attempt, successor=after._replace(offset=c.offset)) if after and after.cell[0] > 2 else attempt


def steps(world: ToyWorld, rule: RuleConfig, searches: int = 60) -> float:
    """Mean number of low-level steps to the goal."""
    results = [toy_planner(world, seed=seed, steps=3000, rule=rule).run() for seed in range(searches)]
    return mean(result.low_level_steps for result in results)


def test_where_patience_is_all_that_helps_effort_belongs_at_the_end_of_the_plan() -> None:
    best = CHAIN.size[0] / CHAIN.success
    adaptive, paper = steps(CHAIN, ADAPTIVE), steps(CHAIN, ProportionalConfig())
    round_robin, uniform = steps(CHAIN, RoundRobinConfig()), steps(CHAIN, UniformAllocationConfig())
    assert adaptive == pytest.approx(best, rel=0.15)
    assert 1.5 * adaptive < paper < round_robin < uniform


def test_where_most_plans_are_blocked_effort_belongs_to_new_plans() -> None:
    adaptive, paper = steps(BLOCKED, ADAPTIVE, 20), steps(BLOCKED, ProportionalConfig(), 20)
    assert 2 * adaptive < paper < steps(BLOCKED, RoundRobinConfig(), 20)


def test_a_door_that_needs_another_k_sends_the_search_back_a_step() -> None:
    """The door admits a share 0.3 of the drawn offsets, so a step and a try cost 1 / 0.3 of their own costs."""
    narrow = ToyWorld(size=(3, 0), doors={(3, 0): 0.3}, max_plans=1)
    assert steps(narrow, ADAPTIVE) < 2.5 * (1 + 2 / 0.3)


def test_a_step_that_decided_long_before_it_mattered_is_found() -> None:
    """Nothing after the step into cell 2 helps. The paper's rule spreads its effort, so it finds the way in the end."""
    corridor = Corridor(doors={(6, 0): 0.3})
    assert 1.3 * steps(corridor, ADAPTIVE) < steps(corridor, ProportionalConfig())
