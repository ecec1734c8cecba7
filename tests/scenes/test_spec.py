"""Scene files: exact round trips, defaults, poses, and files that appear whole or not at all."""

import string
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.core.decoding import decode
from ictamp_drake.core.errors import Code
from ictamp_drake.core.reading import parse
from ictamp_drake.models.shapes import rack_sdf
from ictamp_drake.scenes.spec import (
    INTERFERENCES,
    SUPPORT_SIDES,
    SUPPORT_SIZES,
    ArmSpec,
    BoxSpec,
    SceneSpec,
    SupportSpec,
    check_widths,
    load_scene,
    save_scene,
    to_yaml,
)
from tests.refusals import refusal

SHORTEST = """
supports:
  table: {kind: table, position: [0.3, 0, 0]}
  rack: {kind: rack, position: [0.44, -0.33, 0.16], yaw: 90}
boxes:
  red_box: {size: [0.05, 0.05, 0.118], position: [0.5, 0.1, 0.059]}
goal: (on red_box rack)
"""


def _vectors(low: float, high: float) -> st.SearchStrategy[tuple[float, float, float]]:
    return st.tuples(*3 * [st.floats(low, high)])


supports = st.sampled_from(sorted(SUPPORT_SIZES)).flatmap(
    lambda kind: st.builds(
        SupportSpec,
        kind=st.just(kind),
        position=_vectors(-10, 10),
        yaw=st.floats(-360, 360),
        size=st.just(()) | _vectors(SUPPORT_SIDES[kind], 5),
    )
)
boxes = st.builds(
    BoxSpec,
    size=_vectors(0.01, 0.075),
    position=_vectors(-10, 10),
    rotation=_vectors(-360, 360),
    mass=st.floats(0.001, 3),
    friction=st.floats(0.05, 2),
    color=_vectors(0, 1),
)
letters = st.text(string.ascii_lowercase, min_size=1, max_size=4)
text = st.text(st.characters(codec="utf-8"), max_size=20)
scenes = st.builds(
    SceneSpec,
    arm=st.builds(ArmSpec, position=_vectors(-10, 10), yaw=st.floats(-360, 360)),
    supports=st.dictionaries(letters.map("s-{}".format), supports, min_size=1, max_size=3),
    boxes=st.dictionaries(letters.map("b_{}".format), boxes, min_size=1, max_size=3),
    goal=text.map("({})".format),
    seed=st.integers(0, 2**63 - 1),
    interference=st.lists(st.sampled_from(INTERFERENCES), unique=True).map(tuple),
    description=text,
)


@given(scenes)
def test_a_scene_survives_its_yaml_text_exactly(spec: SceneSpec) -> None:
    back = decode(SceneSpec, parse(to_yaml(spec)))
    assert back == spec
    assert list(back.boxes) == list(spec.boxes)


def test_a_scene_survives_its_file(tmp_path: Path) -> None:
    spec = decode(SceneSpec, parse(SHORTEST))
    save_scene(spec, tmp_path / "scene.yaml")
    assert load_scene(tmp_path / "scene.yaml") == spec
    assert [path.name for path in tmp_path.iterdir()] == ["scene.yaml"]


def test_a_scene_may_have_numbers_of_numpy(tmp_path: Path) -> None:
    spec = decode(SceneSpec, parse(SHORTEST))
    box = BoxSpec(tuple(np.full(3, 0.05)), tuple(np.array([0.5, 0.1, 0.025])), mass=np.float64(0.2))  # type: ignore[arg-type]
    spec = replace(spec, boxes={"red_box": box}, seed=np.int64(3))  # type: ignore[arg-type]
    save_scene(spec, tmp_path / "scene.yaml")
    assert load_scene(tmp_path / "scene.yaml") == spec


def test_a_failed_save_leaves_nothing_behind(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").mkdir()
    with refusal(Code.NOT_WRITABLE, file=tmp_path / "scene.yaml"):
        save_scene(decode(SceneSpec, parse(SHORTEST)), tmp_path / "scene.yaml")
    assert [entry.name for entry in tmp_path.iterdir()] == ["scene.yaml"]


def test_a_short_scene_is_filled_in() -> None:
    spec = decode(SceneSpec, parse(SHORTEST))
    assert spec.supports["table"].size == (1.2, 0.9, 0.05)
    assert spec.supports["rack"].size == (0.22, 0.32, 0.16)
    assert spec.arm == ArmSpec((0.0, 0.0, 0.0), 0.0)
    assert spec.boxes["red_box"].rotation == (0.0, 0.0, 0.0)
    assert spec.interference == ()


def test_poses_are_quaternion_then_position() -> None:
    box = BoxSpec(size=(0.05, 0.05, 0.1), position=(1, 2, 3), rotation=(90, 0, 90))
    half = 0.5  # roll 90 then yaw 90 turns x to y, y to z and z to x
    np.testing.assert_allclose(box.X_WO, [half, half, half, half, 1, 2, 3], atol=1e-15)
    rack = SupportSpec(kind="rack", position=(0.44, -0.33, 0.16), yaw=90)
    np.testing.assert_allclose(rack.X_WT, [0.5**0.5, 0, 0, 0.5**0.5, 0.44, -0.33, 0.16], atol=1e-15)
    arm = ArmSpec(position=(0, 0, 0.5), yaw=180)
    np.testing.assert_allclose(np.abs(arm.X_WB), [0, 0, 0, 1, 0, 0, 0.5], atol=1e-15)


@given(boxes)
def test_the_poses_of_boxes_have_unit_quaternions(box: BoxSpec) -> None:
    assert box.X_WO.shape == (7,)
    assert np.linalg.norm(box.X_WO[:4]) == pytest.approx(1, abs=1e-12)


@pytest.mark.parametrize("axis", range(3))
def test_a_rack_may_be_as_thin_as_its_model_can_be(axis: int) -> None:
    sides = [0.2, 0.2, 0.2]
    sides[axis] = SUPPORT_SIDES["rack"]
    rack_sdf("rack", SupportSpec("rack", (0.4, 0.0, 0.2), size=tuple(sides)).size)
    sides[axis] -= 1e-6
    with refusal(Code.OUT_OF_RANGE, "rack.size"):
        rack_sdf("rack", tuple(sides))
    with refusal(Code.OUT_OF_RANGE, "size"):
        SupportSpec("rack", (0.4, 0.0, 0.2), size=tuple(sides))


@pytest.mark.parametrize(
    ("rotation", "graspable"), [((0, 0, 30), False), ((90, 0, 30), True), ((0, 90, 30), True), ((180, 0, 0), False)]
)
def test_the_gripper_needs_one_narrow_side_as_the_box_stands(
    rotation: tuple[float, float, float], graspable: bool
) -> None:
    size = (0.1, 0.1, 0.06)
    boxes = {"thing": BoxSpec(size=size, position=(0.5, 0, 0.05), rotation=rotation)}
    spec = SceneSpec(supports={"table": SupportSpec("table", (0.5, 0, 0))}, boxes=boxes, goal="(in-hand thing)")
    if graspable:
        check_widths(spec)
    else:
        with refusal(Code.TOO_WIDE, "boxes.thing.size", value=size):
            check_widths(spec)


def test_a_box_must_fit_the_robot_that_replaces_that_of_the_scene(tmp_path: Path) -> None:
    boxes = {"thing": BoxSpec(size=(0.09, 0.09, 0.06), position=(0.5, 0, 0.03))}
    spec = SceneSpec(supports={"table": SupportSpec("table", (0.5, 0, 0))}, boxes=boxes, goal="(in-hand thing)")
    save_scene(spec, path := tmp_path / "scene.yaml")
    with refusal(Code.TOO_WIDE, "boxes.thing.size", file=path):
        load_scene(path)
    assert load_scene(path, "iiwa14_wsg50").boxes == boxes
