"""Nothing passes through anything: plain geometry queries examine every step of whole picks and places."""

from collections import defaultdict

import numpy as np
import pytest

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Configuration, Motion, Segment
from ictamp_drake.scenes.levels import problem_files
from ictamp_drake.scenes.spec import SceneSpec, load_scene
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.outcome import Frame
from ictamp_drake.world.simulate import Physics
from ictamp_drake.world.world import ARM, FINGERS, World
from tests.skills.rig import pick, place, rig
from tests.skills.test_skills import ON_THE_TABLE, TIPPED, TOWER, TOWER_ON_RACK
from tests.world.scenes import p_GO

GRIP, TOUCH, CARRIED, LANDING, REST, OTHERS = 5e-4, 1e-3, 5e-4, 1e-3, 1e-4, 5e-4
"""Maximum penetrations [m]: fingers into the gripped box, arm into anything, the box into anything while it is carried,
when it lands after its release, and at rest; other boxes into anything.
"""
SLIP, FINE_SLIP = 5e-3, 2e-3
"""Maximum motion of the held box in the hand [m], at the planning step and at 1 ms. Free bodies move straight during a
step, so a box that is carried around a curve drifts outwards in proportion to the step; friction cannot bring it back.
"""

Deepest = dict[tuple[str, str], float]


def execute_motion(spec: SceneSpec, c: Configuration, motion: Motion, time_step: float | None = None) -> list[Frame]:
    """Every step of a motion, simulated again."""
    step = time_step or PhysicsConfig().time_step
    physics = PhysicsConfig(time_step=step, record_period=step).create(World(spec))
    frames = physics.frames(physics.run(c, motion).recording)
    assert len(frames) >= sum(segment.duration for segment in motion) / step - 1
    return frames


def grips(spec: SceneSpec, c: Configuration, motion: Motion) -> set[tuple[bool, str | None]]:
    """Whether the gripper presses, and the object it holds, at the end of each segment of a motion."""
    seen = set()

    def watch(segment: Segment, physics: Physics) -> bool:
        seen.add((segment.gripper.force > 0, physics.held))
        return True

    PhysicsConfig().create(World(spec)).run(c, motion, watch=watch)
    return seen


def slip(world: World, held: list[Frame], box: str) -> float:
    """Distance that the box moves in the hand [m]."""
    places = np.array([p_GO(world, frame.c, box) for frame in held[::10]])
    return float(np.linalg.norm(places - places[0], axis=1).max())


def deepest(world: World, frames: list[Frame]) -> Deepest:
    """Greatest penetration of each pair of bodies [m]."""
    found: defaultdict[tuple[str, str], float] = defaultdict(float)
    for frame in frames:
        for touch in world.touches(frame.c, 0.0):
            a, b = sorted((touch.a, touch.b))
            found[a, b] = max(found[a, b], -touch.distance)
    return dict(found)


def check(found: Deepest, box: str, allowed: float) -> None:
    for (a, b), depth in found.items():
        bodies = {a, b}
        if box in bodies and bodies & set(FINGERS):
            limit = GRIP
        elif bodies & {ARM, *FINGERS}:
            limit = TOUCH
        else:
            limit = allowed if box in bodies else OTHERS
        assert depth < limit, f"{a} and {b}: {1000 * depth:.2f} mm"


CASES: dict[str, tuple[SceneSpec, list[Action]]] = {
    "table to rack": (ON_THE_TABLE, [pick("yellow_box", "table"), place("yellow_box", "rack")]),
    "off a tower onto the table": (TOWER, [pick("blue_box", "red_box"), place("blue_box", "table")]),
    "fourth of a tower": (TOWER_ON_RACK, [pick("blue_box", "table"), place("blue_box", "red_box")]),
    "tipped onto a box": (TIPPED, [pick("red_box", "table"), place("red_box", "cyan_box")]),
}


@pytest.mark.parametrize("case", CASES)
def test_nothing_passes_through_anything(case: str) -> None:
    spec, actions = CASES[case]
    setup = rig(spec)
    c = setup.start
    for action in actions:
        box = action.args[0]
        attempt = setup.attempt(c, action)
        assert attempt.succeeded, attempt.detail
        assert attempt.successor is not None
        frames = execute_motion(spec, c, attempt.motion)
        labels = [segment.label for segment in attempt.motion]
        ends = np.cumsum([segment.duration for segment in attempt.motion])
        released = ends[labels.index("release") - 1] if "release" in labels else np.inf
        check(deepest(setup.world, [frame for frame in frames if frame.time <= released]), box, CARRIED)
        check(deepest(setup.world, [frame for frame in frames if frame.time > released]), box, LANDING)
        check(deepest(setup.world, [Frame(0.0, attempt.successor)]), box, REST)
        gripped = ends[labels.index("grasp")] if "grasp" in labels else 0.0
        held = [frame for frame in frames if gripped <= frame.time <= released]
        assert slip(setup.world, held, box) < SLIP
        assert grips(spec, c, attempt.motion) <= {(True, box), (False, None)}
        c = attempt.successor


def test_a_box_carried_round_a_curve_stays_in_place_at_a_fine_step() -> None:
    setup = rig(TOWER)
    picked = setup.attempt(setup.start, pick("blue_box", "red_box")).successor
    assert picked is not None
    motion = setup.attempt(picked, place("blue_box", "table")).motion
    held = [frame for frame in execute_motion(TOWER, picked, motion, 0.001) if frame.time <= motion[0].duration]
    assert slip(setup.world, held, "blue_box") < FINE_SLIP


def test_a_finger_that_cuts_into_a_box_does_not_hold_it() -> None:
    """With this k, a vertical edge gets between two contact points of the box, and 5 mm deep into a finger's pad."""
    setup = rig(load_scene(problem_files("varied")[1]), draws=1)
    k = np.array([0.04685, 0.00228, -0.009814, 0.542513])
    attempt = setup.attempt(setup.start, pick("box_2", "table"), k=k)
    assert attempt.successor is not None
    assert attempt.successor.held == "box_2"
    depths = deepest(setup.world, [Frame(0.0, attempt.successor)])
    assert max(depths[pair] for pair in depths if set(pair) & set(FINGERS)) > 4e-3
    assert attempt.failure is Failure.SLIPPED


def test_the_check_sees_a_hand_in_a_box() -> None:
    """The check must detect a motion that goes straight through a box."""
    setup = rig(TOWER)
    attempt = setup.attempt(setup.start, pick("blue_box", "red_box"))
    blind = {**setup.start.poses, "blue_box": np.array([1.0, 0, 0, 0, 0.5, 0.1, 0.3])}
    frames = [
        Frame(0.0, Configuration(frame.c.q, frame.c.fingers, blind))
        for frame in execute_motion(TOWER, setup.start, attempt.motion)
    ]
    with pytest.raises(AssertionError, match="mm"):
        check(deepest(setup.world, frames), "red_box", CARRIED)
