"""Surfaces are closed, face outwards and have the right size."""

from pathlib import Path

import numpy as np
import pytest

import ictamp_drake.models
from ictamp_drake.viz.triangles import box, capsule, cylinder, polygons, read_gltf


def volume(triangles: np.ndarray) -> float:
    """Volume inside a closed surface that faces outwards [m³]."""
    a, b, c = np.moveaxis(triangles, 1, 0)
    return float(np.sum(a * np.cross(b, c)) / 6)


@pytest.mark.parametrize(
    ("triangles", "size", "inside"),
    [
        (box(np.array([0.2, 0.4, 0.6])), (0.2, 0.4, 0.6), 0.048),
        (cylinder(0.1, 0.5), (0.2, 0.2, 0.5), np.pi * 0.005),
        (capsule(0.1, 0.0), (0.2, 0.2, 0.2), np.pi * 0.004 / 3),
        (capsule(0.1, 0.5), (0.2, 0.2, 0.7), np.pi * (0.004 / 3 + 0.005)),
    ],
)
def test_shapes_have_their_size_and_volume(triangles: np.ndarray, size: tuple[float, ...], inside: float) -> None:
    points = triangles.reshape(-1, 3)
    np.testing.assert_allclose(points.max(axis=0), np.array(size) / 2, atol=1e-9)
    np.testing.assert_allclose(points.min(axis=0), -np.array(size) / 2, atol=1e-9)
    assert volume(triangles) == pytest.approx(inside, rel=0.02)


def test_a_link_stands_upright_in_its_color() -> None:
    path = Path(ictamp_drake.models.__file__).parent / "sdf" / "panda_link0.gltf"
    triangles, color = read_gltf(path)
    low, high = triangles.reshape(-1, 3).min(axis=0), triangles.reshape(-1, 3).max(axis=0)
    assert low[2] == pytest.approx(0.0, abs=0.01)
    assert high[2] == pytest.approx(0.14, abs=0.02)
    assert volume(triangles) > 0
    assert color.shape == (3,)
    assert color.min() > 0.5


def test_a_polygon_becomes_a_fan_of_triangles() -> None:
    angles = np.arange(6) * np.pi / 3
    hexagon = np.stack([np.cos(angles), np.sin(angles), np.zeros(6)], axis=1)
    triangles = polygons([hexagon, hexagon[:3]])
    area = np.linalg.norm(np.cross(*(triangles[:, i] - triangles[:, 0] for i in (1, 2))), axis=1) / 2
    assert len(triangles) == 5
    assert area[:4].sum() == pytest.approx(3 * np.sqrt(3) / 2)
    assert polygons([]).shape == (0, 3, 3)
