"""Adaptive allocation: the choice of the next step, and when it opens another plan."""

import math
from dataclasses import dataclass, replace
from typing import NamedTuple

import numpy as np
import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Atom, Attempt, Parameter, Skeleton, State
from ictamp_drake.estimators.constant import Constant
from ictamp_drake.planning.adaptive import AdaptiveConfig
from ictamp_drake.planning.beliefs import BeliefsConfig
from ictamp_drake.planning.planner import Budget, PlannerConfig
from ictamp_drake.planning.result import PlanningResult
from ictamp_drake.planning.rule import RuleConfig
from ictamp_drake.planning.tree import Opening
from ictamp_drake.symbolic.atoms import ON
from ictamp_drake.symbolic.context import GeneratorContext
from ictamp_drake.symbolic.goal import Goal
from ictamp_drake.symbolic.skeletons import BreadthFirst
from tests.refusals import refusal
from tests.runs.programs import run_code
from tests.symbolic.towers import Problem, state
from tests.toy_world import ADAPTIVE, RIGHT, UP, TableEstimator, TickingClock, ToyWorld, toy_planner


def test_sure_steps_are_one_rollout() -> None:
    result = toy_planner(ToyWorld(size=(2, 2)), rule=ADAPTIVE).run()
    assert result.low_level_steps == 4
    assert result.high_level_plans == 1


def test_a_step_that_failed_once_is_repeated_before_an_earlier_one() -> None:
    failed = 0
    for seed in range(20):
        steps = toy_planner(ToyWorld(size=(4, 0), success=0.7), rule=ADAPTIVE, seed=seed).run().tree.steps
        first = next((number for number, step in enumerate(steps) if not step.attempt.succeeded), None)
        if first is not None:
            failed += 1
            assert steps[first + 1].node == steps[first].node
    assert failed > 10


def test_an_estimator_that_condemns_a_configuration_sends_the_search_back_at_once() -> None:
    """P of the second step is as low as its door is narrow, so no attempt at it is wasted where it cannot succeed."""

    class Seeing(TableEstimator):
        def estimate(self, options):  # type: ignore[no-untyped-def]
            seen = super().estimate(options)
            seen[[c.cell == (1, 0) and c.offset >= 0.3 for c, _ in options]] = 0.0
            return seen

    world = ToyWorld(size=(2, 0), doors={(2, 0): 0.3})
    trusting = replace(ADAPTIVE, beliefs=replace(ADAPTIVE.beliefs, floor=0.01))
    for seed in range(10):
        result = toy_planner(world, rule=trusting, estimator=Seeing({RIGHT: 1.0, UP: 1.0}), seed=seed).run()
        at_door = [step for step in result.tree.steps if result.tree.nodes[step.node].depth == 1]
        assert [step.attempt.succeeded for step in at_door] == [True]


def test_an_estimator_that_condemns_wherever_the_search_comes_is_not_trusted_for_ever() -> None:
    """Every step succeeds, but P of the second is 0; repeating the first would never lead to a better node."""
    world = ToyWorld(size=(2, 0))

    class Blind(TableEstimator):
        def estimate(self, options):  # type: ignore[no-untyped-def]
            seen = super().estimate(options)
            seen[[c.cell == (1, 0) for c, _ in options]] = 0.0
            return seen

    result = toy_planner(world, rule=ADAPTIVE, estimator=Blind({RIGHT: 0.9, UP: 0.9})).run()
    assert result.solved
    assert result.low_level_steps <= 1 / BeliefsConfig().floor


def test_a_plan_whose_later_actions_are_blocked_is_left() -> None:
    """The paper's rule looks only at the first action, and continues to run the half that succeeds."""
    world = ToyWorld(size=(2, 1), walls=((2, 0),))
    result = toy_planner(world, rule=ADAPTIVE, steps=40).run()
    assert result.solved
    assert result.failures.total() <= 6


def test_opening_stops_paying_when_new_plans_are_no_better_and_cost_effort() -> None:
    stuck = ToyWorld(size=(4, 4), walls=((1, 0), (0, 1)))
    cheap, dear = (toy_planner(replace(stuck, expansions=n), rule=ADAPTIVE, steps=60).run() for n in (1, 100_000))
    assert 1 <= dear.high_level_plans < cheap.high_level_plans


def test_the_search_does_not_depend_on_the_speed_of_the_machine() -> None:
    world = ToyWorld(size=(3, 3), success=0.6, walls=((2, 0), (1, 1)))
    fast, slow = (
        toy_planner(replace(world, seconds=seconds), rule=ADAPTIVE, clock=TickingClock(seconds), seconds=1e6).run()
        for seconds in (1e-3, 10.0)
    )
    assert slow.tree.to_dict() == fast.tree.to_dict()
    assert slow.low_level_steps > 10


def test_a_negative_cost_of_opening_is_refused() -> None:
    with refusal(Code.OUT_OF_RANGE, "planners.adaptive.opening", value=-0.1):
        AdaptiveConfig(opening=-0.1)


def test_nothing_is_opened_while_all_goes_well() -> None:
    result = toy_planner(ToyWorld(size=(3, 3)), rule=ADAPTIVE, clock=TickingClock(1e-3)).run()
    assert sum(isinstance(entry, Opening) for entry in result.tree.log) == 1


def test_a_narrow_door_is_passed_with_every_seed() -> None:
    world = ToyWorld(size=(2, 1), doors={(2, 1): 0.05}, max_plans=1)
    for seed in range(10):
        assert toy_planner(replace(world, success=0.9), rule=ADAPTIVE, seed=seed, steps=2000).run().solved


class Parked(NamedTuple):
    """c: the state, and the boxes that were moved."""

    s: State
    moved: frozenset[str] = frozenset()


@dataclass(frozen=True)
class ParkingLot:
    """Boxes on a table, each of which cannot be picked while the box in its way is at its initial place."""

    problem: Problem
    in_the_way: dict[str, str]

    @property
    def draws(self) -> int:
        return 1

    def attempt(
        self,
        c: Parked,
        plan: Skeleton,
        rng: np.random.Generator,  # noqa: ARG002
        k: Parameter | None = None,  # noqa: ARG002
    ) -> Attempt[Parked]:
        action, promised = plan.actions[0], plan.states[1]
        box = action.args[0]
        hindered = action.name == "pick" and {self.in_the_way.get(box, box)} - c.moved - {box}
        if hindered:
            return Attempt(action, Failure.GOAL_IN_COLLISION, obstacles=tuple(hindered))
        return Attempt(action, None, Parked(promised, c.moved | {box}), np.zeros(4))


LOT = ParkingLot(
    Problem(
        ("low", "tall", "wide", "far"),
        ("table",),
        state([("table", box) for box in ("low", "tall", "wide", "far")]),
        Goal.of({Atom(ON, ("low", "far"))}),
    ),
    {"low": "tall", "tall": "wide"},
)


TINY = ParkingLot(
    Problem(
        ("low", "tall"),
        ("table",),
        state([("table", box) for box in ("low", "tall")]),
        Goal.of({Atom(ON, ("low", "tall"))}),
    ),
    {"low": "tall"},
)


def search_parking_lot(
    patience: float = BeliefsConfig().patience, lot: ParkingLot = LOT, rule: RuleConfig | None = None, steps: int = 200
) -> PlanningResult[Parked]:
    """Run a search in the parking lot, by default with adaptive allocation of that patience."""
    rule = rule or replace(ADAPTIVE, beliefs=replace(ADAPTIVE.beliefs, patience=patience))
    return (
        PlannerConfig(Budget(60.0, steps), rule=rule)
        .create(
            c=Parked(lot.problem.initial),
            s=lot.problem.initial,
            generator=BreadthFirst().create(
                GeneratorContext(lot.problem.domain, lot.problem.initial, lot.problem.goal)
            ),
            skills=lot,
            estimator=Constant(1.0),
            verify=lambda _: True,
            rng=np.random.default_rng(0),
            clock=TickingClock(),
        )
        .run()
    )


@pytest.mark.parametrize(("patience", "solved"), [(BeliefsConfig().patience, True), (math.inf, False)])
def test_boxes_of_which_the_goal_does_not_speak_are_moved_out_of_the_way(patience: float, solved: bool) -> None:
    """Each was moved on the table, which changes no state, so only plans that were asked to do so move it."""
    result = search_parking_lot(patience)
    assert result.solved is solved
    if result.plan is not None:
        assert [a.action.args for a in result.plan if a.action.name == "pick"] == [
            ("wide", "table"),
            ("tall", "table"),
            ("low", "table"),
        ]
        assert result.low_level_steps <= 60


def test_boxes_are_moved_out_of_the_way_when_no_plain_plan_is_left() -> None:
    result = search_parking_lot(patience=20.0, lot=TINY)
    assert result.tree.exhausted
    assert result.solved


def test_where_a_box_cannot_be_moved_out_of_the_way_no_more_plans_are_asked_for() -> None:
    """Each box blocks the other, so no plan moves both first."""
    result = search_parking_lot(lot=replace(TINY, in_the_way={"low": "tall", "tall": "low"}))
    assert not result.solved
    assert len(result.tree.openings) <= 6


@pytest.mark.parametrize("hash_seed", [1, 2])
def test_the_search_does_not_depend_on_the_order_of_sets(hash_seed: int) -> None:
    code = "from tests.planning.test_adaptive import search_parking_lot; print(search_parking_lot().tree.to_dict())"
    assert run_code(code, hash_seed) == f"{search_parking_lot().tree.to_dict()}\n"
