"""A scene on a Meshcat server."""

import socket
from dataclasses import replace
from urllib.parse import urlparse

import numpy as np
import pytest
from pydrake.geometry import Meshcat, Role
from pydrake.math import RotationMatrix

from ictamp_drake.core.errors import Code
from ictamp_drake.scenes.spec import ArmSpec, SupportSpec
from ictamp_drake.viz.stage import Stage, start_meshcat, viewpoint
from tests.refusals import refusal
from tests.viz.meshcat_page import download, objects, position
from tests.viz.scene import SPEC, START, swing


@pytest.fixture(scope="module")
def meshcat() -> Meshcat:
    return start_meshcat()


def test_only_this_machine_is_answered(meshcat: Meshcat) -> None:
    port = urlparse(meshcat.web_url()).port
    with socket.create_connection(("localhost", port)):
        pass
    with pytest.raises(ConnectionRefusedError):  # a server that listens everywhere would answer at 127.0.0.2
        socket.create_connection(("127.0.0.2", port))


def test_a_port_that_is_taken_is_named(meshcat: Meshcat) -> None:
    port = urlparse(meshcat.web_url()).port
    with refusal(Code.IN_USE, "port", value=port):
        start_meshcat(port)


@pytest.mark.parametrize("port", [-1, 80, 65536])
def test_a_port_that_cannot_be_is_refused(port: int) -> None:
    with refusal(Code.OUT_OF_RANGE, "port", value=port):
        start_meshcat(port)


def test_looks_are_shown_and_collision_shapes_are_not(meshcat: Meshcat) -> None:
    stage = Stage(SPEC, meshcat)
    stage.show(START)
    inspector = stage.shapes(START).inspector()
    assert objects(download(meshcat.web_url())) == inspector.NumGeometriesWithRole(Role.kIllustration)


def test_bodies_are_where_the_configuration_says(meshcat: Meshcat) -> None:
    stage, c = Stage(SPEC, meshcat), swing(0.5)
    stage.show(c)
    commands, poses = download(meshcat.web_url()), stage.poses(c)
    np.testing.assert_allclose(position(commands, "/scene/blue_box/blue_box"), c.poses["blue_box"][4:])
    hand = "/scene/robot/panda/panda_hand"
    np.testing.assert_allclose(position(commands, hand), poses[hand].translation())
    assert np.linalg.norm(poses[hand].translation() - stage.poses(START)[hand].translation()) > 0.1


def test_poses_are_those_of_arm_and_boxes() -> None:
    moving = {path.rsplit("/", 1)[1] for path in Stage(SPEC, start_meshcat()).poses(START)}
    assert {"red_box", "blue_box", "panda_hand", "panda_leftfinger"} < moving
    assert moving.isdisjoint({"table", "rack"})


def test_the_view_turns_with_the_scene() -> None:
    turned = replace(
        SPEC,
        arm=ArmSpec(yaw=90.0),
        supports={
            "table": SupportSpec("table", (0.0, 0.3, 0.0), 90.0),
            "rack": SupportSpec("rack", (0.3, 0.44, 0.16), 180.0),
        },
    )
    for before, after in zip(viewpoint(SPEC), viewpoint(turned), strict=True):
        np.testing.assert_allclose(RotationMatrix.MakeZRotation(np.pi / 2) @ before, after, atol=1e-9)


def test_a_wider_scene_is_looked_at_from_farther_away() -> None:
    wide = replace(SPEC, supports={**SPEC.supports, "far": SupportSpec("table", (2.0, 0.0, 0.0))})
    (eye, at), (far_eye, far_at) = viewpoint(SPEC), viewpoint(wide)
    assert np.linalg.norm(far_eye - far_at) > 1.2 * np.linalg.norm(eye - at)
