"""Rims: an overhanging box rests if its center is inside the support, and falls if it is outside."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from pydrake.math import RigidTransform, RollPitchYaw

from ictamp_drake.core.errors import Code
from ictamp_drake.core.types import Atom, Configuration
from ictamp_drake.scenes.spec import BoxSpec, SceneSpec, SupportSpec, load_scene
from ictamp_drake.world.abstraction import SceneAbstraction
from ictamp_drake.world.config import PhysicsConfig
from ictamp_drake.world.poses import to_transform
from ictamp_drake.world.start import start_configuration
from ictamp_drake.world.world import World
from tests.refusals import refusal
from tests.world.scenes import stay

TABLE = SupportSpec("table", (0.6, 0.0, 0.325), size=(0.4, 0.75, 0.025))
RACK = SupportSpec("rack", (0.0, -0.6, 0.4), yaw=30.0)
SIZE = (0.045, 0.045, 0.1)
INSIDE, OUTSIDE = 0.003, -0.003
"""Distance of a center inside the rim [m]."""


def beside(support: SupportSpec, x: float, y: float, yaw: float, size: tuple[float, float, float] = SIZE) -> BoxSpec:
    """A box on a support, with its center at x, y of the support's frame [m], turned by yaw [deg]."""
    X_WO = to_transform(support.X_WT) @ RigidTransform(RollPitchYaw(0, 0, np.radians(yaw)), [x, y, size[2] / 2])
    angles = np.degrees(RollPitchYaw(X_WO.rotation()).vector())
    return BoxSpec(size, tuple(X_WO.translation()), tuple(angles), mass=0.05)


def overhanging_boxes(inside: float) -> dict[str, BoxSpec]:
    """Separate boxes, with their centers at the same distance inside the rims of table and rack."""
    half, side = 0.2 - inside, 0.375 - inside
    return {
        "straight": beside(TABLE, half, 0.0, 0.0),
        "turned": beside(TABLE, half, 0.117, 22.5),
        "diagonal": beside(TABLE, -half, 0.011, 45.0),
        "long": beside(TABLE, -half, -0.19, 10.0, (0.03, 0.1, 0.03)),
        "small": beside(TABLE, -half, 0.2, 71.0, (0.03, 0.03, 0.05)),
        "corner": beside(TABLE, half, side, 0.0),
        "corner_turned": beside(TABLE, half, -side, 33.0),
        "rack_end": beside(RACK, 0.02, 0.16 - inside, 15.0),
        "rack_side": beside(RACK, 0.11 - inside, 0.01, 40.0),
        "rack_corner": beside(RACK, -0.11 + inside, -0.16 + inside, 0.0),
    }


def settle(boxes: dict[str, BoxSpec]) -> tuple[Configuration, Configuration, SceneAbstraction]:
    """The initial configuration and that after five seconds, and H of the scene."""
    spec = SceneSpec(supports={"table": TABLE, "rack": RACK}, boxes=boxes, goal=f"(on {min(boxes)} rack)")
    world = World(spec)
    c = world.initial_configuration()
    return c, PhysicsConfig().create(world).run(c, (stay(c, 5.0),)).c, SceneAbstraction(world)


@pytest.mark.parametrize("inside", [INSIDE, 0.0145])
def test_boxes_with_their_centres_inside_a_rim_stay(inside: float) -> None:
    boxes = overhanging_boxes(inside)
    first, last, H = settle(boxes)
    for name in boxes:
        np.testing.assert_allclose(last.poses[name], first.poses[name], atol=5e-4, err_msg=name)
        assert Atom("on", (name, "rack" if name.startswith("rack") else "table")) in H(last)
    assert H(last) == H(first)


def test_boxes_with_their_centres_outside_a_rim_fall() -> None:
    boxes = overhanging_boxes(OUTSIDE)
    first, last, _ = settle(boxes)
    for name in boxes:
        assert last.poses[name][6] < first.poses[name][6] - 0.1, name


@pytest.mark.parametrize("yaw", [0.0, 30.0, 45.0])
def test_a_box_that_overhangs_a_lower_one_stays_or_falls(yaw: float) -> None:
    lower = beside(TABLE, 0.0, 0.0, 0.0, (0.058, 0.058, 0.07))
    for inside in (INSIDE, OUTSIDE):
        upper = beside(TABLE, 0.029 - inside, 0.006, yaw, (0.05, 0.05, 0.1))
        upper = replace(upper, position=(*upper.position[:2], 0.325 + 0.07 + 0.05))
        first, last, H = settle({"lower": lower, "upper": upper})
        moved = np.abs(last.poses["upper"] - first.poses["upper"]).max()
        assert (moved < 5e-4) == (inside > 0), (yaw, inside, moved)
        assert (Atom("on", ("upper", "lower")) in H(last)) == (inside > 0)


def test_a_scene_with_an_overhanging_box_starts() -> None:
    spec = load_scene(Path(__file__).parents[1] / "scenes" / "cases" / "f1-overhang.yaml")
    world = World(spec)
    c, _ = start_configuration(world, SceneAbstraction(world), PhysicsConfig().create(world))
    np.testing.assert_allclose(c.poses["crate"], spec.boxes["crate"].X_WO, atol=1e-4)
    assert Atom("on", ("crate", "table")) in SceneAbstraction(world)(c)


def test_a_scene_in_which_a_centre_is_outside_a_rim_is_refused() -> None:
    spec = SceneSpec(
        supports={"table": TABLE}, boxes={"thing": beside(TABLE, 0.203, 0.0, 0.0)}, goal="(on thing table)"
    )
    world = World(spec)
    with refusal(Code.NOT_CARRIED, "boxes.thing.position", choices=("table",)):
        start_configuration(world, SceneAbstraction(world), PhysicsConfig().create(world))


def test_queries_see_no_rims() -> None:
    spec = SceneSpec(supports={"table": TABLE}, boxes={"thing": beside(TABLE, 0.19, 0.0, 0.0)}, goal="(on thing table)")
    world = World(spec)
    assert not world.plant.GetCollisionGeometriesForBody(world.plant.world_body())
    touches = world.touches(world.initial_configuration(), 0.001)
    assert ("table", "thing") in {tuple(sorted((touch.a, touch.b))) for touch in touches}
