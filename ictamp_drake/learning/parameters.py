"""k as networks see it: normalised by the target's size, and as a place from which the objects are looked at.

u, the normalised k: (x, y, z) run over the target from -1 to 1, and yaw stays in radians. Pick: over the box along each
of U's axes. Place: over the receptacle's top face, and in height from 2 mm inside it to 22 mm above.
"""

import math
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor

from ictamp_drake.learning.clearance import OPENING, PARTS, Blocks, clearances
from ictamp_drake.observation.state_matrix import ROWS, SCHEMA

PLACE_HEIGHT = (0.010, 0.012)
"""Middle and half of the range of a placement's height above the top face [m]."""
SEEN = 12 + PARTS
"""Numbers of an object as seen from k."""
FEATURES = 24
"""Numbers of k itself."""
GLIMPSES = 2
"""Ways in which the target is looked at when k is not known."""
_DISTANCE = 0.2
"""Scale of distances as seen from k [m]."""

_SCALES = torch.from_numpy(SCHEMA.scales.astype(np.float32))
_BASE, _TARGET, _HAND, _BOX, _SUPPORT = (SCHEMA.group(name) for name in ("base", "target", "hand", "box", "support"))
_REACH = float(SCHEMA.scales[_BASE][0])
"""Scale of distances from the arm's base [m]."""


def scale_rows(matrix: Tensor) -> Tensor:
    """Matrices in the scale that networks take them in, shape (..., D) -> (..., D)."""
    return matrix / _SCALES


def ranges(skill: str, matrix: Tensor) -> tuple[Tensor, Tensor]:
    """Middle and half of the range of (x, y, z) [m], each of shape (n, 3), from matrices of shape (n, 8, D)."""
    row = matrix[:, 0 if skill == "pick" else 2]
    half = sides(row) / 2
    middle = torch.zeros_like(half)
    if skill == "place":
        middle[:, 2], half[:, 2] = PLACE_HEIGHT
    return middle, half


def normalize_parameter(skill: str, matrix: Tensor, k: Tensor) -> Tensor:
    """u of k, shape (n, ..., 4) -> (n, ..., 4)."""
    middle, half = _align(skill, matrix, k)
    return torch.cat([(k[..., :3] - middle) / half, k[..., 3:]], dim=-1)


def parameter(skill: str, matrix: Tensor, u: Tensor) -> Tensor:
    """k of u, shape (n, ..., 4) -> (n, ..., 4)."""
    middle, half = _align(skill, matrix, u)
    return torch.cat([u[..., :3] * half + middle, wrap_angle(u[..., 3:])], dim=-1)


def _align(skill: str, matrix: Tensor, like: Tensor) -> list[Tensor]:
    return [each.reshape(len(matrix), *[1] * (like.dim() - 2), 3) for each in ranges(skill, matrix)]


def wrap_angle(angle: Tensor) -> Tensor:
    """The same angle in [-π, π)."""
    return torch.remainder(angle + math.pi, 2 * math.pi) - math.pi


def features(skill: str, matrix: Tensor, k: Tensor) -> Tensor:
    """Features of k itself, shape (n, 8, D), (n, 4) -> (n, 24).

    u; the position, and the distances to the target's faces, in a scale that is fine near zero, where a millimetre
    decides; yaw, and yaw against the directions of a box's faces; and where the hand is as seen from the arm's base.
    """
    middle, half = ranges(skill, matrix)
    offset, yaw = k[:, :3] - middle, k[:, 3:]
    distances = [_fine(k[:, :3], 0.001), _fine(half - offset, 0.005), _fine(half + offset, 0.005)]
    margins = _fine(_margins(skill, matrix, k), 0.002)
    angles = [yaw.cos(), yaw.sin(), (4 * yaw).cos(), (4 * yaw).sin()]
    return torch.cat([offset / half, *distances, margins, *angles, _reach(skill, matrix, k)], dim=-1)


def _fine(distance: Tensor, scale: float) -> Tensor:
    return torch.asinh(distance / scale) / 2


def _margins(skill: str, matrix: Tensor, k: Tensor) -> Tensor:
    """Overhang of the box beyond the open fingers, as grasped and if grasped in its middle (pick).

    Or how far it stands out of the receptacle's top face along its x and y axes (place); shape (n, 2) [m].
    """
    cos, sin = k[:, 3].cos().abs(), k[:, 3].sin().abs()
    half = sides(matrix) / 2
    if skill == "pick":
        reach = half[:, 0, 0] * sin + half[:, 0, 1] * cos - OPENING / 2
        offset = (k[:, 1] * k[:, 3].cos() - k[:, 0] * k[:, 3].sin()).abs()
        return torch.stack([reach + offset, reach], dim=-1)
    held, place = half[:, 1], half[:, 2]
    x = k[:, 0].abs() + held[:, 0] * cos + held[:, 1] * sin - place[:, 0]
    y = k[:, 1].abs() + held[:, 0] * sin + held[:, 1] * cos - place[:, 1]
    return torch.stack([x, y], dim=-1)


def _reach(skill: str, matrix: Tensor, k: Tensor) -> Tensor:
    """Reach of G: position in B, horizontal distance from the base, heading relative to it, shape (n, 6)."""
    row = matrix[:, 0 if skill == "pick" else 2]
    hand = _hand(skill, matrix)
    p_K = _turn_about_z(hand.position, k[:, 3]) + k[:, :3]
    if skill == "place":
        p_K = p_K + sides(row) / 2 * p_K.new_tensor([0.0, 0.0, 1.0])  # from the receptacle's top to its middle
    R_BK, p_BK = axes(row[:, _BASE]), row[:, _BASE][:, :3]
    p_B = p_BK + _times(R_BK, p_K)
    heading = _times(R_BK, _turn_about_z(hand.heading, k[:, 3]))
    distance = p_B[:, :2].norm(dim=-1, keepdim=True)
    x, y = (p_B[:, :2] / distance.clamp(min=0.05)).T
    direction = [x * heading[:, 0] + y * heading[:, 1], x * heading[:, 1] - y * heading[:, 0]]
    return torch.cat([p_B / _REACH, distance / _REACH, torch.stack(direction, dim=-1)], dim=-1)


class _Hand(NamedTuple):
    """G as seen from k: position and direction of its x axis, each of shape (n, 3)."""

    position: Tensor
    heading: Tensor


def _hand(skill: str, matrix: Tensor) -> _Hand:
    """The hand when it grasps, or when it lets go."""
    if skill == "pick":
        origin = torch.zeros_like(matrix[:, 0, :3])
        return _Hand(origin, origin + origin.new_tensor([1.0, 0.0, 0.0]))
    R_GU, p_GU = axes(matrix[:, 1, _HAND]), matrix[:, 1, _HAND][:, :3]
    p_UG = -(R_GU * p_GU[..., None]).sum(dim=-2)
    bottom = sides(matrix[:, 1]) / 2 * p_UG.new_tensor([0.0, 0.0, 1.0])
    return _Hand(p_UG + bottom, R_GU[:, 0])


def _times(R: Tensor, vectors: Tensor) -> Tensor:
    """R v of many small R, shape (n, 3, 3), (n, 3) -> (n, 3), which torch's product of matrices is slow at."""
    return (R * vectors[:, None]).sum(dim=-1)


def _turn_about_z(vectors: Tensor, yaw: Tensor) -> Tensor:
    """Vectors, shape (n, 3), turned about z by angles of shape (n,)."""
    (x, y, z), cos, sin = vectors.T, yaw.cos(), yaw.sin()
    return torch.stack([cos * x - sin * y, sin * x + cos * y, z], dim=-1)


def sides(rows: Tensor) -> Tensor:
    """Sides of boxes and supports along U's axes [m], shape (..., D) -> (..., 3)."""
    return rows[..., _BOX] + rows[..., _SUPPORT]


def axes(pose: Tensor) -> Tensor:
    """Rotation matrix of nine numbers of a pose, shape (..., 9) -> (..., 3, 3)."""
    x, y = pose[..., 3:6], pose[..., 6:9]
    return torch.stack([x, y, torch.linalg.cross(x, y)], dim=-1)


def network_inputs(skill: str, matrix: Tensor, k: Tensor) -> tuple[Tensor, Tensor]:
    """Inputs of a network that sees k: rows, (n, 8, D + SEEN), and features of k, (n, FEATURES)."""
    return torch.cat([scale_rows(matrix), objects_seen_from(skill, matrix, k)], dim=-1), features(skill, matrix, k)


def blind_network_inputs(skill: str, matrix: Tensor) -> tuple[Tensor, Tensor]:
    """Inputs of a network that does not see k: the matrix, and the view from the middle of the target.

    With the hand along the target and across it; rows, (n, 8, D + 2 SEEN), and numbers, (n, 2 FEATURES).
    """
    count = len(matrix)
    yaw = torch.arange(GLIMPSES) * math.pi / GLIMPSES
    k = torch.cat([matrix.new_zeros(GLIMPSES, 3), yaw[:, None]], dim=-1).repeat(count, 1)
    several = matrix.repeat_interleave(GLIMPSES, 0)
    seen = objects_seen_from(skill, several, k).reshape(count, GLIMPSES, ROWS, SEEN).transpose(1, 2).flatten(2)
    return torch.cat([scale_rows(matrix), seen], dim=-1), features(skill, several, k).reshape(count, -1)


def objects_seen_from(skill: str, matrix: Tensor, k: Tensor) -> Tensor:
    """All objects as seen from k, shape (n, 8, D), (n, 4) -> (n, 8, 16).

    Pose in the frame at k's position that is turned by its yaw; the distance of that position from each pair of the
    object's faces, negative between them, in a fine scale; and how far the hand and the box keep from the object there.
    """
    p, x, y = torch.split(matrix[..., _TARGET].movedim(-1, 0).contiguous(), 3)
    half = (sides(matrix) / 2).movedim(-1, 0).contiguous()
    p_KO = k.T[:3, :, None] - p
    p_O = (torch.stack([x, y, torch.linalg.cross(x, y, dim=0)]) * p_KO).sum(dim=1)
    cos, sin = k[:, 3:].cos(), k[:, 3:].sin()
    along, across, up = torch.stack([-p_KO, x, y], dim=1)
    position, heading, _ = turned = torch.stack([cos * along + sin * across, cos * across - sin * along, up], dim=1)
    objects = Blocks(position, heading[:2], half)
    hand = _hand(skill, matrix)
    apart = clearances(hand.position.T, hand.heading.T[:2], _moved_box(skill, objects), objects)
    parts = [position / _DISTANCE, turned[1:].flatten(0, 1), _fine(p_O.abs() - half, 0.01), _fine(apart, 0.005)]
    return torch.cat(parts).movedim(0, -1)


def _moved_box(skill: str, objects: Blocks) -> Blocks:
    """The box that the action moves: where it stands (pick), or at k, the middle of its bottom face (place)."""
    if skill == "pick":
        return Blocks(*(each[..., 0] for each in objects))
    half = objects.half[..., 1]
    up, ahead = half.new_tensor([[0.0], [0.0], [1.0]]), half.new_tensor([[1.0], [0.0]])
    return Blocks(half * up, ahead.expand(2, half.shape[1]), half)
