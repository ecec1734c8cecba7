"""Links that always touch, where links of the arm and of the gripper have the same name."""

from pathlib import Path
from typing import Any

import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.robots.alone import Alone
from ictamp_drake.robots.robot import find_robot
from tests.refusals import refusal
from tests.robots import small

FOUND = ("bend_link", "gripper::base")


def write(folder: Path, **changes: Any) -> str:
    """Write the small robot as two models, with a hand that is named as the arm's base and sits in the bend."""
    arm, fingers = small.urdf().split('<link name="left_finger"', 1)
    arm, hand = arm.split('<link name="hand"')
    hand = f'<robot name="hand"><link name="base"{hand}<link name="left_finger"{fingers}'
    mount = hand.index('<joint name="mount"')
    hand = hand[:mount] + hand[hand.index("</joint>") + len("</joint>") :]
    (folder / "hand.urdf").write_text(hand.replace('link="hand"', 'link="base"'), encoding="utf-8")
    content = small.content() | changes
    content["gripper"] |= {
        "model": "hand.urdf",
        "base": "base",
        "mount": {"frame": "base", "position": [0, 0, -0.07]},
        "grasp": {"frame": "base", "position": [0, 0, 0.095]},
    }
    return str(small.write(folder, content, arm + "</robot>"))


def test_they_are_found(tmp_path: Path) -> None:
    robot = find_robot(write(tmp_path))
    assert robot.touching == (FOUND,)
    assert Alone(robot).contacts(robot.home, robot.gripper.positions(0.08)) == []


@pytest.mark.parametrize(("pair", "touch"), [(("bend_link", "base"), [FOUND]), (FOUND, [])])
def test_the_file_says_which_of_them_is_meant(
    tmp_path: Path, pair: tuple[str, str], touch: list[tuple[str, str]]
) -> None:
    robot = find_robot(write(tmp_path, touching=[list(pair)]))
    assert Alone(robot).contacts(robot.home, robot.gripper.positions(0.08)) == touch


def test_another_name_is_refused(tmp_path: Path) -> None:
    robot = find_robot(write(tmp_path, touching=[["base", "gripper::wrist_link"]]))
    with refusal(Code.UNKNOWN_CHOICE, "touching[0]", value="gripper::wrist_link"):
        Alone(robot)
