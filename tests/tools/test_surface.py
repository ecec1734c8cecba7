"""Triangulations of smooth bodies."""

import math

import numpy as np
import pytest

from tools.surface import Distance, Mesh, blend, cylinder, dome, rounded_box, triangulate

BODIES: dict[str, tuple[Distance, float]] = {
    "dome": (dome((0, 0, 0), (0, 0, 0.1), 0.04, 1e-4), math.pi * 0.04**2 * (0.06 + 0.04 * 2 / 3)),
    "cylinder": (cylinder((-0.05, 0, 0), (0.05, 0, 0), 0.03, 1e-4), math.pi * 0.03**2 * 0.1),
    "box": (rounded_box((0.01, 0, 0), (0.06, 0.04, 0.1), 1e-4, yaw=0.3, roll=0.2), 0.06 * 0.04 * 0.1),
}


def mesh_of(body: Distance) -> Mesh:
    return triangulate(body, (-0.12, -0.12, -0.12), (0.12, 0.12, 0.12), 0.004)


def volume(mesh: Mesh) -> float:
    """Volume inside the triangles, positive if they face outwards [m^3]."""
    a, b, c = (mesh.vertices[mesh.triangles[:, i]] for i in range(3))
    return float(np.sum(a * np.cross(b, c)) / 6.0)


@pytest.mark.parametrize("name", BODIES)
def test_triangles_close_around_the_body_and_face_outwards(name: str) -> None:
    body, expected = BODIES[name]
    mesh = mesh_of(body)
    assert volume(mesh) == pytest.approx(expected, rel=0.02)
    edges = np.concatenate([mesh.triangles[:, [i, (i + 1) % 3]] for i in range(3)])
    there = {tuple(edge) for edge in edges.tolist()}
    assert all((b, a) in there for a, b in there)


@pytest.mark.parametrize("name", BODIES)
def test_vertices_lie_on_the_surface(name: str) -> None:
    body, _ = BODIES[name]
    mesh = mesh_of(body)
    assert np.abs(body(mesh.vertices)).max() < 1e-4
    np.testing.assert_allclose(np.linalg.norm(mesh.normals, axis=1), 1.0, atol=1e-9)


def test_a_blend_holds_its_parts_and_a_fillet() -> None:
    parts = (dome((0, 0, 0), (0, 0, 0.1), 0.03), dome((0, 0, 0), (0.1, 0, 0), 0.03))
    blended = blend(parts, 0.03)
    points = np.random.default_rng(0).uniform(-0.1, 0.1, (2000, 3))
    union = np.minimum(parts[0](points), parts[1](points))
    excess = union - blended(points)
    assert np.all(excess >= 0.0)
    assert 0.0 < excess.max() <= 0.03 / 4 + 1e-12
