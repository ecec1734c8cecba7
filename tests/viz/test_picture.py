"""The picture of a scene shows its objects at their places."""

from pathlib import Path

import matplotlib.image
import numpy as np
import pytest

from ictamp_drake.viz.picture import HEIGHT, WIDTH, picture, scene_png
from ictamp_drake.viz.raster import Camera
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
