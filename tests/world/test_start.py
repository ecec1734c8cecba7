"""c_0 of a scene, and errors of scenes that cannot start."""

from dataclasses import replace

import numpy as np
import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.core.types import Configuration
from ictamp_drake.scenes.spec import BoxSpec, SupportSpec
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.start import start_configuration
from ictamp_drake.world.world import World
from tests.refusals import refusal
from tests.world.scenes import box, build_tower, scene


def start(boxes: dict[str, BoxSpec], **supports: SupportSpec) -> Configuration:
    spec = scene(boxes)
    spec = replace(spec, supports={**spec.supports, **supports})
    world = World(spec)
    return start_configuration(world, SceneAbstraction(world), PhysicsConfig().create(world))[0]


def test_a_scene_at_rest_starts_where_it_is() -> None:
    boxes = {**build_tower("cyan_box", "yellow_box"), "red_box": box("red_box", (0.5, -0.1, 0.025), (90.0, 0.0, 60.6))}
    c = start(boxes)
    for name, spec in boxes.items():
        np.testing.assert_allclose(c.poses[name], spec.X_WO, atol=1e-3)
    assert c.held is None


@pytest.mark.parametrize(
    ("boxes", "bodies"),
    [
        ({**build_tower("cyan_box"), "red_box": box("red_box", (0.52, 0.1, 0.059))}, ["cyan_box", "red_box"]),
        ({"red_box": box("red_box", (0.5, 0.1, 0.05))}, ["red_box", "table"]),
        ({"red_box": box("red_box", (0.05, 0.0, 0.059))}, ["red_box", "the arm"]),
    ],
)
def test_a_scene_with_bodies_in_each_other_is_refused(boxes: dict[str, BoxSpec], bodies: list[str]) -> None:
    with refusal(Code.OVERLAP, value=bodies):
        start(boxes)


@pytest.mark.parametrize(
    ("others", "position"),
    [((), (0.5, 0.1, 0.08)), ((), (2.0, 0.1, 0.059)), (("cyan_box",), (0.54, 0.1, 0.129))],
)
def test_a_box_that_nothing_carries_is_refused(others: tuple[str, ...], position: tuple[float, float, float]) -> None:
    boxes = {**(build_tower(*others) if others else {}), "red_box": box("red_box", position)}
    with refusal(Code.NOT_CARRIED, "boxes.red_box.position", value=list(position), choices=(*others, "rack", "table")):
        start(boxes)


def test_a_support_that_the_arm_stands_in_is_refused() -> None:
    wall = SupportSpec("table", (0.35, 0.0, 0.6), size=(0.1, 0.1, 0.5))
    with refusal(Code.OVERLAP, value=["the arm", "wall"]):
        start(build_tower("cyan_box"), wall=wall)


def test_supports_may_stand_in_each_other() -> None:
    start(build_tower("cyan_box"), wall=SupportSpec("table", (0.6, 0.4, 0.1), size=(0.1, 0.1, 0.2)))


def test_a_tower_that_gravity_tears_down_is_refused() -> None:
    """Each box rests on the one below, but the upper two together tip the middle one over."""
    boxes = build_tower("cyan_box")
    boxes["yellow_box"] = box("yellow_box", (0.524, 0.1, 0.103))
    boxes["red_box"] = box("red_box", (0.55, 0.1, 0.136 + 0.059))
    with refusal(Code.NOT_AT_REST, "boxes"):
        start(boxes)
