"""Recorded attempts as tensors, split by scene."""

from dataclasses import dataclass, fields, replace
from typing import NamedTuple

import numpy as np
import torch
from torch import Tensor

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.learning.dataset import Attempts

VALIDATION, TEST = 0.1, 0.1
"""Shares of the scenes for validation and for the test."""
_GOLDEN = 0.6180339887498949


@dataclass(frozen=True, eq=False)
class Batch:
    """n attempts at one skill.

    Attributes:
        matrix: Primitive state matrices, shape (n, 8, D).
        mask: True where a row holds an object, shape (n, 8).
        k: Parameters of the skill, shape (n, 4).
        success: Outcome, 0 or 1, shape (n,).
        moved: Pose (x, y, z, yaw) of the action's box afterwards, nan where unknown, shape (n, 4), see `Attempts`.
        weight: Weight of each attempt for each member of an ensemble, shape (n, members).
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
        """Select some of the attempts."""
        return Batch(**{field.name: getattr(self, field.name)[chosen] for field in fields(self)})

    def select_informative(self) -> "Batch":
        """Select what a policy learns from: all successes, and one attempt of each situation without any, in order.

        The attempts at one situation must be adjacent.
        """
        changes = (self.matrix[1:] != self.matrix[:-1]).flatten(1).any(dim=1)
        first = torch.cat([changes.new_ones(1), changes])
        situation = first.long().cumsum(0) - 1
        wins = torch.zeros(int(first.sum())).index_add_(0, situation, self.success)
        return self.rows((self.success > 0) | (first & (wins[situation] == 0)))

    def with_bootstrap_weights(self, members: int, rng: np.random.Generator) -> "Batch":
        """Weight the attempts by a bootstrap sample for each member of an ensemble (Poisson's approximation)."""
        weight = torch.from_numpy(rng.poisson(1.0, (len(self), members)).astype(np.float32))
        return replace(self, weight=weight)


class Split(NamedTuple):
    """Attempts for training, for early stopping and calibration, and for the test; no scene is in two of them."""

    training: Batch
    validation: Batch
    test: Batch

    def successes(self) -> "Split":
        """Split without the failures."""
        return Split(*(part.rows(part.success > 0) for part in self))

    def select_informative(self) -> "Split":
        """Split with only the attempts that a policy learns from."""
        return Split(*(part.select_informative() for part in self))


def join_batches(*batches: Batch) -> Batch:
    """Join several batches into one."""
    return Batch(**{field.name: torch.cat([getattr(one, field.name) for one in batches]) for field in fields(Batch)})


def split(attempts: Attempts) -> Split:
    """Split by the number of the scene alone, so that a scene stays in its part whatever else is collected.

    Raises:
        IctampError: A part has no successes or no failures.
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
    """Convert attempts to tensors, with equal weights."""
    success = torch.from_numpy(attempts.success.astype(np.float32))
    arrays = (attempts.matrix, attempts.mask, attempts.k, attempts.moved)
    matrix, mask, k, moved = (torch.from_numpy(array) for array in arrays)
    return Batch(matrix, mask, k, success, moved, torch.ones(len(attempts), 1))
