"""Clearance of the hand and the held box from every object at k, by the separating axis theorem.

Hand and box come down to k from above, so what counts is the free space beside or below each of them. Everything is
seen in the frame at k, whose z axis points up, and taken for upright boxes.
"""

from typing import NamedTuple

import torch
from torch import Tensor

PARTS = 4
"""Fingers, palm, wrist, box."""
OPENING = 0.08
"""Largest opening of the hand for which networks are trained [m]."""
FINGER = (0.011, 0.0135, -0.0095)
PALM = (0.0195, 0.101, 0.037)
WRIST = (0.075, 0.075, 0.105)
"""Parts of that hand, the Panda's: half sides along G's x and y axes, and height of the lower face above G [m]."""
_SIDE = OPENING / 2 + FINGER[1]
_HAND = torch.tensor([(_SIDE, *FINGER), (-_SIDE, *FINGER), (0.0, *PALM), (0.0, *WRIST)])
"""Of each part of the hand: shift across G's x axis, half sides, height of the lower face [m]."""


class Blocks(NamedTuple):
    """Upright boxes as seen from k; components come first, which is fastest.

    Attributes:
        centre: Position of the center, shape (3, ...) [m].
        heading: Direction of the x axis in the horizontal plane, shape (2, ...).
        half: Half sides, shape (3, ...) [m].
    """

    centre: Tensor
    heading: Tensor
    half: Tensor


def clearances(hand: Tensor, heading: Tensor, box: Blocks, objects: Blocks) -> Tensor:
    """Distances of the parts from n times m objects, negative where they overlap, shape (4, n, m) [m].

    Args:
        hand: Position of G, shape (3, n) [m].
        heading: Direction of G's x axis in the horizontal plane, shape (2, n).
        box: Boxes to grasp or held boxes, n of them.
        objects: Objects to keep clear of, n times m of them.
    """
    shift, length, width, lower = _HAND.T[..., None]
    x, y, z = hand
    cos, sin = heading
    centre = torch.stack([x - sin * shift, y + cos * shift, z + lower])
    half = torch.stack([length, width, torch.zeros_like(width)]).expand_as(centre)  # flat, at the lower face
    parts = centre, heading[:, None].expand(2, *centre.shape[1:]), half
    both = Blocks(*(torch.cat([each, one[:, None]], dim=1)[..., None] for each, one in zip(parts, box, strict=True)))
    distances = _distances(both, objects)
    return torch.cat([distances[:2].amin(dim=0, keepdim=True), distances[2:]])


def _distances(parts: Blocks, objects: Blocks) -> Tensor:
    """Greatest gap along the horizontal normals of their faces, or from the part down to the object's top.

    Of p times n parts, shape (p, n, 1), and n times m objects, shape (n, m): shape (p, n, m).
    """
    x, y, z = (object_ - part for object_, part in zip(objects.centre, parts.centre, strict=True))
    (part_x, part_y), (object_x, object_y) = parts.heading, objects.heading
    along, across = (part_x * object_x + part_y * object_y).abs(), (part_x * object_y - part_y * object_x).abs()
    gaps = [-z - objects.half[2] - parts.half[2]]
    for one, other in (parts, objects), (objects, parts):
        (cos, sin), (width, depth, _) = one.heading, other.half
        gaps.append((x * cos + y * sin).abs() - one.half[0] - width * along - depth * across)
        gaps.append((y * cos - x * sin).abs() - one.half[1] - depth * along - width * across)
    return torch.stack(gaps).amax(dim=0)
