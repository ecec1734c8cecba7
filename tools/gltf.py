"""glTF files with embedded buffers, from meshes of one color."""

import base64
import json
from typing import Any

import numpy as np

from ictamp_drake.models.sdf_text import Color
from tools.surface import Mesh

_FLOAT, _UNSIGNED_SHORT = 5126, 5123
_VERTICES, _INDICES = 34962, 34963


def gltf(mesh: Mesh, color: Color, roughness: float) -> str:
    """Text of a glTF 2.0 file with one mesh.

    The y axis of glTF points up, so Drake reads (x, z, -y) as the point (x, y, z) of a link.

    Args:
        mesh: Mesh with at most 65,536 vertices.
        color: Red, green, blue in [0, 1].
        roughness: Roughness of the surface in [0, 1].
    """
    points = _turn_y_up(mesh.vertices, 5)
    arrays = [points, _turn_y_up(mesh.normals, 3), mesh.triangles.astype("<u2").ravel()]
    sizes = [array.nbytes for array in arrays]
    blob = b"".join(array.tobytes() for array in arrays)
    views = [
        {"buffer": 0, "byteOffset": sum(sizes[:i]), "byteLength": size, "target": target}
        for i, (size, target) in enumerate(zip(sizes, (_VERTICES, _VERTICES, _INDICES), strict=True))
    ]
    box = {"min": points.min(axis=0).tolist(), "max": points.max(axis=0).tolist()}
    accessors: list[dict[str, Any]] = [
        {"bufferView": 0, "count": len(points), "componentType": _FLOAT, "type": "VEC3", **box},
        {"bufferView": 1, "count": len(points), "componentType": _FLOAT, "type": "VEC3"},
        {"bufferView": 2, "count": arrays[2].size, "componentType": _UNSIGNED_SHORT, "type": "SCALAR"},
    ]
    look = {"baseColorFactor": [*color, 1.0], "metallicFactor": 0.0, "roughnessFactor": roughness}
    document = {
        "asset": {"version": "2.0"},
        "scene": 0,
        "scenes": [{"nodes": [0]}],
        "nodes": [{"mesh": 0}],
        "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "NORMAL": 1}, "indices": 2, "material": 0}]}],
        "materials": [{"pbrMetallicRoughness": look}],
        "accessors": accessors,
        "bufferViews": views,
        "buffers": [{"byteLength": len(blob), "uri": _data_uri(blob)}],
    }
    return json.dumps(document) + "\n"


def _data_uri(blob: bytes) -> str:
    return f"data:application/octet-stream;base64,{base64.b64encode(blob).decode()}"


def _turn_y_up(vectors: np.ndarray, digits: int) -> np.ndarray:
    return np.round(vectors[:, [0, 2, 1]] * (1.0, 1.0, -1.0), digits).astype("<f4") + np.float32(0.0)
