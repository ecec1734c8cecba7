"""π(k | matrix): stochastic policies of one skill, which draw k in batches."""

import math
from dataclasses import dataclass
from functools import lru_cache
from typing import Literal, NamedTuple

import torch
from torch import Tensor, nn
from torch.nn.functional import softplus

from ictamp_drake.core.checks import check_range
from ictamp_drake.learning.networks import NetworkConfig
from ictamp_drake.learning.parameters import FEATURES, GLIMPSES, SEEN, blind_network_inputs, scale_rows, wrap_angle
from ictamp_drake.observation.state_matrix import SCHEMA


@dataclass(frozen=True)
class PolicyNetworkConfig:
    """Class and size of a policy.

    Attributes:
        kind: Class of policy: `mixture` of Gaussians, for the several ways to grasp a box; `squashed`, STAP's Gaussian
            under tanh.
        components: Number of components of the mixture.
        network: Network that computes the parameters of the distribution; it must have one member.
    """

    kind: Literal["mixture", "squashed"] = "mixture"
    components: int = 8
    network: NetworkConfig = NetworkConfig(members=1, width=128)

    def __post_init__(self) -> None:
        check_range("components", self.components, 1, 100)
        check_range("policy.network.network.members", self.network.members, 1, 1)

    def create(self, skill: str) -> "Mixture | Squashed":
        """Create the policy of one skill."""
        return Mixture(skill, self) if self.kind == "mixture" else Squashed(self)


class Branches(NamedTuple):
    """One draw from each component, differentiable with respect to the weights of the policy's network.

    Attributes:
        u: Normalized k, shape (n, components, 4).
        log_density: Log-density of u under the whole policy, shape (n, components).
        weight: Probability of the component, shape (n, components).
    """

    u: Tensor
    log_density: Tensor
    weight: Tensor


class Mixture(nn.Module):
    """Mixture of Gaussians over position, wrapped around the circle over yaw."""

    log_std = (-6.0, 1.0)
    """Lowest and highest logarithm of a standard deviation."""

    def __init__(self, skill: str, config: PolicyNetworkConfig) -> None:
        super().__init__()
        self.skill = skill
        columns, extra = SCHEMA.width + GLIMPSES * SEEN, GLIMPSES * FEATURES
        self.network = config.network.create(columns, extra, config.components * 10)

    def _numbers(self, matrix: Tensor, mask: Tensor) -> tuple[Tensor, Tensor, Tensor]:
        """Logarithm of the weight (n, c), mean (n, c, 4) and standard deviation (n, c, 4) of each component."""
        rows, extra = blind_network_inputs(self.skill, matrix)
        raw = self.network(rows, mask, extra)[0].reshape(len(matrix), -1, 10)
        yaw = torch.atan2(raw[..., 4:5], raw[..., 5:6] + 1e-6)
        low, high = self.log_std
        std = (low + (high - low) * torch.sigmoid(raw[..., 6:10])).exp()
        return raw[..., 0].log_softmax(dim=-1), torch.cat([raw[..., 1:4], yaw], dim=-1), std

    def branches(self, matrix: Tensor, mask: Tensor, generator: torch.Generator) -> Branches:
        """Draw once from each component."""
        log_weight, mean, std = numbers = self._numbers(matrix, mask)
        u = _wrap_yaw(mean + std * torch.randn(mean.shape, generator=generator))
        return Branches(u, _log_density(numbers, u), log_weight.exp())

    def log_density(self, matrix: Tensor, mask: Tensor, u: Tensor) -> Tensor:
        """Log-density of u, shape (n, m, 4) -> (n, m)."""
        return _log_density(self._numbers(matrix, mask), u)

    def draw(self, matrix: Tensor, mask: Tensor, count: int, generator: torch.Generator) -> Tensor:
        """Draw `count` samples of u in each situation, shape (n, count, 4)."""
        log_weight, mean, std = self._numbers(matrix, mask)
        chosen = torch.multinomial(log_weight.exp(), count, replacement=True, generator=generator)[..., None]
        chosen = chosen.expand(-1, -1, 4)
        noise = torch.randn(chosen.shape, generator=generator)
        return _wrap_yaw(mean.gather(1, chosen) + std.gather(1, chosen) * noise)

    def spread(self, matrix: Tensor, mask: Tensor, count: int) -> Tensor:
        """Fixed set of u that represents the whole distribution, without randomness, shape (n, count, 4)."""
        log_weight, mean, std = self._numbers(matrix, mask)
        points = _even_points(count, 5)
        cumulated = log_weight.exp().cumsum(dim=1)
        heights = points[:, 0] * cumulated[:, -1:]
        chosen = torch.searchsorted(cumulated, heights)[..., None].expand(-1, -1, 4)
        return _wrap_yaw(mean.gather(1, chosen) + std.gather(1, chosen) * torch.special.ndtri(points[:, 1:]))


@lru_cache
def _even_points(count: int, dimensions: int) -> Tensor:
    """Points spread evenly over the interior of the unit cube, shape (count, dimensions)."""
    engine = torch.quasirandom.SobolEngine(dimensions, scramble=True, seed=0)  # type: ignore[no-untyped-call]
    return engine.draw(count).clamp(1e-6, 1 - 1e-6)


def _wrap_yaw(u: Tensor) -> Tensor:
    return torch.cat([u[..., :3], wrap_angle(u[..., 3:])], dim=-1)


def _log_density(numbers: tuple[Tensor, Tensor, Tensor], u: Tensor) -> Tensor:
    """Log-density of a mixture at u, shape (n, m, 4) -> (n, m); yaw counts up to one turn away, enough if narrow."""
    log_weight, mean, std = (each[:, None] for each in numbers)
    error = (u[:, :, None] - mean) / std
    turns = (wrap_angle(u[:, :, None, 3:] - mean[..., 3:]) + 2 * math.pi * torch.arange(-1, 2)) / std[..., 3:]
    yaw = torch.logsumexp(-(turns**2) / 2, dim=-1)
    log_normal = yaw - (error[..., :3] ** 2).sum(dim=-1) / 2 - std.log().sum(dim=-1) - 2 * math.log(2 * math.pi)
    return torch.logsumexp(log_weight + log_normal, dim=-1)


class Squashed(nn.Module):
    """STAP's actor: one Gaussian whose draws pass through tanh, so that all of k stays within its range."""

    log_std = (-5.0, 2.0)

    def __init__(self, config: PolicyNetworkConfig) -> None:
        super().__init__()
        self.network = config.network.create(SCHEMA.width, 0, 8)
        self.register_buffer("scale", torch.tensor([1.0, 1.0, 1.0, math.pi]), persistent=False)

    scale: Tensor

    def _numbers(self, matrix: Tensor, mask: Tensor) -> tuple[Tensor, Tensor]:
        """Mean and standard deviation before tanh, each of shape (n, 1, 4)."""
        raw = self.network(scale_rows(matrix), mask, matrix.new_zeros(len(matrix), 0))[0][:, None]
        return raw[..., :4], raw[..., 4:].clamp(*self.log_std).exp()

    def branches(self, matrix: Tensor, mask: Tensor, generator: torch.Generator) -> Branches:
        """Draw once from the only component."""
        mean, std = self._numbers(matrix, mask)
        free = mean + std * torch.randn(mean.shape, generator=generator)
        return Branches(self.scale * free.tanh(), self._density(mean, std, free), torch.ones_like(free[..., 0]))

    def log_density(self, matrix: Tensor, mask: Tensor, u: Tensor) -> Tensor:
        """Log-density of u, shape (n, m, 4) -> (n, m); values outside the range are moved to its edge."""
        mean, std = self._numbers(matrix, mask)
        return self._density(mean, std, (u / self.scale).clamp(-0.999, 0.999).atanh())

    def _density(self, mean: Tensor, std: Tensor, free: Tensor) -> Tensor:
        log_normal = -(((free - mean) / std) ** 2) / 2 - std.log() - math.log(2 * math.pi) / 2
        log_slope = 2 * (math.log(2) - free - softplus(-2 * free)) + self.scale.log()
        return (log_normal - log_slope).sum(dim=-1)

    def draw(self, matrix: Tensor, mask: Tensor, count: int, generator: torch.Generator) -> Tensor:
        """Draw `count` samples of u in each situation, shape (n, count, 4)."""
        mean, std = self._numbers(matrix, mask)
        noise = torch.randn((len(mean), count, 4), generator=generator)
        return self.scale * (mean + std * noise).tanh()

    def spread(self, matrix: Tensor, mask: Tensor, count: int) -> Tensor:
        """Fixed set of u that represents the whole distribution, see `Mixture.spread`."""
        mean, std = self._numbers(matrix, mask)
        return self.scale * (mean + std * torch.special.ndtri(_even_points(count, 4))).tanh()


Policy = Mixture | Squashed
