"""Equivalent descriptions of a situation: what is learned from one of them holds for all.

The x axis of the upright frame U of a box or a support may point out of any of its four sides; quarter turns about z
change the numbers and nothing else. The arm also does on its right what it does on its left, except for the limits of
its last joint, which are not symmetric: the mirror image nearly always holds.
"""

from dataclasses import replace

import torch
from torch import Tensor

from ictamp_drake.learning.batches import Batch
from ictamp_drake.learning.parameters import wrap_angle
from ictamp_drake.observation.state_matrix import ROWS, SCHEMA

_BASE, _TARGET, _HAND = (SCHEMA.group(name) for name in ("base", "target", "hand"))
_SIDES = (SCHEMA.group("box"), SCHEMA.group("support"))
_QUARTER = torch.pi / 2


def vary_description(skill: str, batch: Batch, generator: torch.Generator) -> Batch:
    """Draw another description of each attempt at a skill."""
    batch = turn_frames(skill, batch, torch.randint(4, (len(batch), ROWS), generator=generator))
    image = mirror(batch)
    flipped = torch.rand((len(batch), 1), generator=generator) < 0.5
    return replace(
        batch,
        matrix=torch.where(flipped[..., None], image.matrix, batch.matrix),
        k=torch.where(flipped, image.k, batch.k),
        moved=torch.where(flipped, image.moved, batch.moved),
    )


def turn_frames(skill: str, batch: Batch, turns: Tensor) -> Batch:
    """Turn the frames of all objects about their z axes, by numbers of quarter turns of shape (n, 8)."""
    matrix, angle = batch.matrix.clone(), turns * _QUARTER
    for group in (_BASE, _TARGET, _HAND):
        p, x, y = _split(matrix[..., group])
        cos, sin = angle.cos()[..., None], angle.sin()[..., None]
        matrix[..., group] = torch.cat([p, cos * x + sin * y, cos * y - sin * x], dim=-1)
    odd = (turns % 2 == 1)[..., None]
    for sides in _SIDES:
        matrix[..., sides] = torch.where(odd, matrix[..., sides][..., [1, 0, 2]], matrix[..., sides])
    target = angle[:, 0 if skill == "pick" else 2]
    seen = [_turn_about_z(vectors, -target[:, None]) for vectors in _split(matrix[..., _TARGET])]
    matrix[..., _TARGET] = torch.cat(seen, dim=-1)
    held = angle[:, 1]
    of_k, of_moved = (-target, 0.0 * target) if skill == "pick" else (held - target, held - target)
    return replace(
        batch, matrix=matrix, k=_turn_poses(batch.k, -target, of_k), moved=_turn_poses(batch.moved, -target, of_moved)
    )


def mirror(batch: Batch) -> Batch:
    """Mirror image in the vertical plane that contains the x axis of the arm's base frame."""
    signs = batch.matrix.new_ones(SCHEMA.width)
    for group in (_BASE, _TARGET, _HAND):
        signs[group] = signs.new_tensor([1, -1, 1, 1, -1, 1, -1, 1, -1])
    of_k = signs.new_tensor([1, -1, 1, -1])
    return replace(batch, matrix=batch.matrix * signs, k=batch.k * of_k, moved=batch.moved * of_k)


def _split(pose: Tensor) -> tuple[Tensor, Tensor, Tensor]:
    """Position and two axes, shape (..., 9) -> three of (..., 3)."""
    return pose[..., :3], pose[..., 3:6], pose[..., 6:]


def _turn_poses(pose: Tensor, about: Tensor, turn: Tensor) -> Tensor:
    """Turn the positions of poses (x, y, z, yaw), shape (n, 4), about z, and add another angle to their yaw."""
    return torch.cat([_turn_about_z(pose[:, :3], about), wrap_angle(pose[:, 3:] + turn[:, None])], dim=-1)


def _turn_about_z(vectors: Tensor, angle: Tensor) -> Tensor:
    """Turn vectors, shape (..., 3), about z by angles of shape (...)."""
    x, y, z = vectors.unbind(-1)
    cos, sin = angle.cos(), angle.sin()
    return torch.stack([cos * x - sin * y, sin * x + cos * y, z], dim=-1)
