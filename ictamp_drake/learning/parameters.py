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
SEEN = 9
"""Numbers of an object as seen from k."""
FEATURES = 7
"""Numbers of k itself."""
_DISTANCE = 0.2
"""Scale of distances as seen from k [m]."""

_TARGET, _BOX, _SUPPORT = SCHEMA.group("target"), SCHEMA.group("box"), SCHEMA.group("support")
_TARGET_SCALE, _BOX_SCALE, _SUPPORT_SCALE = (float(SCHEMA.scales[group][0]) for group in (_TARGET, _BOX, _SUPPORT))


def ranges(skill: str, matrix: Tensor) -> tuple[Tensor, Tensor]:
    """Middle and half of the range of (x, y, z) [m], each of shape (n, 3), from matrices of shape (n, 8, D)."""
    row = matrix[:, 0 if skill == "pick" else 2]
    half = (row[:, _BOX] * _BOX_SCALE + row[:, _SUPPORT] * _SUPPORT_SCALE) / 2
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


def features(u: Tensor, yaw: Tensor) -> Tensor:
    """k itself, shape (n, 3) and (n,) -> (n, 7): the normalised position, the direction, and that of a box's faces."""
    angles = torch.stack([yaw.cos(), yaw.sin(), (4 * yaw).cos(), (4 * yaw).sin()], dim=-1)
    return torch.cat([u[:, :3], angles], dim=-1)


def seen_from(matrix: Tensor, k: Tensor) -> Tensor:
    """Poses of all objects in the frame at k's position that is turned by its yaw, (n, 8, D), (n, 4) -> (n, 8, 9)."""
    target = matrix[..., _TARGET]
    position = target[..., :3] * _TARGET_SCALE - k[:, None, :3]
    vectors = torch.cat([position / _DISTANCE, target[..., 3:]], dim=-1).reshape(*target.shape[:-1], 3, 3)
    cos, sin = k[:, 3, None, None].cos(), k[:, 3, None, None].sin()
    x, y = vectors[..., 0], vectors[..., 1]
    return torch.stack([cos * x + sin * y, cos * y - sin * x, vectors[..., 2]], dim=-1).flatten(-2)
