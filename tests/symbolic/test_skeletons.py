"""Streams of plans are complete, ordered, resumable, and the same in every process."""

import hashlib
import math
from collections.abc import Iterator
from dataclasses import replace
from itertools import islice, takewhile

import pytest
from hypothesis import assume, given, settings
from hypothesis import strategies as st

from ictamp_drake.core.errors import Code
from ictamp_drake.core.protocols import PlanGenerator
from ictamp_drake.core.types import Action, Atom, Obstruction, Skeleton, State
from ictamp_drake.symbolic.atoms import ON, objects_beneath, supporters
from ictamp_drake.symbolic.context import GeneratorContext
from ictamp_drake.symbolic.goal import Goal
from ictamp_drake.symbolic.skeletons import BestFirst, BreadthFirst
from tests.refusals import refusal
from tests.runs.programs import run_code
from tests.symbolic.towers import LEVELS, Problem, draw_obstructions, problems, state, tower_atoms, tower_goal

Config = BreadthFirst | BestFirst
CONFIGS = {
    "breadth_first": BreadthFirst(),
    "impatient": BreadthFirst(patience=5),
    "best_first": BestFirst(),
    "a_star": BestFirst(weight=1),
}
IN_ORDER = {name: config for name, config in CONFIGS.items() if name != "best_first"}
each_config = pytest.mark.parametrize("config", CONFIGS.values(), ids=CONFIGS)


def create(config: Config, problem: Problem) -> PlanGenerator:
    return config.create(GeneratorContext(problem.domain, problem.initial, problem.goal))


def stream(generator: PlanGenerator, max_expansions: int = 1000) -> Iterator[Skeleton]:
    while not generator.exhausted:
        plan = generator.next_plan(max_expansions)
        if plan is not None:
            yield plan


def all_plans(problem: Problem, longest: float) -> Iterator[tuple[Action, ...]]:
    """All plans without a repeated state, by depth-first search."""

    def extend(visited: tuple[State, ...], actions: tuple[Action, ...]) -> Iterator[tuple[Action, ...]]:
        if problem.goal.holds(visited[-1]):
            yield actions
        elif len(actions) < longest:
            for action, after in problem.domain.successors(visited[-1]):
                if after not in visited:
                    yield from extend((*visited, after), (*actions, action))

    return extend((problem.initial,), ())


@pytest.mark.parametrize(
    ("name", "length", "shortest", "expanded"),
    [("easy", 6, 4, 144), ("medium", 10, 11, 402), ("hard", 14, 22, 489)],
)
def test_breadth_first_finds_all_shortest_plans_of_the_levels(
    name: str, length: int, shortest: int, expanded: int
) -> None:
    generator = create(BreadthFirst(), LEVELS[name])
    plan = generator.next_plan(1000)
    assert plan is not None
    assert len(plan) == length
    assert generator.expanded == expanded
    assert 1 + sum(1 for _ in takewhile(lambda plan: len(plan) == length, stream(generator))) == shortest


@pytest.mark.parametrize("problem", LEVELS.values(), ids=LEVELS)
def test_best_first_walks_straight_to_a_shortest_plan_of_the_levels(problem: Problem) -> None:
    generator = create(BestFirst(), problem)
    plan = generator.next_plan(1000)
    assert plan is not None
    assert len(plan) == len(next(stream(create(BreadthFirst(), problem))))
    assert generator.expanded == len(plan) + 1


@each_config
@given(problem=problems(boxes=3))
def test_plans_lead_to_the_goal_and_repeat_no_state(config: Config, problem: Problem) -> None:
    plans = list(islice(stream(create(config, problem)), 30))
    assert len({plan.actions for plan in plans}) == len(plans)
    for plan in plans:
        assert plan.states[0] == problem.initial
        for before, action, after in zip(plan.states, plan.actions, plan.states[1:], strict=False):
            assert problem.domain.successor(before, action) == after
        assert len(set(plan.states)) == len(plan.states)
        assert [problem.goal.holds(s) for s in plan.states] == [False] * len(plan) + [True]


@pytest.mark.parametrize("config", IN_ORDER.values(), ids=IN_ORDER)
@settings(max_examples=30)
@given(problem=problems(boxes=3))
def test_all_plans_up_to_eight_actions_come_in_order_of_length(config: Config, problem: Problem) -> None:
    plans = [
        plan.actions for plan in takewhile(lambda plan: len(plan) <= 8, islice(stream(create(config, problem)), 5000))
    ]
    assert len(plans) < 5000
    assert sorted(plans) == sorted(all_plans(problem, longest=8))
    assert list(map(len, plans)) == sorted(map(len, plans))


@each_config
@given(problem=problems(boxes=2))
def test_a_stream_ends_after_all_plans(config: Config, problem: Problem) -> None:
    generator = create(config, problem)
    assert sorted(plan.actions for plan in stream(generator)) == sorted(all_plans(problem, math.inf))
    assert generator.exhausted
    assert generator.next_plan(1000) is None


@each_config
def test_a_goal_out_of_reach_exhausts_the_stream(config: Config) -> None:
    """A tipped box never stands."""
    initial = state([("table", "cyan"), ("table", "red")], tipped=("red",))
    problem = Problem(("cyan", "red"), ("table",), initial, tower_goal(("table", "cyan", "red")))
    assert list(stream(create(config, problem))) == []


@each_config
def test_a_goal_that_holds_is_one_plan_without_actions(config: Config) -> None:
    initial = state([("table", "cyan")])
    generator = create(config, Problem(("cyan",), ("table",), initial, tower_goal(("table", "cyan"))))
    assert list(stream(generator)) == [Skeleton((initial,), ())]


@each_config
@given(problem=problems(boxes=3))
def test_one_expansion_at_a_time_gives_the_same_stream(config: Config, problem: Problem) -> None:
    slow, fast = create(config, problem), create(config, problem)
    for plan in islice(stream(fast), 20):
        found, before = None, slow.expanded
        while found is None:
            found = slow.next_plan(1)
            assert slow.expanded == before + 1
            before = slow.expanded
        assert found == plan
        assert slow.expanded == fast.expanded


def test_a_call_stops_after_its_expansions() -> None:
    generator = create(BreadthFirst(), LEVELS["hard"])
    assert generator.next_plan(100) is None
    assert generator.expanded == 100
    assert generator.next_plan(0) is None
    assert generator.expanded == 100
    assert not generator.exhausted


@settings(max_examples=25)
@given(problem=problems(boxes=8, supports=4))
def test_best_first_plans_for_eight_boxes_within_a_thousand_expansions(problem: Problem) -> None:
    assume(not problem.goal.holds(problem.initial))
    assert create(BestFirst(), problem).next_plan(1000) is not None


SORTING = Problem(
    tuple("abcdefgh"),
    ("east", "north", "south", "west"),
    state([("east", "a", "b"), ("north", "c", "d"), ("south", "e", "f"), ("west", "g", "h")]),
    Goal.of(tower_atoms(("north", "a", "c", "e", "g")) | tower_atoms(("south", "h", "f", "d", "b"))),
)
"""Eight boxes on four supports, to sort into two towers."""


def test_best_first_search_sorts_eight_boxes_at_once() -> None:
    generator = create(BestFirst(), SORTING)
    plan = generator.next_plan(1000)
    assert plan is not None
    assert len(plan) <= 24
    assert generator.expanded <= 100


def test_breadth_first_search_that_loses_patience_sorts_eight_boxes_in_the_fewest_moves() -> None:
    generator = create(BreadthFirst(patience=500), SORTING)
    plan = generator.next_plan(20_000)
    assert plan is not None
    assert len(plan) == len(next(stream(create(BestFirst(weight=1), SORTING))))


@each_config
@given(data=st.data(), problem=problems(boxes=4))
def test_plans_around_obstructions_move_them_first(config: Config, data: st.DataObject, problem: Problem) -> None:
    obstructions = data.draw(draw_obstructions(problem))
    plan = create(config, problem).next_plan(500, obstructions)
    if plan is not None:
        assert plan.states[0] == problem.initial
        assert [problem.goal.holds(s) for s in plan.states] == [False] * len(plan) + [True]
        for before, action, after in zip(plan.states, plan.actions, plan.states[1:], strict=False):
            assert problem.domain.successor(before, action) == after
    for action, box in obstructions if plan is not None else ():
        first = plan.actions.index(action) if action in plan.actions else 0
        lifted = any(name == "pick" and moved == box for name, (moved, _) in plan.actions[:first])
        above = action.name == "pick" and box in objects_beneath(action.args[0], supporters(problem.initial))
        assert lifted or above or box in problem.supports or action not in plan.actions


@each_config
@settings(max_examples=30)
@given(data=st.data(), problem=problems(boxes=3))
def test_no_plan_is_given_twice_whatever_is_in_the_way(config: Config, data: st.DataObject, problem: Problem) -> None:
    generator, asked = create(config, problem), [data.draw(draw_obstructions(problem)), frozenset[Obstruction]()]
    plans = [generator.next_plan(200, asked[call % 2]) for call in range(20)]
    found = [plan.actions for plan in plans if plan is not None]
    assert len(set(found)) == len(found)


PARKED = Problem(
    ("low", "tall", "top"),
    ("table",),
    state([("table", "tall", "top"), ("table", "low")]),
    tower_goal(("table", "low")),
)
PICK_LOW = Action("pick", ("low", "table"))


@each_config
def test_a_box_can_be_moved_on_what_it_stands_on(config: Config) -> None:
    """No other stream has such plans, since they do not change the state."""
    goal = Goal.of({Atom(ON, ("low", "top"))})
    generator = create(config, replace(PARKED, goal=goal))
    plan = generator.next_plan(1000, frozenset({Obstruction(PICK_LOW, "top")}))
    assert plan is not None
    assert list(map(str, plan.actions)) == [
        "pick(top, tall)",
        "place(top, table)",
        "pick(low, table)",
        "place(low, top)",
    ]
    plan = generator.next_plan(1000, frozenset({Obstruction(PICK_LOW, "tall")}))
    assert plan is not None
    moved = [moved for name, (moved, _) in plan.actions if name == "pick"]
    assert moved == ["top", "tall", "low"]
    assert len(plan) == 6


@each_config
def test_when_nothing_can_be_moved_first_any_plan_is_the_next(config: Config) -> None:
    goal = Goal.of({Atom(ON, ("low", "top"))})
    plain, around = (create(config, replace(PARKED, goal=goal)) for _ in range(2))
    first = plain.next_plan(1000)
    assert around.next_plan(1000, frozenset({Obstruction(PICK_LOW, "table")})) == first
    each_other = frozenset(Obstruction(Action("pick", pair), pair[0]) for pair in [("top", "tall"), ("low", "table")])
    assert around.next_plan(1000, each_other) is None
    assert around.next_plan(1000, each_other) == plain.next_plan(1000)
    assert around.expanded > plain.expanded


def test_no_patience_is_refused() -> None:
    with refusal(Code.OUT_OF_RANGE, "generators.breadth-first.patience", value=0):
        BreadthFirst(patience=0)


@pytest.mark.parametrize("weight", [-1.0, 1e308, math.inf, math.nan])
def test_a_weight_that_makes_no_sense_is_refused(weight: float) -> None:
    with refusal(Code.OUT_OF_RANGE, "generators.best-first.weight", value=weight):
        BestFirst(weight=weight)


TWO_IN_THE_WAY = frozenset(
    {
        Obstruction(Action("place", ("cyan", "rack")), "blue"),
        Obstruction(Action("place", ("yellow", "cyan")), "red"),
    }
)
RECORDED = {
    "breadth_first": "60b75469cf3c9d8c",
    "impatient": "723b53774fdcaba2",
    "best_first": "da9e6be5161ff9cf",
    "a_star": "7089a9731103bc20",
}
"""Hashes of the beginnings of streams; they change only on purpose."""


@pytest.mark.parametrize("name", CONFIGS)
def test_the_streams_are_the_recorded_ones(name: str) -> None:
    lines = []
    for problem in LEVELS.values() if name == "breadth_first" else [*LEVELS.values(), SORTING]:
        generator = create(CONFIGS[name], problem)
        for call in range(60):
            in_the_way = TWO_IN_THE_WAY if call % 3 == 2 and problem is not SORTING else frozenset[Obstruction]()
            plan = generator.next_plan(1000, in_the_way)
            lines.append(f"{None if plan is None else ' '.join(map(str, plan.actions))} {generator.expanded}")
    assert hashlib.sha256("\n".join(lines).encode()).hexdigest()[:16] == RECORDED[name]


PROGRAM = """
from tests.symbolic.test_skeletons import CONFIGS, LEVELS, TWO_IN_THE_WAY, create
from tests.refusals import refusal
for config in CONFIGS.values():
    generator = create(config, LEVELS["medium"])
    for _ in range(60):
        print(*generator.next_plan(1000).actions, generator.expanded)
    for _ in range(20):
        print(*generator.next_plan(1000, TWO_IN_THE_WAY).actions, generator.expanded)
"""


def test_the_stream_does_not_depend_on_the_hash_seed() -> None:
    outputs = [run_code(PROGRAM, hash_seed) for hash_seed in (1, 2)]
    assert outputs[0].count("\n") == 320
    assert outputs[0] == outputs[1]
