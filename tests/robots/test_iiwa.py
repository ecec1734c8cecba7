"""The iiwa with the WSG, as its file describes it; and fingers that close towards different limits of their joints."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from ictamp_drake.robots.robot import Robot, find_robot
from ictamp_drake.robots.spec import find_file
from tools.iiwa import wsg


@pytest.fixture(scope="module")
def robot() -> Robot:
    return find_robot("iiwa14_wsg50")


def test_home_points_down_in_front_of_the_base(robot: Robot) -> None:
    X_BG = robot.forward(robot.home[None])[0]
    np.testing.assert_allclose(X_BG[:3, :3], np.diag([1.0, -1.0, -1.0]), atol=1e-9)
    assert X_BG[0, 3] > 0.4


def test_the_gripper_is_mounted_beyond_the_flange(robot: Robot) -> None:
    assert robot.X_FG.translation()[2] == pytest.approx(wsg.ADAPTER[1] + wsg.BODY[2] + wsg.PAD_HEIGHT)


def test_fingers_share_the_width(robot: Robot) -> None:
    np.testing.assert_allclose(robot.gripper.positions(0.05), 0.025, atol=1e-9)


def test_fingers_that_close_towards_different_limits(tmp_path: Path) -> None:
    first, second = wsg.wsg_sdf(()).split(f'<joint name="{wsg.JOINTS[1]}"')
    mirrored = second.replace("<xyz>0 1 0</xyz>", "<xyz>0 -1 0</xyz>").replace("<lower>0<", "<lower>-0.055<")
    mirrored = mirrored.replace("<upper>0.055<", "<upper>0<").replace('multiplier="1"', 'multiplier="-1"')
    (tmp_path / "wsg.sdf").write_text(f'{first}<joint name="{wsg.JOINTS[1]}"{mirrored}')
    spec = yaml.safe_load(find_file("iiwa14_wsg50").read_text())
    spec["gripper"]["model"] = "wsg.sdf"
    (tmp_path / "robot.yaml").write_text(yaml.safe_dump(spec))
    gripper = find_robot(str(tmp_path / "robot.yaml")).gripper
    np.testing.assert_allclose(gripper.positions(0.05), [0.025, -0.025], atol=1e-9)
    assert gripper.widths[0] == pytest.approx(0.0, abs=1e-9)
