"""Smooth bodies as signed distance functions, and triangles on their surfaces.

A function takes points, shape (n, 3) [m], and returns signed distances, shape (n,) [m], negative inside. Blending and
cutting with a radius leaves no sharp edges, as on a molded shell.
"""

from collections.abc import Callable
from typing import NamedTuple

import numpy as np

from ictamp_drake.core.types import FloatArray

Distance = Callable[[FloatArray], FloatArray]
Vector = tuple[float, float, float]

_PROJECTION_STEPS = 6


class Mesh(NamedTuple):
    """A triangle mesh: vertices (n, 3) [m], unit normals (n, 3), triangles (m, 3) as indices of vertices."""

    vertices: FloatArray
    normals: FloatArray
    triangles: np.ndarray


def dome(base: Vector, tip: Vector, radius: float, edge: float = 0.004) -> Distance:
    """A round limb, flat at its base and a hemisphere at its tip. `edge` is the radius of the rim at the base [m]."""
    start, end = np.array(base), np.array(tip)
    length = float(np.linalg.norm(end - start))
    axis = (end - start) / length

    def distance(points: FloatArray) -> FloatArray:
        along = (points - start) @ axis
        centre = np.minimum(along, length - radius)
        side = np.linalg.norm(points - start - centre[:, None] * axis, axis=1) - radius
        return intersect(side, -along, edge)

    return distance


def cylinder(start: Vector, end: Vector, radius: float, edge: float = 0.002) -> Distance:
    """A cylinder between two points with rims of radius `edge` [m]."""
    first, last = np.array(start), np.array(end)
    axis = (last - first) / np.linalg.norm(last - first)

    def distance(points: FloatArray) -> FloatArray:
        along = (points - first) @ axis
        side = np.linalg.norm(points - first - along[:, None] * axis, axis=1) - radius
        return intersect(intersect(side, -along, edge), (points - last) @ axis, edge)

    return distance


def rounded_box(centre: Vector, size: Vector, edge: float, yaw: float = 0.0, roll: float = 0.0) -> Distance:
    """A box turned by `roll` about its x axis, then by `yaw` about z [rad], with edges of radius `edge` [m]."""
    half = np.array(size) / 2 - edge
    cz, sz, cx, sx = np.cos(yaw), np.sin(yaw), np.cos(roll), np.sin(roll)
    R = np.array([[cz, -sz, 0.0], [sz, cz, 0.0], [0.0, 0.0, 1.0]]) @ np.array(
        [[1.0, 0.0, 0.0], [0.0, cx, -sx], [0.0, sx, cx]]
    )

    def distance(points: FloatArray) -> FloatArray:
        q = np.abs((points - np.array(centre)) @ R) - half
        outside = np.linalg.norm(np.maximum(q, 0.0), axis=1)
        return np.asarray(outside + np.minimum(q.max(axis=1), 0.0) - edge)

    return distance


def blend(parts: tuple[Distance, ...], radius: float) -> Distance:
    """The union of the parts, with fillets of about `radius` [m] where they meet."""

    def distance(points: FloatArray) -> FloatArray:
        result = parts[0](points)
        for part in parts[1:]:
            result = -intersect(-result, -part(points), radius)
        return result

    return distance


def intersect(a: FloatArray, b: FloatArray, radius: float) -> FloatArray:
    """The larger of two distances, rounded off where they differ by less than `radius` [m]."""
    overlap = np.maximum(radius - np.abs(a - b), 0.0)
    return np.asarray(np.maximum(a, b) + overlap * overlap / (4.0 * radius))


def triangulate(distance: Distance, lower: Vector, upper: Vector, step: float) -> Mesh:
    """Triangles on the surface inside the box from `lower` to `upper`, one vertex per cell of side `step` [m].

    The method is dual contouring without edges to preserve. The vertex of a cell that the surface crosses is the cell's
    center moved onto the surface along the gradient. Every crossed grid line joins the vertices of its four cells.
    """
    axes = [np.arange(low - 1.5 * step, high + 2.5 * step, step) for low, high in zip(lower, upper, strict=True)]
    grid = np.stack(np.meshgrid(*axes, indexing="ij"), axis=-1)
    inside = np.asarray(distance(grid.reshape(-1, 3)).reshape(grid.shape[:3]) < 0.0)
    corners = np.stack([inside[_corner(bits)] for bits in np.ndindex(2, 2, 2)])
    crossed = corners.any(axis=0) & ~corners.all(axis=0)
    index = np.full(crossed.shape, -1)
    index[crossed] = np.arange(crossed.sum())
    vertices = _project(distance, grid[:-1, :-1, :-1][crossed] + step / 2)
    quads = np.concatenate([_quads(inside, index, axis) for axis in range(3)])
    triangles = np.concatenate([quads[:, [0, 1, 2]], quads[:, [0, 2, 3]]])
    return Mesh(vertices, _unit(_gradient(distance, vertices)), triangles)


def _corner(bits: tuple[int, ...]) -> tuple[slice, ...]:
    return tuple(slice(1, None) if bit else slice(None, -1) for bit in bits)


def _gradient(distance: Distance, points: FloatArray) -> FloatArray:
    offsets = 1e-5 * np.eye(3)
    return np.stack([(distance(points + o) - distance(points - o)) / 2e-5 for o in offsets], axis=1)


def _unit(vectors: FloatArray) -> FloatArray:
    return np.asarray(vectors / np.linalg.norm(vectors, axis=1, keepdims=True))


def _project(distance: Distance, points: FloatArray) -> FloatArray:
    for _ in range(_PROJECTION_STEPS):
        gradient = _gradient(distance, points)
        scale = distance(points) / np.sum(gradient * gradient, axis=1)
        points = points - scale[:, None] * gradient
    return points


def _quads(inside: np.ndarray, index: np.ndarray, axis: int) -> np.ndarray:
    """Indices of the four cells around every grid line along `axis` that the surface crosses, shape (n, 4)."""
    solid, cells = np.moveaxis(inside, axis, 0), np.moveaxis(index, axis, 0)
    low, high = solid[:-1, 1:-1, 1:-1], solid[1:, 1:-1, 1:-1]
    around = [cells[:, 1:, 1:], cells[:, :-1, 1:], cells[:, :-1, :-1], cells[:, 1:, :-1]]
    leaving = np.stack([cell[low & ~high] for cell in around], axis=1)
    entering = np.stack([cell[high & ~low] for cell in around[::-1]], axis=1)
    quads = np.concatenate([leaving, entering])
    return quads[:, ::-1] if axis == 1 else quads
