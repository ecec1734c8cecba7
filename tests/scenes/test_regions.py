"""Regions and poses of scene files: how they are read, written, and refused."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.scenes.regions import PoseSpec, RegionSpec
from ictamp_drake.scenes.spec import SceneSpec, load_scene, save_scene, to_dict
from tests.refusals import refusal

TEXT = """
supports:
  table: {kind: table, position: [0.3, 0, 0], size: [1, 0.8, 0.03]}
  rack: {kind: rack, position: [0.44, -0.33, 0.16]}
boxes:
  red: {size: [0.05, 0.05, 0.1], position: [0.45, 0.1, 0.05]}
regions:
  near: {on: table, size: [0.2, 0.3]}
  far: {on: table, size: [0.1, 0.1], position: [0.3, 0.1], yaw: 45}
poses:
  spot: {on: table, position: [0.3, -0.2], yaw: 30}
goal: (on red near)
"""


def load(text: str, folder: Path) -> SceneSpec:
    (folder / "scene.yaml").write_text(text, encoding="utf-8")
    return load_scene(folder / "scene.yaml")


def test_regions_and_poses_survive_their_file(tmp_path: Path) -> None:
    """Although YAML reads the key `on` as a truth value."""
    spec = load(TEXT, tmp_path)
    assert spec.regions["near"] == RegionSpec("table", (0.2, 0.3))
    assert spec.poses == {"spot": PoseSpec("table", (0.3, -0.2), 30.0)}
    save_scene(spec, tmp_path / "again.yaml")
    assert load_scene(tmp_path / "again.yaml") == spec


def test_a_scene_without_them_is_written_without_them(tmp_path: Path) -> None:
    spec = replace(load(TEXT, tmp_path), regions={}, poses={})
    assert not {"regions", "poses"} & to_dict(spec).keys()


def test_places_know_their_support(tmp_path: Path) -> None:
    spec = load(TEXT, tmp_path)
    assert list(spec.places) == ["table", "rack", "near", "far", "spot"]
    assert [spec.support_of(name) for name in ("table", "near", "spot", "red")] == ["table", "table", "table", "red"]
    np.testing.assert_allclose(spec.regions["far"].X_TR[4:], [0.3, 0.1, 0.0])


@pytest.mark.parametrize(
    ("old", "new", "code", "field"),
    [
        ("near: {on: table", "near: {on: floor", Code.UNKNOWN_CHOICE, "regions.near.on"),
        ("near: {on: table", "near: {on: red", Code.UNKNOWN_CHOICE, "regions.near.on"),
        ("near: {on: table, ", "near: {", Code.MISSING_FIELD, "regions.near.on"),
        ("near:", "red:", Code.REPEATED, "regions.red"),
        ("[0.2, 0.3]", "[0.2]", Code.WRONG_LENGTH, "regions.near.size"),
        ("[0.2, 0.3]", "[0.2, 0]", Code.OUT_OF_RANGE, "regions.near.size"),
        ("[0.2, 0.3]", "[0.2, 0.81]", Code.OUT_OF_RANGE, "regions.near"),
        ("[0.2, 0.3]", "[0.6, 0.3]", Code.OVERLAP, "regions.far"),
        ("[0.3, 0.1], yaw: 45", "[0.5, 0.1], yaw: 0", Code.OUT_OF_RANGE, "regions.far"),
        ("[0.3, -0.2], yaw: 30", "[0.3, 0.05], yaw: 30", Code.OVERLAP, "poses.spot"),
        ("yaw: 30", "tolerance: [0, 5]", Code.OUT_OF_RANGE, "poses.spot.tolerance[0]"),
        ("yaw: 30", "tolerance: [0.01, 0]", Code.OUT_OF_RANGE, "poses.spot.tolerance[1]"),
    ],
)
def test_a_wrong_region_is_refused(old: str, new: str, code: Code, field: str, tmp_path: Path) -> None:
    assert old in TEXT
    with refusal(code, field, file=tmp_path / "scene.yaml"):
        load(TEXT.replace(old, new), tmp_path)


@pytest.mark.parametrize(("gap", "overlap"), [(0.001, False), (-0.001, True)])
def test_a_corner_counts_for_the_overlap(gap: float, overlap: bool, tmp_path: Path) -> None:
    """A square on its corner beside another square."""
    reach = 0.05 * 2**0.5
    far = RegionSpec("table", (0.1, 0.1), (0.1 + reach + gap, 0.0), yaw=45)
    spec = load(TEXT, tmp_path)
    regions = {"near": RegionSpec("table", (0.2, 0.2)), "far": far}
    if overlap:
        with refusal(Code.OVERLAP):
            replace(spec, regions=regions)
    else:
        replace(spec, regions=regions)
