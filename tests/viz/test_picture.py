"""The picture of a scene shows its objects at their places."""

from dataclasses import replace
from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

from ictamp_drake.scenes.regions import PoseSpec, RegionSpec
from ictamp_drake.viz.drawing import to_rgb
from ictamp_drake.viz.picture import HEIGHT, WIDTH, picture, scene_png
from ictamp_drake.viz.raster import Camera
from ictamp_drake.viz.reasons import MOVED, OBSTACLE, Reasons, RefusedAction
from ictamp_drake.viz.stage import FIELD_OF_VIEW, viewpoint
from tests.viz.scene import SPEC, START, swing


def color_at(image: np.ndarray, p_W: np.ndarray) -> np.ndarray:
    """Mean color around the place where a point in W [m] must appear."""
    x, y, _ = Camera(*viewpoint(SPEC), np.deg2rad(FIELD_OF_VIEW), WIDTH, HEIGHT).project(p_W)
    column, row = round(x / 2), round(y / 2)
    return image[row - 2 : row + 3, column - 2 : column + 3].mean(axis=(0, 1))


@pytest.fixture(scope="module")
def image() -> np.ndarray:
    return picture(SPEC, START)


@pytest.mark.parametrize(("box", "channel"), [("red_box", 0), ("blue_box", 2)])
def test_boxes_have_their_color_where_they_stand(image: np.ndarray, box: str, channel: int) -> None:
    color = color_at(image, START.poses[box][4:])
    assert color[channel] > 1.5 * max(np.delete(color, channel))


def test_table_rack_and_arm_are_there(image: np.ndarray) -> None:
    red, green, blue = color_at(image, np.array([0.6, -0.3, 0.0]))
    assert red > green > blue, "a table of wood"
    red, green, blue = color_at(image, np.array(SPEC.supports["rack"].position))
    assert blue > red, "a rack of metal"
    arm = color_at(image, np.array([0.0, 0.0, 0.3]))
    assert arm.min() > 90
    assert np.ptp(arm) < 10, "a white arm"


def test_what_moves_is_drawn_where_it_went(image: np.ndarray) -> None:
    moved = picture(SPEC, swing(1.0))
    place = START.poses["blue_box"][4:]
    assert color_at(image, place)[2] > 1.5 * color_at(image, place)[0]
    assert color_at(moved, place)[2] < color_at(moved, place)[0]
    changed = np.abs(moved.astype(int) - image).max(axis=2) > 30
    assert 0.01 < changed.mean() < 0.2


def test_the_file_is_the_picture_and_alone(image: np.ndarray, tmp_path: Path) -> None:
    scene_png(SPEC, START, tmp_path / "scene.png")
    assert [path.name for path in tmp_path.iterdir()] == ["scene.png"]
    written = matplotlib.image.imread(tmp_path / "scene.png")[..., :3]
    np.testing.assert_allclose(255 * written, image, atol=0.6)


REASONS = Reasons(
    "the time limit was reached",
    (
        RefusedAction(
            action="pick(red_box, table)", args=("red_box", "table"), refused="9 of 9", obstacles={"blue_box": 9}
        ),
    ),
)


def test_what_was_refused_and_what_was_in_the_way_is_marked(image: np.ndarray, tmp_path: Path) -> None:
    scene_png(SPEC, START, tmp_path / "why.png", reasons=REASONS)
    marked = 255 * matplotlib.image.imread(tmp_path / "why.png")[..., :3]
    assert len(marked) > HEIGHT, "there is room for words below"
    assert marked.shape[1] == WIDTH
    for box, color in (("red_box", MOVED), ("blue_box", OBSTACLE)):
        np.testing.assert_allclose(
            color_at(marked, START.poses[box][4:]), color_at(image, START.poses[box][4:]), atol=1
        )
        assert_near(marked, START.poses[box][4:], color)
    np.testing.assert_allclose(color_at(marked, np.array([0.0, 0.0, 0.3])), color_at(image, np.array([0.0, 0.0, 0.3])))


def assert_near(image: np.ndarray, p_W: np.ndarray, color: str) -> None:
    """Assert that pixels of the color exist near the place where a point in W [m] must appear."""
    x, y, _ = Camera(*viewpoint(SPEC), np.deg2rad(FIELD_OF_VIEW), WIDTH, HEIGHT).project(p_W)
    around = image[round(y / 2) - 40 : round(y / 2) + 40, round(x / 2) - 30 : round(x / 2) + 30]
    same = np.abs(around - 255 * np.array(to_rgb(color))).max(axis=2) < 2
    assert same.sum() > 100


def test_what_is_hidden_is_marked_too(tmp_path: Path) -> None:
    eye, _ = viewpoint(SPEC)
    red = START.poses["red_box"]
    towards = (eye - red[4:]) / np.linalg.norm(eye - red[4:])
    before = red + np.array([0, 0, 0, 0, *(0.2 * towards)])
    c = replace(START, poses={"red_box": red, "blue_box": before})
    scene_png(SPEC, c, tmp_path / "why.png", reasons=REASONS)
    assert_near(255 * matplotlib.image.imread(tmp_path / "why.png")[..., :3], red[4:], MOVED)


def test_things_that_are_not_in_the_scene_are_left_out(tmp_path: Path) -> None:
    (refusal,) = REASONS.refusals
    elsewhere = replace(refusal, args=("ghost",), obstacles={"panda_link5": 3})
    scene_png(SPEC, START, tmp_path / "why.png", reasons=Reasons("it ended", (elsewhere,)))
    assert (tmp_path / "why.png").exists()


def test_regions_are_drawn_on_their_support() -> None:
    """In a color of their own, beneath the boxes."""
    region = RegionSpec("table", (0.2, 0.1), (0.3, 0.0), yaw=30.0)
    spec = replace(SPEC, regions={"near": region}, poses={"spot": PoseSpec("table", (0.3, -0.15), tolerance=(0.03, 5))})
    plain, marked = picture(SPEC, START), picture(spec, START)
    for x, y, differs in ((0.6, 0.0, True), (0.6, -0.15, True), (0.6, -0.3, False), (0.6, 0.1, False)):
        p_W = np.array([x, y, 0.0])
        assert (np.abs(color_at(plain, p_W) - color_at(marked, p_W)).max() > 20) == differs
    changed = np.abs(plain.astype(int) - marked).max(axis=2) > 20
    assert 0.002 < changed.mean() < 0.05
