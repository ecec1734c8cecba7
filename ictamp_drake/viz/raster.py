"""Pictures of triangles, rendered with numpy only so that they do not depend on a machine's graphics drivers."""

import numpy as np
from numpy.typing import NDArray

from ictamp_drake.core.types import FloatArray

_SAMPLES = 2
"""Samples per pixel along x and along y, averaged for smooth edges."""

_LIGHTS = ((np.array([0.35, 0.35, 0.87]), 0.55), (np.array([0.75, -0.6, 0.28]), 0.3))
"""Directions to the lights in W, and their strengths."""

_AMBIENT = 0.4

_EDGE_ON = 1e-6
"""Minimum distance of a triangle's plane from the eye [m]; nearer ones are seen edge-on and left out."""


class Camera:
    """A pinhole camera without roll.

    Args:
        eye, target: Positions of the camera and of the point that it looks at, in W [m], shape (3,).
        field_of_view: Vertical field of view [rad].
        width, height: Size of the picture [pixels].
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


def render(triangles: FloatArray, colors: FloatArray, camera: Camera, background: FloatArray) -> NDArray[np.uint8]:
    """Render triangles, all in front of the camera; those that face away from it are left out.

    Args:
        triangles: Corners in W [m], counterclockwise seen from outside, shape (n, 3, 3).
        colors: Red, green, blue in [0, 1], shape (n, 3).
        camera: Camera that takes the picture.
        background: Colors of the background, evenly spaced from top to bottom, shape (m, 3).

    Returns:
        Picture of shape (height, width, 3).
    """
    normals = np.cross(triangles[:, 1] - triangles[:, 0], triangles[:, 2] - triangles[:, 0])
    normals /= np.maximum(np.linalg.norm(normals, axis=1, keepdims=True), 1e-12)
    seen = np.sum(normals * (camera.eye - triangles[:, 0]), axis=1) > _EDGE_ON
    shaded = colors[seen] * _brightness(normals[seen])[:, None]
    rows = np.linspace(0, len(background) - 1, camera.shape[0])
    backdrop = np.stack([np.interp(rows, np.arange(len(background)), channel) for channel in background.T], axis=1)
    front = _front(camera.project(triangles[seen]), camera.shape)
    palette = np.concatenate([shaded, backdrop])
    shown = np.where(front < 0, len(shaded) + np.arange(len(front))[:, None], front)
    samples = [palette.take(shown[i::_SAMPLES, j::_SAMPLES], axis=0) for i in range(_SAMPLES) for j in range(_SAMPLES)]
    return np.round(255 * np.clip(sum(samples) / len(samples), 0, 1)).astype(np.uint8)


def silhouette(triangles: FloatArray, camera: Camera) -> NDArray[np.bool_]:
    """Mask of the pixels that show triangles if nothing else is there, shape (height, width); see `render`."""
    covered = _front(camera.project(triangles), camera.shape) >= 0
    height, width = camera.shape
    return np.any(covered.reshape(height // _SAMPLES, _SAMPLES, width // _SAMPLES, _SAMPLES), axis=(1, 3))


def _brightness(normals: FloatArray) -> FloatArray:
    return _AMBIENT + sum(strength * np.maximum(normals @ light, 0) for light, strength in _LIGHTS)


def _front(corners: FloatArray, shape: tuple[int, int]) -> NDArray[np.int64]:
    """Index of the triangle that each sample shows, -1 for none."""
    planes = _planes(corners)
    triangle, y = _rows(corners, shape[0])
    first, end = _spans(planes[triangle], y, shape[1])
    count = end - first
    row = np.repeat(np.arange(len(y)), count)
    x = np.arange(len(row)) - np.repeat(np.cumsum(count) - count - first, count)
    slope, rest = _line_on_row(np.einsum("ti,tij->tj", 1 / corners[..., 2], planes)[triangle], y)
    nearness = slope[row] * (x + 0.5) + rest[row]  # 1 / depth is linear in the picture
    place = y[row] * shape[1] + x
    nearest = np.full(shape[0] * shape[1], -np.inf)
    np.maximum.at(nearest, place, nearness)
    shown = nearness == nearest[place]
    front = np.full(len(nearest), -1)
    front[place[shown]] = triangle[row[shown]]
    return front.reshape(shape)


def _planes(corners: FloatArray) -> FloatArray:
    """Coefficients of (x, y, 1) that give each corner's weight at a sample, shape (n, 3, 3)."""
    flat = corners.transpose(0, 2, 1).copy()
    flat[:, 2] = 1.0
    return np.asarray(np.linalg.inv(flat), dtype=np.float64)


def _rows(corners: FloatArray, height: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """Pairs of a triangle and a row of samples that it may cover, as two index arrays."""
    low = np.clip(np.ceil(corners[..., 1].min(axis=1) - 0.5), 0, height).astype(int)
    high = np.clip(np.floor(corners[..., 1].max(axis=1) + 0.5), low, height).astype(int)
    count = high - low
    triangle = np.repeat(np.arange(len(corners)), count)
    return triangle, np.arange(len(triangle)) - np.repeat(np.cumsum(count) - count - low, count)


def _spans(planes: FloatArray, y: NDArray[np.int64], width: int) -> tuple[NDArray[np.int64], NDArray[np.int64]]:
    """First sample inside the triangle on each row, and the one after the last; equal when none is inside.

    Args:
        planes: Coefficients of each row's triangle, shape (n, 3, 3).
        y: Rows, shape (n,).
        width: Width of the picture [samples].
    """
    slope, rest = _line_on_row(planes, y)
    with np.errstate(divide="ignore", invalid="ignore"):
        edge = -rest / slope
    outside = np.where((slope == 0) & (rest < 0), np.inf, -np.inf)
    low = np.where(slope > 0, edge, outside).max(axis=1)
    high = np.where(slope < 0, edge, np.inf).min(axis=1)
    first = np.clip(np.ceil(low - 0.5), 0, width)
    return first.astype(int), np.clip(np.floor(high - 0.5) + 1, first, width).astype(int)


def _line_on_row(planes: FloatArray, y: NDArray[np.int64]) -> tuple[FloatArray, FloatArray]:
    """Restrict planes (..., 3) to a row of samples: slope and value at the left end, shape (...) each."""
    middle = (y + 0.5).reshape(-1, *[1] * (planes.ndim - 2))
    return planes[..., 0], planes[..., 1] * middle + planes[..., 2]
