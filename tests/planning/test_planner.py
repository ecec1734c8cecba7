"""The whole search in the toy world: problems that it solves, events that it reports, and when it stops."""

from dataclasses import dataclass, field, replace
from itertools import pairwise

import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from ictamp_drake.core.errors import Code
from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Attempt, State
from ictamp_drake.planning.adaptive import AdaptiveConfig
from ictamp_drake.planning.els import ElsConfig
from ictamp_drake.planning.events import Event, PlanOpened, StepDone, StepStarted, Verified
from ictamp_drake.planning.planner import Budget, PlannerConfig
from ictamp_drake.planning.proportional import ProportionalConfig
from ictamp_drake.planning.result import StopReason
from ictamp_drake.planning.round_robin import RoundRobinConfig
from ictamp_drake.planning.rule import RuleConfig
from ictamp_drake.planning.tree import ROOT
from ictamp_drake.planning.uniform import UniformAllocationConfig
from tests.refusals import refusal
from tests.toy_world import (
    RIGHT,
    UP,
    TickingClock,
    ToyConfiguration,
    ToyWorld,
    abstraction,
    assert_consistent,
    toy_planner,
)

SURE = ToyWorld(size=(2, 1), max_plans=1)
RULES: dict[str, RuleConfig] = {
    "paper": ProportionalConfig(),
    "straight": ProportionalConfig(redraw=False),
    "els": ElsConfig(),
    "els, p_w 3": ElsConfig(p_w=3.0),
    "els, weighted": ElsConfig(weighted=True),
    "round robin": RoundRobinConfig(),
    "uniform": UniformAllocationConfig(),
    "adaptive": AdaptiveConfig(),
}


# plans known | parameters k | dependence on the k before | hazard -> solved within 300 steps or not
CASES = {
    "one plan, sure steps": (SURE, True),
    "one plan, steps slip": (replace(SURE, success=0.2), True),
    "one plan, walled off": (replace(SURE, walls=((2, 0),)), False),
    "two plans, first walled off": (ToyWorld(size=(1, 1), walls=((1, 0),)), True),
    "all plans walled off": (ToyWorld(size=(1, 1), walls=((1, 0), (0, 1))), False),
    "one plan, any k, depends on the k before": (replace(SURE, doors={(2, 1): 0.1}), True),
    "one plan, two k, depends on the k before": (replace(SURE, doors={(2, 1): 0.1}, offsets=(0.05, 0.5)), True),
    "one plan, only a wrong k, depends on the k before": (replace(SURE, doors={(2, 1): 0.1}, offsets=(0.5,)), False),
    "one plan, depends twice": (replace(SURE, doors={(2, 0): 0.2, (2, 1): 0.2}, offsets=(0.1, 0.5, 0.9)), True),
    "start is at fault, one plan": (replace(SURE, doors={(1, 0): 0.4}), False),
    "start is at fault, second plan avoids it": (ToyWorld(size=(1, 1), doors={(1, 0): 0.4}), True),
    "many plans, one way through": (ToyWorld(size=(2, 2), walls=((2, 0), (1, 1)), success=0.7), True),
    "start is the goal": (ToyWorld(size=(0, 0)), True),
}


@pytest.mark.parametrize("rule", RULES.values(), ids=RULES)
@pytest.mark.parametrize(("world", "solved"), CASES.values(), ids=CASES)
def test_case(world: ToyWorld, solved: bool, rule: RuleConfig) -> None:
    for seed in range(5):
        result = toy_planner(world, steps=300, seed=seed, rule=rule).run()
        assert result.solved is solved
        assert result.stop_reason is (StopReason.SOLVED if solved else StopReason.OUT_OF_STEPS)
        assert_consistent(result.tree)


def test_sure_steps_are_one_rollout() -> None:
    result = toy_planner(SURE).run()
    assert result.actions == (RIGHT, RIGHT, UP)
    assert result.low_level_steps == 3
    assert result.verified is True


def test_the_plan_found_is_a_walk_from_start_to_goal() -> None:
    world = ToyWorld(size=(3, 2), success=0.5, doors={(3, 1): 0.3})
    result = toy_planner(world, steps=None).run()
    assert result.plan is not None
    cell = world.start.cell
    for attempt in result.plan:
        move = (1, 0) if attempt.action == RIGHT else (0, 1)
        cell = (cell[0] + move[0], cell[1] + move[1])
        assert attempt.successor is not None
        assert attempt.successor.cell == cell
    assert cell == world.size


def test_without_any_plan_the_goal_is_unreachable_at_once() -> None:
    result = toy_planner(ToyWorld(max_plans=0), steps=None).run()
    assert result.stop_reason is StopReason.UNREACHABLE
    assert not result.tree.log
    assert result.plan is None
    assert result.verified is None


def test_a_start_at_the_goal_needs_no_step_but_is_verified() -> None:
    events: list[Event] = []
    result = toy_planner(ToyWorld(size=(0, 0)), listeners=[events.append]).run()
    assert [event.path for event in events if isinstance(event, Verified)] == [()]
    assert result.plan == ()
    assert result.low_level_steps == 0


def test_a_start_at_the_goal_that_is_not_verified_leaves_nothing_to_do() -> None:
    result = toy_planner(ToyWorld(size=(0, 0)), verify=lambda _: False, steps=None).run()
    assert result.stop_reason is StopReason.UNREACHABLE
    assert result.verified is False


def test_a_refused_plan_is_told_and_the_search_goes_on() -> None:
    events: list[Event] = []
    answers = iter([False, False, True])
    result = toy_planner(SURE, verify=lambda _: next(answers), listeners=[events.append]).run()
    assert [event.verified for event in events if isinstance(event, Verified)] == [False, False, True]
    assert list(result.tree.candidates.values()) == [False, False, True]
    assert result.candidate == result.tree.solution == list(result.tree.candidates)[-1]
    assert result.solved


def test_when_no_plan_is_verified_the_last_one_is_kept_but_nothing_counts_as_solved() -> None:
    result = toy_planner(SURE, steps=20, verify=lambda _: False).run()
    assert result.actions == (RIGHT, RIGHT, UP)
    assert result.verified is False
    assert not result.solved


@pytest.mark.parametrize("max_expansions", [1, 7, 1000])
def test_a_call_for_a_plan_is_limited(max_expansions: int) -> None:
    result = toy_planner(replace(SURE, expansions=10), max_expansions=max_expansions).run()
    openings = result.tree.openings
    assert [opening.expanded for opening in openings] == {1: [1] * 10, 7: [7, 3], 1000: [10]}[max_expansions]
    assert [opening.plan for opening in openings] == [None] * (len(openings) - 1) + [0]


def test_events_tell_all_that_the_tree_holds_in_its_order() -> None:
    events: list[Event] = []
    tree = toy_planner(ToyWorld(size=(2, 2), success=0.6), listeners=[events.append]).run().tree
    told = [event for event in events if isinstance(event, PlanOpened | StepDone)]
    assert len(told) == len(tree.log)
    assert [event.attempt for event in events if isinstance(event, StepDone)] == [step.attempt for step in tree.steps]
    assert [event.child for event in events if isinstance(event, StepDone) and event.child] == tree.nodes[1:]
    for before, after in pairwise(events):
        if isinstance(before, StepStarted):
            assert isinstance(after, StepDone)
            assert (before.node, before.action) == (after.node, after.attempt.action)


@pytest.mark.parametrize("steps", [0, 1, 17])
def test_no_more_steps_than_the_budget(steps: int) -> None:
    result = toy_planner(replace(SURE, walls=((2, 1),)), steps=steps).run()
    assert result.stop_reason is StopReason.OUT_OF_STEPS
    assert result.low_level_steps == steps


@given(seconds=st.floats(0, 50), tick=st.floats(0.01, 1))
@settings(max_examples=30, deadline=None)
def test_nothing_starts_after_the_deadline(seconds: float, tick: float) -> None:
    clock = TickingClock(tick)
    started: list[float] = []
    planner = toy_planner(
        replace(SURE, walls=((2, 1),)),
        steps=None,
        seconds=seconds,
        clock=clock,
        listeners=[lambda event: started.append(clock.now) if isinstance(event, StepStarted) else None],
    )
    result = planner.run()
    assert result.stop_reason is StopReason.OUT_OF_TIME
    assert all(time < tick + seconds + 3 * tick for time in started)
    assert result.planning_time_s >= seconds


def test_processor_time_has_a_limit_of_its_own_whatever_the_clock_on_the_wall() -> None:
    world = replace(SURE, walls=((2, 1),))
    slow, fast = (
        toy_planner(world, steps=None, cpu_seconds=5.0, clock=TickingClock(tick), cpu_clock=TickingClock(0.1)).run()
        for tick in (0.01, 0.001)
    )
    assert slow.stop_reason is fast.stop_reason is StopReason.OUT_OF_CPU_TIME
    assert slow.low_level_steps == fast.low_level_steps > 0


def test_stop_ends_the_search_between_two_steps() -> None:
    events: list[Event] = []
    result = toy_planner(
        replace(SURE, walls=((2, 1),)), listeners=[events.append], stop=lambda: len(events) >= 7, steps=None
    ).run()
    assert result.stop_reason is StopReason.STOPPED
    assert len(events) == 7


@dataclass(frozen=True)
class Interrupted(ToyWorld):
    """A world in which somebody presses Ctrl-C during a certain step."""

    at: int = 4
    seen: list[int] = field(default_factory=list)

    def attempt(self, *args, **kwargs) -> Attempt[ToyConfiguration]:  # type: ignore[no-untyped-def]
        self.seen.append(len(self.seen))
        if len(self.seen) == self.at:
            raise KeyboardInterrupt
        return super().attempt(*args, **kwargs)


def test_ctrl_c_in_the_middle_of_a_step_leaves_what_was_found_before() -> None:
    result = toy_planner(Interrupted(size=(2, 1), max_plans=1, at=4), verify=lambda _: False).run()
    assert result.stop_reason is StopReason.STOPPED
    assert result.low_level_steps == 3
    assert result.actions == (RIGHT, RIGHT, UP)
    assert_consistent(result.tree)


def test_ctrl_c_during_the_verification_leaves_the_plan_unverified() -> None:
    def interrupt(_: object) -> bool:
        raise KeyboardInterrupt

    result = toy_planner(SURE, verify=interrupt).run()
    assert result.stop_reason is StopReason.STOPPED
    assert result.actions == (RIGHT, RIGHT, UP)
    assert result.verified is None
    assert not result.solved


@given(
    size=st.tuples(st.integers(0, 3), st.integers(0, 3)),
    success=st.floats(0, 1),
    door=st.floats(0, 1),
    rule=st.one_of(
        st.builds(ProportionalConfig, W=st.floats(0, 100), redraw=st.booleans()), st.sampled_from(list(RULES.values()))
    ),
    seed=st.integers(0, 1000),
)
@settings(max_examples=100, deadline=None)
def test_every_tree_is_consistent(
    *, size: tuple[int, int], success: float, door: float, rule: RuleConfig, seed: int
) -> None:
    world = ToyWorld(size=size, success=success, doors={(1, 1): door})
    result = toy_planner(world, seed=seed, steps=60, rule=rule).run()
    assert_consistent(result.tree)
    assert result.solved == (result.stop_reason is StopReason.SOLVED)


def test_a_heavier_W_opens_more_plans() -> None:
    world = ToyWorld(size=(3, 3), walls=((3, 3),))
    opened = [
        toy_planner(world, rule=ProportionalConfig(W=W), steps=100).run().high_level_plans for W in (0.0, 1.0, 100.0)
    ]
    assert opened[0] == 1 < opened[1] < opened[2]


def test_the_root_keeps_being_tried() -> None:
    """Node 2 in the paper's Figure 1: a solved step is repeated to find another configuration."""
    result = toy_planner(replace(SURE, doors={(2, 1): 0.05}), steps=None).run()
    assert sum(step.node == ROOT and step.child is not None for step in result.tree.steps) > 1


@pytest.mark.parametrize(
    ("bad", "field", "value"),
    [
        (lambda: Budget(seconds=-1.0), "budget.seconds", -1.0),
        (lambda: Budget(steps=-2), "budget.steps", -2),
        (lambda: PlannerConfig(max_expansions=0), "max-expansions", 0),
    ],
)
def test_a_wrong_constant_is_refused(bad, field: str, value: float) -> None:  # type: ignore[no-untyped-def]
    with refusal(Code.OUT_OF_RANGE, field, value=value):
        bad()


# plans that run in physics as a whole


@dataclass
class ToyPhysics:
    """Physics that confirms promises with a slight offset, except in bogs, and records its calls."""

    bogs: tuple[tuple[int, int], ...] = ()
    asked: list[tuple[ToyConfiguration, Attempt[ToyConfiguration]]] = field(default_factory=list)

    def __call__(
        self, c: ToyConfiguration, attempt: Attempt[ToyConfiguration], promised: State
    ) -> Attempt[ToyConfiguration]:
        self.asked.append((c, attempt))
        assert attempt.successor is not None
        assert abstraction(attempt.successor) == promised
        if attempt.successor.cell in self.bogs:
            return replace(attempt, failure=Failure.SLIPPED, successor=c)
        return replace(attempt, successor=attempt.successor._replace(offset=attempt.successor.offset / 2))


@pytest.mark.parametrize("rule", RULES.values(), ids=RULES)
def test_a_found_plan_runs_in_physics_step_by_step_from_where_physics_ended(rule: RuleConfig) -> None:
    physics = ToyPhysics()
    result = toy_planner(SURE, rule=rule, execute=physics).run()
    assert result.solved
    assert [attempt.action for _, attempt in physics.asked] == [RIGHT, RIGHT, UP]
    assert result.plan is not None
    reached = [attempt.successor for attempt in result.plan]
    assert [c for c, _ in physics.asked] == [SURE.start, *reached[:-1]]
    assert result.candidate is not None
    assert [result.tree.nodes[node].c for node in result.tree.lineage(result.candidate)] == [SURE.start, *reached]
    assert not any(step.attempt.failure for step in result.tree.steps), "what physics confirms is no step of its own"
    assert result.geometric_time_s is not None
    assert_consistent(result.tree)


@pytest.mark.parametrize("rule", RULES.values(), ids=RULES)
def test_a_step_that_physics_refuses_is_blamed_and_the_search_goes_on_elsewhere(rule: RuleConfig) -> None:
    for seed in range(3):
        physics = ToyPhysics(bogs=((1, 0),))
        events: list[Event] = []
        world = ToyWorld(size=(1, 1))
        result = toy_planner(world, seed=seed, rule=rule, execute=physics, listeners=[events.append]).run()
        assert result.solved
        assert result.actions == (UP, RIGHT), "the way around the bog"
        assert_consistent(result.tree)
        refused = [step for step in result.tree.steps if step.attempt.failure is Failure.SLIPPED]
        assert bool(result.tree.refuted) == bool(refused)
        assert len(refused) == sum(c.cell == (0, 0) and a.action == RIGHT for c, a in physics.asked)
        told = [event.attempt for event in events if isinstance(event, StepDone) and event.attempt.failure]
        assert told == [step.attempt for step in refused]


def test_what_physics_confirmed_is_not_run_again() -> None:
    """The second step is refused at first; the first one was confirmed, and the next plan continues from there."""
    answers = iter([False, True])

    @dataclass
    class Slippery(ToyPhysics):
        def __call__(
            self, c: ToyConfiguration, attempt: Attempt[ToyConfiguration], promised: State
        ) -> Attempt[ToyConfiguration]:
            done = super().__call__(c, attempt, promised)
            slips = c.cell == (1, 0) and not next(answers)
            return replace(done, failure=Failure.SLIPPED, successor=c) if slips else done

    physics = Slippery()
    result = toy_planner(SURE, rule=RULES["els"], execute=physics).run()
    assert result.solved
    assert len({attempt.k.tobytes() for c, attempt in physics.asked if attempt.k is not None}) == len(physics.asked)


def test_a_goal_that_physics_never_confirms_is_not_solved() -> None:
    result = toy_planner(SURE, steps=60, execute=ToyPhysics(bogs=((2, 1),))).run()
    assert not result.solved
    assert result.stop_reason is StopReason.OUT_OF_STEPS
    assert not result.tree.candidates
    assert_consistent(result.tree)


def test_without_whole_plans_there_is_no_geometric_time() -> None:
    assert toy_planner(SURE).run().geometric_time_s is None
