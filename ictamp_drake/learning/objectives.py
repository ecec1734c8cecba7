"""Training objectives: the cross entropy of a classifier, the loss of a policy, and the error of dynamics."""

import copy
from dataclasses import dataclass
from typing import Protocol

import torch
from torch import Tensor, nn
from torch.nn.functional import binary_cross_entropy_with_logits as cross_entropy

from ictamp_drake.core.checks import check_range
from ictamp_drake.learning.batches import Batch
from ictamp_drake.learning.classifier import Classifier
from ictamp_drake.learning.dynamics import Dynamics, error
from ictamp_drake.learning.parameters import normalize_parameter, parameter
from ictamp_drake.learning.policies import Policy, PolicyNetworkConfig


class Objective(Protocol):
    """Objective that a training run minimizes."""

    @property
    def skill(self) -> str:
        """Name of the skill, pick or place."""

    @property
    def module(self) -> nn.Module:
        """Module that holds everything to be trained."""

    def loss(self, batch: Batch, generator: torch.Generator) -> Tensor:
        """Compute the loss, a scalar, to differentiate."""

    def validate(self, batch: Batch, generator: torch.Generator) -> dict[str, float]:
        """Compute figures on held-out attempts; the lowest `loss` is best."""


class Classification:
    """Cross entropy of the outcomes, separate for each member of the ensemble."""

    def __init__(self, classifier: Classifier) -> None:
        self.skill = classifier.skill
        self.module = classifier

    def loss(self, batch: Batch, generator: torch.Generator) -> Tensor:  # noqa: ARG002  (nothing is random)
        """Weighted mean over members and attempts."""
        logits = self.module(batch.matrix, batch.mask, batch.k)
        return cross_entropy(logits, batch.success.expand_as(logits), weight=batch.weight.T)

    def validate(self, batch: Batch, generator: torch.Generator) -> dict[str, float]:  # noqa: ARG002
        """Cross entropy of the ensemble's mean."""
        P = self.module.belief(batch.matrix, batch.mask, batch.k).mean
        return {"loss": nn.functional.binary_cross_entropy(P, batch.success).item()}


class PoseRegression:
    """Error of dynamics in units of its scales, with little weight on the few boxes that ended up far away.

    All attempts must be successes.
    """

    def __init__(self, dynamics: Dynamics) -> None:
        self.skill = dynamics.skill
        self.module = dynamics

    def loss(self, batch: Batch, generator: torch.Generator) -> Tensor:  # noqa: ARG002  (nothing is random)
        """Mean over attempts and the four numbers of a pose."""
        scaled = error(self.module(batch.matrix, batch.mask, batch.k), batch.moved) / self.module.scales
        return nn.functional.smooth_l1_loss(scaled, torch.zeros_like(scaled), beta=0.1)

    def validate(self, batch: Batch, generator: torch.Generator) -> dict[str, float]:
        """The same loss, on held-out attempts."""
        return {"loss": self.loss(batch, generator).item()}


@dataclass(frozen=True)
class PolicyTraining:
    """Network of a policy and objective of its training.

    By default, the policy imitates successful k and seeks k that the critics rate highly, minus a margin for caution.
    With `--policy.network.kind squashed --policy.imitation 0 --policy.entropy -4` it is the actor of STAP's soft
    actor-critic, trained offline: from recorded attempts, after its critics and not together with them.

    Attributes:
        network: Class and size of the policy.
        imitation: Weight of the negative log-likelihood of successful k, averaged over the four numbers of k.
        caution: Number of standard deviations of the critics subtracted from their mean; with two critics, 1 gives
            their minimum.
        temperature: Weight of the log-density of draws; only the initial weight when there is a target entropy.
        entropy: Target of the policy's entropy; None keeps the temperature constant.
    """

    network: PolicyNetworkConfig = PolicyNetworkConfig()
    imitation: float = 0.05
    caution: float = 1.0
    temperature: float = 0.01
    entropy: float | None = None

    def __post_init__(self) -> None:
        for field in ("imitation", "caution", "temperature"):
            check_range(f"policy.{field}", getattr(self, field), 0, 1e6)


class _Tempered(nn.Module):
    """A policy with the temperature of its training."""

    def __init__(self, policy: Policy, temperature: float) -> None:
        super().__init__()
        self.policy = policy
        self.log_temperature = nn.Parameter(torch.tensor(max(temperature, 1e-3)).log())


class Improvement:
    """E[temperature * log π(k) - Q(k)] over draws, as in soft actor-critic with one step, plus imitation."""

    def __init__(self, config: PolicyTraining, critic: Classifier) -> None:
        self.skill = critic.skill
        self.policy = config.network.create(critic.skill)
        self.module = _Tempered(self.policy, config.temperature)
        self._critic = copy.deepcopy(critic).requires_grad_(False).eval()
        self._config = config

    def loss(self, batch: Batch, generator: torch.Generator) -> Tensor:
        """Loss of the policy and of its temperature."""
        loss, log_density = self._parts(batch, generator)
        if self._config.entropy is not None:
            loss = loss - self.module.log_temperature * (log_density.detach().mean() + self._config.entropy)
        return loss

    def validate(self, batch: Batch, generator: torch.Generator) -> dict[str, float]:
        """The loss, the critics' mean over four draws in each situation, and the policy's entropy."""
        matrix, mask = batch.matrix, batch.mask
        k = parameter(self.skill, matrix, self.policy.draw(matrix, mask, 4, generator))
        belief = self._critic.beliefs(matrix, mask, k)
        loss, log_density = self._parts(batch, generator)
        return {"loss": float(loss), "Q": float(belief.mean.mean()), "entropy": -float(log_density.mean())}

    def _parts(self, batch: Batch, generator: torch.Generator) -> tuple[Tensor, Tensor]:
        """Loss of the policy, and the mean log-density of its draws, shape (n,)."""
        config, skill, matrix, mask = self._config, self.skill, batch.matrix, batch.mask
        u, log_density, weight = self.policy.branches(matrix, mask, generator)
        belief = self._critic.beliefs(matrix, mask, parameter(skill, matrix, u))
        value = belief.mean - config.caution * belief.std
        fixed = config.entropy is None
        temperature = config.temperature if fixed else float(self.module.log_temperature.detach().exp())
        loss = (weight * (temperature * log_density - value)).sum(dim=-1).mean()
        wins = batch.success > 0
        if config.imitation and wins.any():
            shown = normalize_parameter(skill, matrix[wins], batch.k[wins])[:, None]
            likelihood = self.policy.log_density(matrix[wins], mask[wins], shown)
            loss = loss - config.imitation * likelihood.mean() / 4
        return loss, (weight * log_density).sum(dim=-1)
