"""Fingers that close around something beside the middle of the hand, whatever the order of their joints."""

from pathlib import Path

import numpy as np
import pytest

from ictamp_drake.robots.gripper import Gripper
from ictamp_drake.robots.robot import find_robot
from tests.robots import small


def turned(folder: Path) -> Gripper:
    """The hand with its grasp frame turned by half a turn, so that the first pad is that of the second joint."""
    content = small.content()
    gripper, pads = content["gripper"], content["gripper"]["pads"]
    gripper["grasp"]["rotation"] = [0, 0, 180]
    pads["first"], pads["second"] = pads["second"], pads["first"]
    return find_robot(str(small.write(folder, content))).gripper


def test_each_finger_reaches_what_is_beside_the_middle(tmp_path: Path) -> None:
    gripper = find_robot(str(small.write(tmp_path))).gripper
    assert gripper.joints == ("left_joint", "right_joint")
    np.testing.assert_allclose(gripper.enclose(0.04, 0.005), [0.025, 0.015])
    np.testing.assert_allclose(turned(tmp_path).enclose(0.04, 0.005), [0.015, 0.025])


def test_no_finger_opens_farther_than_it_can(tmp_path: Path) -> None:
    gripper = find_robot(str(small.write(tmp_path))).gripper
    np.testing.assert_allclose(gripper.enclose(0.07, 0.02), [0.04, 0.015])


@pytest.mark.parametrize("middle", [0.0, 0.005])
def test_a_finger_that_follows_the_other_one_stays_with_it(tmp_path: Path, middle: float) -> None:
    model, content = small.urdf(), small.content()
    start = model.index('<joint name="right_joint"')
    mimic = '<mimic joint="left_joint" multiplier="1" offset="0"/></joint>'
    model = model[:start] + model[start:].replace("</joint>", mimic, 1)
    content["gripper"]["joints"] = ["left_joint"]
    gripper = find_robot(str(small.write(tmp_path, content, model))).gripper
    np.testing.assert_allclose(gripper.enclose(0.04, middle), 0.02)
