"""Recorded attempts as tensors, split by scene."""

from dataclasses import dataclass, fields, replace
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.learning.dataset import Attempts

VALIDATION, TEST = 0.1, 0.1
"""Shares of the scenes."""
_GOLDEN = 0.6180339887498949


@dataclass(frozen=True, eq=False)
class Batch:
    """n attempts at one skill.

    Attributes:
        matrix: shape (n, 8, D).
        mask: shape (n, 8).
        k: shape (n, 4).
        success: 0 or 1, shape (n,).
        moved: (x, y, z, yaw) of the action's box afterwards, nan where unknown, shape (n, 4), see `Attempts`.
        weight: of each attempt for each member of an ensemble, shape (n, members).
    """

    matrix: Tensor
    mask: Tensor
    k: Tensor
    success: Tensor
    moved: Tensor
    weight: Tensor

    def __len__(self) -> int:
        return len(self.k)

    def rows(self, chosen: Tensor) -> "Batch":
        """Some of the attempts."""
        return Batch(**{field.name: getattr(self, field.name)[chosen] for field in fields(self)})

    def select_informative(self) -> "Batch":
        """What a policy learns from: all successes, and of a situation that had none one attempt; in the same order.

        The attempts at a situation stand one after the other.
        """
        changes = (self.matrix[1:] != self.matrix[:-1]).flatten(1).any(dim=1)
        first = torch.cat([changes.new_ones(1), changes])
        situation = first.long().cumsum(0) - 1
        wins = torch.zeros(int(first.sum())).index_add_(0, situation, self.success)
        return self.rows((self.success > 0) | (first & (wins[situation] == 0)))

    def with_bootstrap_weights(self, members: int, rng: np.random.Generator) -> "Batch":
        """Each member of an ensemble sees a sample of its own, drawn with replacement (Poisson's approximation)."""
        weight = torch.from_numpy(rng.poisson(1.0, (len(self), members)).astype(np.float32))
        return replace(self, weight=weight)


class Split(NamedTuple):
    """Attempts to learn from, to stop early and calibrate by, and to test with; no scene is in two of them."""

    training: Batch
    validation: Batch
    test: Batch

    def successes(self) -> "Split":
        """Without the failures."""
        return Split(*(part.rows(part.success > 0) for part in self))

    def select_informative(self) -> "Split":
        """What a policy learns from."""
        return Split(*(part.select_informative() for part in self))


def join_batches(*batches: Batch) -> Batch:
    """All attempts of several batches."""
    return Batch(**{field.name: torch.cat([getattr(one, field.name) for one in batches]) for field in fields(Batch)})


def split(attempts: Attempts) -> Split:
    """Split by the number of the scene alone: a scene is where it is, whatever else was collected.

    Raises:
        IctampError: a part has no successes or no failures.
    """
    place = attempts.scene * _GOLDEN % 1.0  # spread evenly, unlike the kinds of scenes
    bounds = {
        "training": (0, 1 - VALIDATION - TEST),
        "validation": (1 - VALIDATION - TEST, 1 - TEST),
        "test": (1 - TEST, 1),
    }
    parts = {}
    for name, (low, high) in bounds.items():
        part = attempts.select((place >= low) & (place < high))
        wins = int(part.success.sum())
        if wins in (0, len(part)):
            found = f"{{value}} successes in {len(part)} attempts in the {name} scenes"
            problem = f"expected successes and failures, got {found}"
            raise IctampError(Code.TOO_FEW_DATA, problem, value=wins, advice="collect more")
        parts[name] = batch(part)
    return Split(**parts)


def batch(attempts: Attempts) -> Batch:
    """All attempts with equal weights."""
    success = torch.from_numpy(attempts.success.astype(np.float32))
    arrays = (attempts.matrix, attempts.mask, attempts.k, attempts.moved)
    matrix, mask, k, moved = (torch.from_numpy(array) for array in arrays)
    return Batch(matrix, mask, k, success, moved, torch.ones(len(attempts), 1))
