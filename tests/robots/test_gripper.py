"""Fingers that close around something beside the middle of the hand, and the outlines of fingers."""

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
    gripper = find_robot(str(small.write_coupled(tmp_path))).gripper
    np.testing.assert_allclose(gripper.enclose(0.04, middle), 0.02)


def test_the_outline_of_a_finger_is_that_at_the_opening_of_the_file(tmp_path: Path) -> None:
    content = small.content()
    widths = []
    for opening in (0.08, 0.04):
        content["gripper"]["opening"] = opening
        widths.append(find_robot(str(small.write(tmp_path, content))).gripper.hand.finger.half_width)
    assert widths == pytest.approx([0.006, 0.006])


def test_fingers_may_reach_below_their_pads(tmp_path: Path) -> None:
    content = small.content()
    finger = [{"kind": "box", "size": [0.02, 0.012, 0.08], "position": [0, 0, 0.05]}]
    content["gripper"]["collision"] = {f"{name}_finger": finger for name in ("left", "right")}
    hand = find_robot(str(small.write(tmp_path, content))).gripper.hand
    assert hand.depth == pytest.approx(0.04)
    assert hand.tip > hand.depth > hand.pad_half_height
