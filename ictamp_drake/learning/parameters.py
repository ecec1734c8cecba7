"""k as networks see it: normalised by the target's size, and as a place from which the objects are looked at.

u, the normalised k: (x, y, z) run over the target from -1 to 1, and yaw stays in radians. Pick: over the box along each
of U's axes. Place: over the receptacle's top face, and in height from 2 mm inside it to 22 mm above.
"""

import math

import torch
from torch import Tensor

from ictamp_drake.world.observation import SCHEMA

PLACE_HEIGHT = (0.010, 0.012)
"""Middle and half of the range of a placement's height above the top face [m]."""
SEEN = 12
"""Numbers of an object as seen from k."""
FEATURES = 22
"""Numbers of k itself."""
_DISTANCE = 0.2
"""Scale of distances as seen from k [m]."""

_BASE, _TARGET, _BOX, _SUPPORT = (SCHEMA.group(name) for name in ("base", "target", "box", "support"))
_BASE_SCALE, _TARGET_SCALE, _BOX_SCALE, _SUPPORT_SCALE = (
    float(SCHEMA.scales[group][0]) for group in (_BASE, _TARGET, _BOX, _SUPPORT)
)


def ranges(skill: str, matrix: Tensor) -> tuple[Tensor, Tensor]:
    """Middle and half of the range of (x, y, z) [m], each of shape (n, 3), from matrices of shape (n, 8, D)."""
    row = matrix[:, 0 if skill == "pick" else 2]
    half = sides(row) / 2
    middle = torch.zeros_like(half)
    if skill == "place":
        middle[:, 2], half[:, 2] = PLACE_HEIGHT
    return middle, half


def normalised(skill: str, matrix: Tensor, k: Tensor) -> Tensor:
    """u of k, shape (n, ..., 4) -> (n, ..., 4)."""
    middle, half = _aligned(skill, matrix, k)
    return torch.cat([(k[..., :3] - middle) / half, k[..., 3:]], dim=-1)


def parameter(skill: str, matrix: Tensor, u: Tensor) -> Tensor:
    """k of u, shape (n, ..., 4) -> (n, ..., 4)."""
    middle, half = _aligned(skill, matrix, u)
    return torch.cat([u[..., :3] * half + middle, wrapped(u[..., 3:])], dim=-1)


def _aligned(skill: str, matrix: Tensor, like: Tensor) -> list[Tensor]:
    return [each.reshape(len(matrix), *[1] * (like.dim() - 2), 3) for each in ranges(skill, matrix)]


def wrapped(angle: Tensor) -> Tensor:
    """The same angle in [-π, π)."""
    return torch.remainder(angle + math.pi, 2 * math.pi) - math.pi


def features(skill: str, matrix: Tensor, k: Tensor) -> Tensor:
    """What is to be known of k itself, shape (n, 8, D), (n, 4) -> (n, 22).

    u; the position, and the distances to the target's faces, in a scale that is fine near zero, where a millimetre
    decides; yaw, and yaw against the directions of a box's faces; and where k is as seen from the arm's base.
    """
    middle, half = ranges(skill, matrix)
    offset, yaw = k[:, :3] - middle, k[:, 3:]
    distances = [_fine(k[:, :3], 0.001), _fine(half - offset, 0.005), _fine(half + offset, 0.005)]
    angles = [yaw.cos(), yaw.sin(), (4 * yaw).cos(), (4 * yaw).sin()]
    return torch.cat([offset / half, *distances, *angles, _reach(skill, matrix, k)], dim=-1)


def _fine(distance: Tensor, scale: float) -> Tensor:
    return torch.asinh(distance / scale) / 2


def _reach(skill: str, matrix: Tensor, k: Tensor) -> Tensor:
    """Position in B, horizontal distance from the base, and the direction of yaw against the way to it, (n, 6)."""
    row = matrix[:, 0 if skill == "pick" else 2]
    rise = 0.0 if skill == "pick" else sides(row)[:, 2:] / 2  # from the middle of the receptacle to its top
    p, R = row[:, _BASE][:, :3] * _BASE_SCALE, _axes(row[:, _BASE])
    p_B = p + R[..., 0] * k[:, :1] + R[..., 1] * k[:, 1:2] + R[..., 2] * (k[:, 2:3] + rise)
    distance = p_B[:, :2].norm(dim=-1, keepdim=True)
    x, y = (p_B[:, :2] / distance.clamp(min=0.05)).T
    turned = R[..., 0] * k[:, 3:].cos() + R[..., 1] * k[:, 3:].sin()
    direction = [x * turned[:, 0] + y * turned[:, 1], x * turned[:, 1] - y * turned[:, 0]]
    return torch.cat([p_B / _BASE_SCALE, distance / _BASE_SCALE, torch.stack(direction, dim=-1)], dim=-1)


def sides(rows: Tensor) -> Tensor:
    """Sides of boxes and supports along U's axes [m], shape (..., D) -> (..., 3)."""
    return rows[..., _BOX] * _BOX_SCALE + rows[..., _SUPPORT] * _SUPPORT_SCALE


def _axes(pose: Tensor) -> Tensor:
    """Rotation matrix of nine numbers of a pose, shape (..., 9) -> (..., 3, 3)."""
    x, y = pose[..., 3:6], pose[..., 6:9]
    return torch.stack([x, y, torch.linalg.cross(x, y)], dim=-1)


def with_k(skill: str, matrix: Tensor, k: Tensor) -> tuple[Tensor, Tensor]:
    """What a network is given that sees k too: rows, (n, 8, D + SEEN), and numbers of k itself, (n, FEATURES)."""
    return torch.cat([matrix, seen_from(matrix, k)], dim=-1), features(skill, matrix, k)


def seen_from(matrix: Tensor, k: Tensor) -> Tensor:
    """All objects as seen from k, shape (n, 8, D), (n, 4) -> (n, 8, 12).

    Pose in the frame at k's position that is turned by its yaw, and the distance of that position from each pair of
    the object's faces, negative between them, in a fine scale.
    """
    target = matrix[..., _TARGET]
    R, p_KO = _axes(target), k[:, None, :3] - target[..., :3] * _TARGET_SCALE
    vectors = torch.stack([-p_KO / _DISTANCE, R[..., 0], R[..., 1]], dim=-2)
    cos, sin = k[:, 3, None, None].cos(), k[:, 3, None, None].sin()
    x, y = vectors[..., 0], vectors[..., 1]
    pose = torch.stack([cos * x + sin * y, cos * y - sin * x, vectors[..., 2]], dim=-1).flatten(-2)
    p_O = (R * p_KO[..., None]).sum(dim=-2)
    return torch.cat([pose, _fine(p_O.abs() - sides(matrix) / 2, 0.01)], dim=-1)
