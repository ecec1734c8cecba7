"""Q(matrix, k): ensembles that predict whether an attempt succeeds."""

from typing import NamedTuple

import torch
from torch import Tensor, nn

from ictamp_drake.learning.networks import NetworkConfig
from ictamp_drake.learning.parameters import FEATURES, SEEN, network_inputs
from ictamp_drake.observation.state_matrix import SCHEMA


class Belief(NamedTuple):
    """Probability of success and disagreement in the ensemble: mean and standard deviation over its members."""

    mean: Tensor
    std: Tensor


class Classifier(nn.Module):
    """Ensemble for one skill.

    The objects of an action are the rows with a role, so the matrix distinguishes the actions of one skill. The same
    two numbers calibrate each member (Platt's method): its probability is sigmoid(slope * logit + offset).
    """

    platt: Tensor

    def __init__(self, skill: str, network: NetworkConfig) -> None:
        super().__init__()
        self.skill = skill
        self.network = network.create(SCHEMA.width + SEEN, FEATURES, 1)
        self.register_buffer("platt", torch.tensor([1.0, 0.0]))

    def forward(self, matrix: Tensor, mask: Tensor, k: Tensor) -> Tensor:
        """Compute the logits before calibration.

        Args:
            matrix: Primitive state matrices, shape (n, 8, D).
            mask: True where a row holds an object, shape (n, 8).
            k: Parameters of the skill, shape (n, 4).

        Returns:
            Logits, shape (members, n).
        """
        rows, extra = network_inputs(self.skill, matrix, k)
        return self.network(rows, mask, extra)[..., 0]

    def probabilities(self, matrix: Tensor, mask: Tensor, k: Tensor) -> Tensor:
        """Calibrated probability of success by each member, shape (members, n)."""
        slope, offset = self.platt
        return torch.sigmoid(slope * self(matrix, mask, k) + offset)

    def belief(self, matrix: Tensor, mask: Tensor, k: Tensor) -> Belief:
        """Belief of the ensemble, shape (n,)."""
        return _summarize_members(self.probabilities(matrix, mask, k))

    def beliefs(self, matrix: Tensor, mask: Tensor, k: Tensor) -> Belief:
        """Belief of the ensemble for several k in each situation, shape (n, m, 4) -> (n, m)."""
        return _summarize_members(self._probabilities_of_several(matrix, mask, k))

    def probability_of_any(self, matrix: Tensor, mask: Tensor, k: Tensor, tries: int = 1) -> Belief:
        """Belief that at least one of `tries` draws from equally likely k succeeds, shape (n, m, 4) -> (n,).

        Each member is certain of the success probability of a draw, so to each member the draws are independent.
        """
        one = self._probabilities_of_several(matrix, mask, k).mean(dim=-1)
        return _summarize_members(1 - (1 - one) ** tries)

    def _probabilities_of_several(self, matrix: Tensor, mask: Tensor, k: Tensor) -> Tensor:
        """Probability of success by each member, shape (members, n, m)."""
        count = k.shape[1]
        several = matrix.repeat_interleave(count, 0), mask.repeat_interleave(count, 0), k.flatten(0, 1)
        return self.probabilities(*several).reshape(-1, len(k), count)


def _summarize_members(probability: Tensor) -> Belief:
    return Belief(probability.mean(dim=0), probability.std(dim=0, correction=0))
