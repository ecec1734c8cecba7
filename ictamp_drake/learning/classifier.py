"""P(matrix) and Q(matrix, k): ensembles that tell attempts that succeed from those that fail."""

from typing import NamedTuple

import torch
from torch import Tensor, nn

from ictamp_drake.learning import parameters
from ictamp_drake.learning.networks import NetworkConfig
from ictamp_drake.world.observation import SCHEMA


class Belief(NamedTuple):
    """Probability of success, and how far the members of the ensemble disagree: mean and standard deviation."""

    mean: Tensor
    std: Tensor


class Classifier(nn.Module):
    """Ensemble for one skill; a critic sees k, an estimator of P does not.

    The objects of an action are the rows with a role, so the matrix tells actions of one skill apart. Each member is
    calibrated by the same two numbers (Platt's method): its probability is sigmoid(slope * logit + offset).
    """

    platt: Tensor

    def __init__(self, skill: str, network: NetworkConfig, sees_k: bool) -> None:
        super().__init__()
        self.skill = skill
        self.sees_k = sees_k
        views = 1 if sees_k else parameters.GLIMPSES
        self.network = network.create(SCHEMA.width + views * parameters.SEEN, views * parameters.FEATURES, 1)
        self.register_buffer("platt", torch.tensor([1.0, 0.0]))

    def forward(self, matrix: Tensor, mask: Tensor, k: Tensor | None = None) -> Tensor:
        """Logits before calibration.

        Args:
            matrix: shape (n, 8, D).
            mask: shape (n, 8).
            k: shape (n, 4), for a critic.

        Returns:
            Shape (members, n).
        """
        if self.sees_k and k is not None:
            rows, extra = parameters.with_k(self.skill, matrix, k)
        else:
            rows, extra = parameters.glimpses(self.skill, matrix)
        return self.network(rows, mask, extra)[..., 0]

    def belief(self, matrix: Tensor, mask: Tensor, k: Tensor | None = None) -> Belief:
        """Calibrated probabilities, shape (n,)."""
        slope, offset = self.platt
        probability = torch.sigmoid(slope * self(matrix, mask, k) + offset)
        return Belief(probability.mean(dim=0), probability.std(dim=0, correction=0))

    def beliefs(self, matrix: Tensor, mask: Tensor, k: Tensor) -> Belief:
        """A critic's probabilities for several k in each situation, k of shape (n, m, 4) -> (n, m)."""
        count = k.shape[1]
        belief = self.belief(matrix.repeat_interleave(count, 0), mask.repeat_interleave(count, 0), k.flatten(0, 1))
        return Belief(*(each.reshape(-1, count) for each in belief))
