"""Tests of the order in which placements are tried when the plan puts more on top."""

from dataclasses import replace
from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Atom, Parameter, Skeleton
from ictamp_drake.motion.inverse_kinematics import ArmKinematics
from ictamp_drake.scenes.spec import SceneSpec, load_scene
from ictamp_drake.skills.config import PlaceConfig, SkillsConfig, UniformConfig
from ictamp_drake.skills.lookahead import Lookahead
from ictamp_drake.skills.uniform import UniformSampler
from ictamp_drake.symbolic.atoms import IN_HAND, ON
from ictamp_drake.tamp.method import SCENE_METHOD, Method
from ictamp_drake.tamp.solve import solve
from ictamp_drake.tamp.task import prepare
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.world import World
from tests.panda import PANDA
from tests.skills.rig import pick, place

TOWER = load_scene(Path(__file__).parents[1] / "scenes" / "cases" / "f2-tower-out-of-reach.yaml")
HERE, THERE = np.array([0.15, 0.0, 0.001, 0.0]), np.array([-0.1, 0.0, 0.001, 0.0])
"""Placements on the table `behind`, 0.45 m and 0.7 m from the arm: on the second one, only low towers can be built."""
DRAWS = 3


def plan(*actions: Action) -> Skeleton:
    """Plan with the atoms that matter here: which box is in the hand, and on what each box was put."""
    on = dict[str, str]()
    states = [frozenset({Atom(IN_HAND, (actions[0].args[0],))})]
    for name, (box, below) in actions:
        on.pop(box, None)
        on |= {box: below} if name == "place" else {}
        states.append(frozenset(Atom(ON, each) for each in on.items()))
    return Skeleton(tuple(states), actions)


def build(*boxes: str) -> list[Action]:
    """Actions that build a tower on the table `behind`, with the first box in the hand."""
    later = [step(upper, lower) for lower, upper in pairwise(boxes) for step in (_fetch, place)]
    return [place(boxes[0], "behind"), *later]


def _fetch(box: str, _: str) -> Action:
    return pick(box, "left")


def order(steps: Skeleton, *drawn: Parameter | Failure, spec: SceneSpec = TOWER) -> list[int]:
    """Numbers of the drawn parameters in the order in which they are tried, without the random ones among them."""
    world = World(spec)
    random = UniformSampler(world, UniformConfig())
    lookahead = Lookahead(world, ArmKinematics(PANDA, to_transform(spec.arm.X_WB)), random, DRAWS, PlaceConfig())
    tried = lookahead.sort(world.initial_configuration(), steps, iter(drawn), np.random.default_rng(0))
    numbers = {id(k): number for number, k in enumerate(drawn)}
    return [numbers[id(k)] for k in tried if id(k) in numbers]


def test_a_placement_out_of_reach_for_the_tower_is_put_off() -> None:
    assert order(plan(*build(*"abcdef")), THERE, HERE) == [1, 0]


@pytest.mark.parametrize(
    "actions",
    [
        build("a"),
        build("a", "b"),
        [place("a", "behind"), pick("a", "behind"), place("a", "left"), *build(*"bcdef")[1:]],
        [place("a", "left"), pick("b", "left"), *build(*"bcdef")],
        [pick("a", "left"), *build(*"abcdef")],
    ],
    ids=["nothing on top", "a low tower", "only parked", "a tower elsewhere", "a pick"],
)
def test_nothing_is_put_off_without_need(actions: list[Action]) -> None:
    assert order(plan(*actions), THERE, HERE) == [0, 1]


def test_nothing_is_lost_and_a_failure_comes_last() -> None:
    tower = plan(*build(*"abcdef"))
    assert order(tower, *(THERE.copy() for _ in range(DRAWS + 2))) == [*range(DRAWS + 2)]
    assert order(tower, THERE, Failure.NO_INVERSE_KINEMATICS) == [0, 1]


def test_a_long_box_carries_a_tower_at_its_near_end() -> None:
    bar = replace(TOWER.boxes["a"], size=(0.3, 0.07, 0.02))
    spec = replace(TOWER, boxes={**TOWER.boxes, "a": bar})
    assert order(plan(*build(*"abcdef")), THERE, HERE, spec=spec) == [0, 1]


def test_a_tower_is_built_without_a_failure() -> None:
    solution = solve(prepare(TOWER), time_limit=250, max_steps=20)
    assert solution.plan is not None


def test_only_scenes_of_ones_own_look_ahead() -> None:
    assert Method().skills == SkillsConfig(look_ahead=0)
    assert SCENE_METHOD.skills.look_ahead > 0
