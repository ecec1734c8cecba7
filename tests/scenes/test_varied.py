"""Laws of the problems of the level `varied`, for any number and seed."""

import math
import re
from collections import Counter

from hypothesis import given, settings
from hypothesis import strategies as st
from scipy.spatial.transform import Rotation

from ictamp_drake.core.seeding import Stream
from ictamp_drake.core.types import Atom, FloatArray
from ictamp_drake.scenes.levels import problem_files
from ictamp_drake.scenes.packing import make_problem
from ictamp_drake.scenes.spec import ArmSpec, SceneSpec, Vector, load_scene
from ictamp_drake.scenes.varied import LARGEST_GOAL, LEAST_BOXES, MOST_BOXES
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.world import World

streams = st.sampled_from([Stream.SCENES, Stream.DATA])
problems = st.builds(make_problem, st.just("varied"), st.integers(0, 999), st.integers(0, 999), streams)


def goal(spec: SceneSpec) -> list[Atom]:
    return [Atom(predicate, (a, b)) for predicate, a, b in re.findall(r"\((on|lying) (\w+) (\w+)\)", spec.goal)]


def to_arm_frame(spec: SceneSpec, position: Vector) -> FloatArray:
    """The position in the frame of the arm's base [m]."""
    offset = [a - b for a, b in zip(position, spec.arm.position, strict=True)]
    return Rotation.from_euler("z", -spec.arm.yaw, degrees=True).apply(offset)


@given(problems)
def test_boxes_are_as_many_as_promised_and_within_reach(spec: SceneSpec) -> None:
    assert LEAST_BOXES <= len(spec.boxes) <= MOST_BOXES
    for box in spec.boxes.values():
        assert 0.2 < math.hypot(*to_arm_frame(spec, box.position)[:2]) < 0.75


@given(problems)
def test_the_goal_is_one_or_two_towers_of_boxes_as_they_are(spec: SceneSpec) -> None:
    below = {atom.args[0]: atom.args[1] for atom in goal(spec)}
    feet = [support for support in below.values() if support in spec.supports]
    assert 1 <= len(below) <= LARGEST_GOAL
    assert 1 <= len(feet) <= 2
    assert max(Counter(support for support in below.values() if support in spec.boxes).values(), default=0) <= 1
    for atom in goal(spec):
        assert (atom.predicate == "lying") == spec.boxes[atom.args[0]].is_tipped


@given(problems)
@settings(max_examples=25)
def test_nothing_overlaps_at_the_start_and_the_goal_does_not_hold(spec: SceneSpec) -> None:
    world = World(spec)
    c = world.initial_configuration()
    touches = world.touches(c, 0.0)
    assert [touch for touch in touches if touch.distance < -1e-4 and {touch.a, touch.b} & set(spec.boxes)] == []
    state = SceneAbstraction(world)(c)
    assert {atom.args[0] for atom in state if atom.predicate in ("on", "lying")} == set(spec.boxes)
    assert not set(goal(spec)) <= state


def test_the_committed_problems_show_all_that_is_promised() -> None:
    seen: Counter[str] = Counter()
    for path in problem_files("varied"):
        spec = load_scene(path)
        seen["elsewhere"] += spec.arm != ArmSpec()
        seen["two towers"] += sum(atom.args[1] in spec.supports for atom in goal(spec)) == 2
        seen["lying"] += any(atom.predicate == "lying" for atom in goal(spec))
        seen["several supports"] += len(spec.supports) > 2
        seen["table only"] += len(spec.supports) == 1
        seen["many boxes"] += len(spec.boxes) > 8
    kinds = ("elsewhere", "two towers", "lying", "several supports", "table only", "many boxes")
    assert {kind: seen[kind] for kind in kinds if seen[kind] < 3} == {}
