"""Grip force: friction as Drake combines it, and a sentence for what the hand cannot hold."""

import numpy as np
import pytest
from pydrake.multibody.plant import CalcContactFrictionFromSurfaceProperties, CoulombFriction

from ictamp_drake.core.errors import Code
from ictamp_drake.models.contact import PAD
from ictamp_drake.robots.grip import GRAVITY, LEAST_FORCE, bearable, check_weight, friction_load, needed_force
from ictamp_drake.scenes.levels import LEVELS, problem_files
from ictamp_drake.scenes.spec import load_scene
from tests.panda import GRIPPER, HAND, MAX_GRIP_FORCE
from tests.refusals import refusal

LEVER = HAND.lever
WEIGHT = 1.8 * GRAVITY


@pytest.mark.parametrize("friction", [0.05, 0.35, 1.0, 2.0])
def test_friction_is_combined_as_in_drake(friction: float) -> None:
    pad, box = (CoulombFriction(value, value) for value in (PAD.friction, friction))
    combined = CalcContactFrictionFromSurfaceProperties(pad, box).static_friction()
    assert bearable(30.0, friction) == pytest.approx(2 * combined * 30.0)


def test_the_load_adds_the_force_across_and_the_moment_about_the_fingers_direction() -> None:
    p_GO = np.array([0.0, 0.0, 2 * LEVER])
    down, along, sideways = [0.0, 0.0, WEIGHT], [0.0, WEIGHT, 0.0], [WEIGHT, 0.0, 0.0]
    load = friction_load(p_GO, np.array([down, along, sideways]), LEVER)
    np.testing.assert_allclose(load / WEIGHT, [1.0, 0.0, np.sqrt(5)], atol=1e-12)


def test_the_needed_force_bears_the_load_with_its_safety() -> None:
    force = needed_force(1.8, 0.35, LEVER, LEVER, safety=3.0)
    load = friction_load(np.array([LEVER, 0.0, 0.05]), np.array([[0.0, 0.0, WEIGHT]]), LEVER)
    assert bearable(force, 0.35) == pytest.approx(3.0 * float(load[0]))


def test_a_box_that_the_hand_cannot_hold_is_refused() -> None:
    heaviest = 2.0 * MAX_GRIP_FORCE / needed_force(2.0, 0.35, LEVER)
    check_weight(0.999 * heaviest, 0.35, GRIPPER, "boxes.thing")
    with refusal(Code.TOO_HEAVY, "boxes.thing.mass", value=1.001 * heaviest):
        check_weight(1.001 * heaviest, 0.35, GRIPPER, "boxes.thing")
    check_weight(1.001 * heaviest, 0.35, GRIPPER, "boxes.thing", safety=1.9)


@pytest.mark.parametrize("level", LEVELS)
def test_no_box_of_the_levels_needs_more_than_the_least_force(level: str) -> None:
    """Not even at its end, so that all are gripped as they were before force followed from mass."""
    boxes = {box for path in problem_files(level) for box in load_scene(path).boxes.values()}
    assert max(needed_force(box.mass, box.friction, LEVER, max(box.size) / 2) for box in boxes) < LEAST_FORCE
