"""Q(matrix, k): ensembles that tell attempts that succeed from those that fail."""

from typing import NamedTuple

import torch
from torch import Tensor, nn

from ictamp_drake.learning.networks import NetworkConfig
from ictamp_drake.learning.parameters import FEATURES, SEEN, network_inputs
from ictamp_drake.observation.state_matrix import SCHEMA


class Belief(NamedTuple):
    """Probability of success, and how far the members of the ensemble disagree: mean and standard deviation."""

    mean: Tensor
    std: Tensor


class Classifier(nn.Module):
    """Ensemble for one skill.

    The objects of an action are the rows with a role, so the matrix tells actions of one skill apart. Each member is
    calibrated by the same two numbers (Platt's method): its probability is sigmoid(slope * logit + offset).
    """

    platt: Tensor

    def __init__(self, skill: str, network: NetworkConfig) -> None:
        super().__init__()
        self.skill = skill
        self.network = network.create(SCHEMA.width + SEEN, FEATURES, 1)
        self.register_buffer("platt", torch.tensor([1.0, 0.0]))

    def forward(self, matrix: Tensor, mask: Tensor, k: Tensor) -> Tensor:
        """Logits before calibration.

        Args:
            matrix: shape (n, 8, D).
            mask: shape (n, 8).
            k: shape (n, 4).

        Returns:
            Shape (members, n).
        """
        rows, extra = network_inputs(self.skill, matrix, k)
        return self.network(rows, mask, extra)[..., 0]

    def probabilities(self, matrix: Tensor, mask: Tensor, k: Tensor) -> Tensor:
        """Calibrated, of each member, shape (members, n)."""
        slope, offset = self.platt
        return torch.sigmoid(slope * self(matrix, mask, k) + offset)

    def belief(self, matrix: Tensor, mask: Tensor, k: Tensor) -> Belief:
        """Of the ensemble, shape (n,)."""
        return _summarize_members(self.probabilities(matrix, mask, k))

    def beliefs(self, matrix: Tensor, mask: Tensor, k: Tensor) -> Belief:
        """The same for several k in each situation, shape (n, m, 4) -> (n, m)."""
        return _summarize_members(self._probabilities_of_several(matrix, mask, k))

    def probability_of_any(self, matrix: Tensor, mask: Tensor, k: Tensor, tries: int = 1) -> Belief:
        """That one of so many draws from equally likely k succeeds, shape (n, m, 4) -> (n,).

        A member knows for certain how likely a draw is to succeed, so to each of them draws are independent.
        """
        one = self._probabilities_of_several(matrix, mask, k).mean(dim=-1)
        return _summarize_members(1 - (1 - one) ** tries)

    def _probabilities_of_several(self, matrix: Tensor, mask: Tensor, k: Tensor) -> Tensor:
        """Of each member, shape (members, n, m)."""
        count = k.shape[1]
        several = matrix.repeat_interleave(count, 0), mask.repeat_interleave(count, 0), k.flatten(0, 1)
        return self.probabilities(*several).reshape(-1, len(k), count)


def _summarize_members(probability: Tensor) -> Belief:
    return Belief(probability.mean(dim=0), probability.std(dim=0, correction=0))
