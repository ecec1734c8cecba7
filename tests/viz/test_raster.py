"""Triangles in pictures."""

import numpy as np
import pytest

from ictamp_drake.viz.raster import Camera, render

RED, BLUE = np.array([1.0, 0.0, 0.0]), np.array([0.0, 0.0, 1.0])
WHITE = np.ones((1, 3))
CAMERA = Camera(np.array([0.0, -2.0, 0.0]), np.zeros(3), np.pi / 2, 40, 20)
"""Looks along y, with x to its right; 1 m at the origin is 5 pixels."""


def facing_square(y: float, size: float = 0.5, x: float = 0.0) -> np.ndarray:
    """A square that faces the camera, as two triangles."""
    a, b, c, d = ((x + i * size, y, j * size) for i, j in ((-1, -1), (1, -1), (1, 1), (-1, 1)))
    return np.array([[a, b, c], [a, c, d]])


def colors(picture: np.ndarray) -> list[list[str]]:
    names = {0: "red", 2: "blue"}
    return [["white" if p.min() == 255 else names.get(int(np.argmax(p)), "?") for p in row] for row in picture]


def test_a_square_covers_what_geometry_says() -> None:
    picture = render(facing_square(0.0, size=1.0), np.array([RED, RED]), CAMERA, WHITE)
    assert picture.shape == (20, 40, 3)
    rows, columns = np.nonzero(np.array(colors(picture)) != "white")
    assert (rows.min(), rows.max()) == (5, 14)
    assert (columns.min(), columns.max()) == (15, 24)
    assert len(rows) == 100


@pytest.mark.parametrize("order", [slice(None), slice(None, None, -1)])
def test_the_nearer_triangle_hides_the_farther(order: slice) -> None:
    triangles = np.concatenate([facing_square(0.0), facing_square(-0.5)])[order]
    paint = np.array([RED, RED, BLUE, BLUE])[order]
    assert colors(render(triangles, paint, CAMERA, WHITE))[10][20] == "blue"


def test_a_far_big_square_shows_around_a_near_small_one() -> None:
    triangles = np.concatenate([facing_square(1.0, size=2.0), facing_square(0.0)])
    names = colors(render(triangles, np.array([RED, RED, BLUE, BLUE]), CAMERA, WHITE))
    assert names[10][20] == "blue"
    assert names[10][15] == "red"


def test_backs_are_left_out() -> None:
    picture = render(facing_square(0.0)[:, ::-1], np.array([RED, RED]), CAMERA, WHITE)
    assert (picture == 255).all()


def test_squares_on_the_right_are_on_the_right_and_may_leave_the_picture() -> None:
    names = colors(render(facing_square(0.0, x=4.0), np.array([RED, RED]), CAMERA, WHITE))
    assert names[10][39] == "red"
    assert names[10][20] == "white"


def test_edges_are_smooth_and_the_background_runs_from_top_to_bottom() -> None:
    grey = np.array([[1.0, 1.0, 1.0], [0.5, 0.5, 0.5]])
    picture = render(facing_square(0.0, size=0.45), np.array([RED, RED]), CAMERA, grey).astype(int)
    assert 255 >= picture[0, 0, 0] > picture[10, 0, 0] > picture[-1, 0, 0] >= 127
    assert len(np.unique(picture[10, :, 1])) > 2
