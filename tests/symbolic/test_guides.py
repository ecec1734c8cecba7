"""The guides agree with distances found by visiting every state."""

import math

import pytest
from hypothesis import assume, given
from hypothesis import strategies as st

from ictamp_drake.core.errors import IctampError
from ictamp_drake.core.types import State
from ictamp_drake.symbolic.domain import Domain
from ictamp_drake.symbolic.goal import Goal
from ictamp_drake.symbolic.goal_reading import check_goal, parse_goal
from ictamp_drake.symbolic.guides import BreadthFirstDistance, MoveCount
from tests.symbolic.towers import (
    LEVELS,
    Problem,
    Tower,
    arrangements,
    draw_obstructions,
    formulas,
    problems,
    reachable,
    state,
    tower_atoms,
    tower_goal,
)


def distances(domain: Domain, initial: State, goal: Goal) -> dict[State, float]:
    """Number of actions from every reachable state to the goal, by sweeping over all states until nothing changes."""
    successors = {s: [after for _, after in domain.successors(s)] for s in reachable(domain, initial)}
    distance = {s: 0 if goal.holds(s) else math.inf for s in successors}
    while True:
        better = {
            s: 1 + min((distance[t] for t in successors[s]), default=math.inf) for s in successors if not goal.holds(s)
        }
        if all(distance[s] == better[s] for s in better):
            return distance
        distance |= better


@given(problems(boxes=3))
def test_the_move_count_never_exceeds_the_distance_and_falls_by_one_at_most(problem: Problem) -> None:
    domain, guide = problem.domain, MoveCount(problem.domain, problem.goal, weight=1)
    for s, distance in distances(domain, problem.initial, problem.goal).items():
        assert guide.estimate_distance(s) <= distance
        assert guide.estimate_distance(s) > 0 or problem.goal.holds(s)
        assert all(
            guide.estimate_distance(after) >= guide.estimate_distance(s) - 1 for _, after in domain.successors(s)
        )


@given(st.data(), problems(boxes=3))
def test_so_it_is_with_any_formula_as_goal(data: st.DataObject, problem: Problem) -> None:
    text = data.draw(formulas(problem.boxes, problem.supports, depth=data.draw(st.integers(0, 3))))
    try:
        goal = check_goal(parse_goal(text, problem.boxes, problem.supports), problem.initial)
    except IctampError:
        assume(False)
    guide = MoveCount(problem.domain, goal, weight=1)
    for s, distance in distances(problem.domain, problem.initial, goal).items():
        assert guide.estimate_distance(s) <= distance
        assert (guide.estimate_distance(s) == 0) == goal.holds(s)
        assert all(
            guide.estimate_distance(after) >= guide.estimate_distance(s) - 1
            for _, after in problem.domain.successors(s)
        )


@given(st.data())
def test_so_it_is_with_poses(data: st.DataObject) -> None:
    boxes, places, kinds = ("a", "b", "c"), ("table", "spot", "mark"), {"spot": "pose", "mark": "pose"}
    start, end = (data.draw(arrangements(boxes, places).filter(_has_room), label) for label in ("start", "end"))
    initial = state(start)
    domain = Domain.create(boxes, places, initial, kinds)
    atoms = sorted(atom for tower in end for atom in tower_atoms(tower))
    goal = Goal.of(data.draw(st.sets(st.sampled_from(atoms), min_size=1)))
    guide = MoveCount(domain, goal, weight=1)
    for s, distance in distances(domain, initial, goal).items():
        assert guide.estimate_distance(s) <= distance < math.inf
        assert all(
            guide.estimate_distance(after) >= guide.estimate_distance(s) - 1 for _, after in domain.successors(s)
        )


def _has_room(towers: list[Tower]) -> bool:
    """Whether at most one tower stands at each pose."""
    feet = [tower[0] for tower in towers if tower[0] != "table"]
    return len(feet) == len(set(feet))


@given(data=st.data(), problem=problems(boxes=3))
def test_so_it_is_with_boxes_in_the_way(data: st.DataObject, problem: Problem) -> None:
    obstructions = data.draw(draw_obstructions(problem))
    domain, goal = problem.domain.with_obstructions(obstructions), problem.goal
    guide = MoveCount(domain, goal, weight=1, obstructions=obstructions)
    for s, distance in distances(domain, problem.initial, goal).items():
        assert guide.estimate_distance(s) <= distance
        assert all(
            guide.estimate_distance(after) >= guide.estimate_distance(s) - 1 for _, after in domain.successors(s)
        )


@pytest.mark.parametrize(("name", "actions"), [("easy", 6), ("medium", 10), ("hard", 14)])
def test_the_move_count_is_exact_for_a_tower_rebuilt_in_the_same_order(name: str, actions: int) -> None:
    problem = LEVELS[name]
    assert MoveCount(problem.domain, problem.goal, weight=1).estimate_distance(problem.initial) == actions
    assert MoveCount(problem.domain, problem.goal, weight=2).estimate_distance(problem.initial) == 2 * actions


def test_the_move_count_sees_who_is_in_the_way() -> None:
    """red is where yellow must go, and blue is on red."""
    initial = state([("table", "cyan", "red", "blue"), ("table", "yellow")])
    problem = Problem(("blue", "cyan", "red", "yellow"), ("table",), initial, tower_goal(("table", "cyan", "yellow")))
    assert MoveCount(problem.domain, problem.goal, weight=1).estimate_distance(initial) == 6


@given(problems(boxes=3))
def test_breadth_first_distances_are_exact_up_to_the_horizon(problem: Problem) -> None:
    domain, goal = problem.domain, problem.goal
    exact = distances(domain, problem.initial, goal)
    guide, depth = BreadthFirstDistance(domain, problem.initial, goal), _depths(domain, problem.initial, goal)
    while guide.horizon < math.inf:
        for s in depth:
            if depth[s] + exact[s] <= guide.horizon:
                assert guide.estimate_distance(s) == exact[s]
            assert guide.estimate_distance(s) >= exact[s]
        guide.grow()
    assert all(guide.estimate_distance(s) == exact[s] for s in depth)


def _depths(domain: Domain, initial: State, goal: Goal) -> dict[State, int]:
    """Number of actions from the start to each state that is reachable without passing the goal."""
    depth, frontier = {initial: 0}, [initial]
    for s in frontier:
        for after in [] if goal.holds(s) else [after for _, after in domain.successors(s)]:
            if after not in depth:
                depth[after] = depth[s] + 1
                frontier.append(after)
    return depth
