"""Surfaces as triangles of shape (n, 3, 3), in the frame of the solid [m], counterclockwise seen from outside."""

import base64
import json
from collections.abc import Sequence
from functools import cache
from pathlib import Path

import numpy as np

from ictamp_drake.core.types import FloatArray

SECTIONS = 32
"""Number of sections of round solids about their axis."""

_CORNERS = np.array(
    [[-1, -1, -1], [1, -1, -1], [1, 1, -1], [-1, 1, -1], [-1, -1, 1], [1, -1, 1], [1, 1, 1], [-1, 1, 1]]
)
_FACES = np.array([[0, 3, 2, 1], [4, 5, 6, 7], [0, 1, 5, 4], [1, 2, 6, 5], [2, 3, 7, 6], [3, 0, 4, 7]])


def box(size: FloatArray) -> FloatArray:
    """Triangles of a box about the origin with sides `size` [m], shape (3,)."""
    return _split_quads(_CORNERS[_FACES] * (np.asarray(size) / 2))


def cylinder(radius: float, length: float) -> FloatArray:
    """Triangles of a cylinder about the origin along z."""
    half = length / 2
    return _revolve(np.array([[0.0, -half], [radius, -half], [radius, half], [0.0, half]]))


def capsule(radius: float, length: float) -> FloatArray:
    """Triangles of a cylinder along z between two hemispheres; a sphere if `length` is 0."""
    angles = np.linspace(-np.pi / 2, np.pi / 2, SECTIONS // 2 + 1)
    profile = radius * np.stack([np.cos(angles), np.sin(angles)], axis=1)
    middle = len(profile) // 2
    ends = profile[: middle + 1] - [0.0, length / 2], profile[middle:] + [0.0, length / 2]
    return _revolve(np.concatenate(ends))


def _revolve(profile: FloatArray) -> FloatArray:
    """Revolve a profile (distance from the z axis, z), from its lowest to its highest point, about the axis."""
    angles = np.linspace(0, 2 * np.pi, SECTIONS + 1)
    x, y = (np.outer(profile[:, 0], turn) for turn in (np.cos(angles), np.sin(angles)))
    points = np.stack([x, y, np.broadcast_to(profile[:, 1:], x.shape)], axis=-1)
    quads = np.stack([points[:-1, :-1], points[:-1, 1:], points[1:, 1:], points[1:, :-1]], axis=2)
    return _split_quads(quads.reshape(-1, 4, 3))


def _split_quads(quads: FloatArray) -> FloatArray:
    """Split each quadrilateral into two triangles, shape (n, 4, 3) -> (2 n, 3, 3)."""
    return quads[:, [[0, 1, 2], [0, 2, 3]]].reshape(-1, 3, 3)


def polygons(faces: Sequence[FloatArray]) -> FloatArray:
    """Triangles of convex polygons with corners of shape (k, 3)."""
    fans = [np.stack([np.broadcast_to(each[0], each[1:-1].shape), each[1:-1], each[2:]], axis=1) for each in faces]
    return np.concatenate([np.empty((0, 3, 3)), *fans])


@cache
def read_gltf(path: Path) -> tuple[FloatArray, FloatArray]:
    """Read the triangles and the color (red, green, blue in [0, 1]) of a file that `tools.gltf` wrote."""
    document = json.loads(path.read_text(encoding="utf-8"))
    data = base64.b64decode(document["buffers"][0]["uri"].partition(",")[2])
    (primitive,) = document["meshes"][0]["primitives"]
    points, indices = (
        np.frombuffer(
            data, kind, accessor["count"] * width, document["bufferViews"][accessor["bufferView"]]["byteOffset"]
        )
        for accessor, kind, width in (
            (document["accessors"][primitive["attributes"]["POSITION"]], "<f4", 3),
            (document["accessors"][primitive["indices"]], "<u2", 1),
        )
    )
    x, y, z = np.moveaxis(points.reshape(-1, 3)[indices.reshape(-1, 3)].astype(float), -1, 0)
    color = document["materials"][primitive["material"]]["pbrMetallicRoughness"]["baseColorFactor"]
    return np.stack([x, -z, y], axis=-1), np.array(color[:3])  # glTF's y axis is up
