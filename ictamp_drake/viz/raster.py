"""Pictures of triangles with nothing but numpy: a picture must not depend on the graphics drivers of a machine."""

import numpy as np
from numpy.typing import NDArray

from ictamp_drake.core.types import FloatArray

_SAMPLES = 2
"""Samples of a pixel along x and along y, averaged for smooth edges."""

_LIGHTS = ((np.array([0.35, 0.35, 0.87]), 0.55), (np.array([0.75, -0.6, 0.28]), 0.3))
"""Directions to the lights in W and their strengths."""

_AMBIENT = 0.4

_EDGE_ON = 1e-6
"""Triangles whose plane passes nearer to the eye are too thin to be seen [m]."""


class Camera:
    """A pinhole camera without roll.

    Args:
        eye, target: where it stands and what it looks at, in W [m], shape (3,).
        field_of_view: vertical [rad].
        width, height: of the picture [pixels].
    """

    def __init__(self, eye: FloatArray, target: FloatArray, field_of_view: float, width: int, height: int) -> None:
        forward = (target - eye) / np.linalg.norm(target - eye)
        right = np.cross(forward, [0.0, 0.0, 1.0])
        right /= np.linalg.norm(right)
        self.eye = eye
        self.shape = (height * _SAMPLES, width * _SAMPLES)
        self._R_CW = np.array([right, np.cross(forward, right), forward])
        self._focal = self.shape[0] / 2 / np.tan(field_of_view / 2)

    def project(self, points: FloatArray) -> FloatArray:
        """Column and row [samples] and depth [m] of points in W, shape (..., 3)."""
        x, y, depth = np.moveaxis((points - self.eye) @ self._R_CW.T, -1, 0)
        height, width = self.shape
        return np.stack([self._focal * x / depth + width / 2, self._focal * y / depth + height / 2, depth], axis=-1)


def render(triangles: FloatArray, colours: FloatArray, camera: Camera, background: FloatArray) -> NDArray[np.uint8]:
    """A picture of triangles that all lie before the camera; those that show it their back are left out.

    Args:
        triangles: corners in W [m], counterclockwise seen from outside, shape (n, 3, 3).
        colours: red, green, blue in [0, 1], shape (n, 3).
        background: colours of its rows from top to bottom, spread evenly, shape (m, 3).

    Returns:
        shape (height, width, 3).
    """
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    seen = np.sum(normals * (camera.eye - triangles[:, 0]), axis=1) > _EDGE_ON
    shaded = colours[seen] * _brightness(normals[seen])[:, None]
    rows = np.linspace(0, len(background) - 1, camera.shape[0])
    backdrop = np.stack([np.interp(rows, np.arange(len(background)), channel) for channel in background.T], axis=1)
    image = np.repeat(backdrop[:, None], camera.shape[1], axis=1)
    front = _front(camera.project(triangles[seen]), camera.shape)
    image[front >= 0] = shaded[front[front >= 0]]
    height, width = camera.shape
    averaged = image.reshape(height // _SAMPLES, _SAMPLES, width // _SAMPLES, _SAMPLES, 3).mean(axis=(1, 3))
    return np.round(255 * np.clip(averaged, 0, 1)).astype(np.uint8)


def _brightness(normals: FloatArray) -> FloatArray:
    return _AMBIENT + sum(strength * np.maximum(normals @ light, 0) for light, strength in _LIGHTS)


def _front(corners: FloatArray, shape: tuple[int, int]) -> NDArray[np.int64]:
    """Index of the triangle that each sample shows, -1 for none."""
    planes = _planes(corners)
    triangle, x, y = _covering_boxes(corners, shape)
    for edge in range(3):
        inside = _evaluate(planes[triangle, edge], x, y) >= 0
        triangle, x, y = triangle[inside], x[inside], y[inside]
    nearness = np.einsum("ti,tij->tj", 1 / corners[..., 2], planes)  # 1 / depth is linear in the picture
    order = np.argsort(_evaluate(nearness[triangle], x, y))
    front = np.full(shape, -1)
    front[y[order], x[order]] = triangle[order]  # the last one written, the nearest, stays
    return front


def _planes(corners: FloatArray) -> FloatArray:
    """Factors of (x, y, 1) that give each corner's weight at a sample, shape (n, 3, 3)."""
    flat = corners.transpose(0, 2, 1).copy()
    flat[:, 2] = 1.0
    return np.asarray(np.linalg.inv(flat), dtype=np.float64)


def _evaluate(planes: FloatArray, x: NDArray[np.int64], y: NDArray[np.int64]) -> FloatArray:
    return planes[:, 0] * (x + 0.5) + planes[:, 1] * (y + 0.5) + planes[:, 2]


def _covering_boxes(corners: FloatArray, shape: tuple[int, int]) -> tuple[NDArray[np.int64], ...]:
    """Every sample (triangle, x, y) in the box around every triangle."""
    limits = np.array(shape[::-1])
    low = np.clip(np.ceil(corners[..., :2].min(axis=1) - 0.5), 0, limits).astype(int)
    high = np.clip(np.floor(corners[..., :2].max(axis=1) + 0.5), low, limits).astype(int)
    width, height = (high - low).T
    count = width * height
    triangle = np.repeat(np.arange(len(corners)), count)
    rank = np.arange(len(triangle)) - np.repeat(np.cumsum(count) - count, count)
    return triangle, low[triangle, 0] + rank % width[triangle], low[triangle, 1] + rank // width[triangle]
