"""How far the hand and the held box keep from every object at k, by the separating axis theorem.

Hand and box come down to k from above, so what counts is the free space beside or below each of them. Everything is
seen in the frame at k, whose z axis points up, and taken for upright boxes.
"""

from typing import NamedTuple

import torch
from torch import Tensor

from ictamp_drake.models.constants import GRIPPER_MAX_WIDTH

FINGER = (0.011, 0.0135, -0.0095)
"""Half sides along x and y of an open finger, and the height of its tip in G with z up [m]."""
PALM = (0.0195, 0.101, 0.037)
WRIST = (0.075, 0.075, 0.105)
PARTS = 4
"""Fingers, palm, wrist, box."""


class Blocks(NamedTuple):
    """Upright boxes as seen from k.

    Attributes:
        centre: shape (..., 3) [m].
        heading: direction of the x axis in the horizontal plane, shape (..., 2).
        half: half sides, shape (..., 3) [m].
    """

    centre: Tensor
    heading: Tensor
    half: Tensor


def clearances(hand: Tensor, heading: Tensor, box: Blocks, objects: Blocks) -> Tensor:
    """Distances of the parts from n times m objects, negative where they overlap, shape (n, m, 4) [m].

    Args:
        hand: position of G, shape (n, 3) [m].
        heading: of G's x axis, shape (n, 2).
        box: the box to grasp or the held one, n of them.
        objects: n times m of them.
    """
    side = GRIPPER_MAX_WIDTH / 2 + FINGER[1]
    across = torch.stack([-heading[:, 1], heading[:, 0]], dim=-1) * side
    fingers = [_part(hand, heading, FINGER, shift) for shift in (across, -across)]
    parts = [*fingers, _part(hand, heading, PALM), _part(hand, heading, WRIST), box]
    distances = _distances(Blocks(*(torch.stack(each, dim=1) for each in zip(*parts, strict=True))), objects)
    return torch.cat([distances[..., :2].amin(dim=-1, keepdim=True), distances[..., 2:]], dim=-1)


def _part(hand: Tensor, heading: Tensor, size: tuple[float, float, float], shift: Tensor | float = 0.0) -> Blocks:
    """A part of the hand, given by half sides and the height of its lower face, as a flat box at that height."""
    centre = torch.cat([hand[:, :2] + shift, hand[:, 2:] + size[2]], dim=-1)
    return Blocks(centre, heading, hand.new_tensor([*size[:2], 0.0]).expand(len(hand), 3))


def _distances(parts: Blocks, objects: Blocks) -> Tensor:
    """Greatest gap along the horizontal normals of their faces, or from the part down to the object's top.

    Of n times p parts and n times m objects, shape (n, m, p).
    """
    parts, objects = Blocks(*(each[:, None] for each in parts)), Blocks(*(each[:, :, None] for each in objects))
    between = objects.centre - parts.centre
    below = -between[..., 2] - objects.half[..., 2] - parts.half[..., 2]
    beside = torch.maximum(_gap(between, parts, objects), _gap(between, objects, parts))
    return torch.maximum(beside, below)


def _gap(between: Tensor, one: Blocks, other: Blocks) -> Tensor:
    """Greater of the gaps along the x and y axes of `one`."""
    along = (one.heading * other.heading).sum(-1).abs()
    across = (one.heading[..., 0] * other.heading[..., 1] - one.heading[..., 1] * other.heading[..., 0]).abs()
    x = (between[..., :2] * one.heading).sum(-1).abs()
    y = (between[..., 1] * one.heading[..., 0] - between[..., 0] * one.heading[..., 1]).abs()
    x = x - one.half[..., 0] - other.half[..., 0] * along - other.half[..., 1] * across
    y = y - one.half[..., 1] - other.half[..., 0] * across - other.half[..., 1] * along
    return torch.maximum(x, y)
