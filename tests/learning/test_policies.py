"""Draws of every class of policy follow its density."""

import math
from dataclasses import replace

import pytest
import torch

from ictamp_drake.learning.networks import NetworkConfig
from ictamp_drake.learning.policies import Policy, PolicyNetworkConfig
from tests.learning.synthetic import matrices

CONFIGS = {
    "mixture": PolicyNetworkConfig("mixture", 4, NetworkConfig(members=1, width=32)),
    "squashed": PolicyNetworkConfig("squashed", network=NetworkConfig("flat", members=1, width=32)),
}


def create_policy(name: str, **changes: object) -> Policy:
    torch.manual_seed(0)
    return replace(CONFIGS[name], **changes).create("pick").eval()  # type: ignore[arg-type]


@pytest.fixture(params=list(CONFIGS))
def policy(request: pytest.FixtureRequest) -> Policy:
    return create_policy(request.param)


def noise(seed: int = 0) -> torch.Generator:
    return torch.Generator().manual_seed(seed)


def test_draws_come_in_batches_and_from_the_generator_alone(policy: Policy) -> None:
    matrix, mask = matrices()
    u = policy.draw(matrix, mask, 5, noise())
    assert u.shape == (6, 5, 4)
    assert torch.isfinite(u).all()
    assert (u[..., 3].abs() <= math.pi).all()
    assert torch.equal(u, policy.draw(matrix, mask, 5, noise()))
    assert not torch.isclose(u, policy.draw(matrix, mask, 5, noise(1))).any()
    assert not torch.isclose(u[:, 0], u[:, 1]).any()


@pytest.mark.parametrize("name", CONFIGS)
def test_the_density_is_that_of_the_draws(name: str) -> None:
    """The mean of 1 / density over the draws that fall into a region is the region's volume."""
    policy = create_policy(name, components=1)
    matrix, mask = matrices(1)
    with torch.inference_mode():
        u = policy.draw(matrix, mask, 40_000, noise())
        density = policy.log_density(matrix, mask, u)[0].exp()
    low, high = u[0].quantile(torch.tensor([0.2, 0.8]), dim=0)
    inside = ((u[0] > low) & (u[0] < high)).all(dim=-1)
    estimate = float((inside / density).mean())
    assert estimate == pytest.approx(float((high - low).prod()), rel=0.1)


def test_branches_carry_their_density_and_gradients(policy: Policy) -> None:
    matrix, mask = matrices()
    u, log_density, weight = policy.branches(matrix, mask, noise())
    torch.testing.assert_close(weight.sum(dim=-1), torch.ones(6))
    torch.testing.assert_close(log_density, policy.log_density(matrix, mask, u), rtol=1e-2, atol=2e-2)
    for value in (u.sum(), log_density.sum()):
        gradients = torch.autograd.grad(value, list(policy.parameters()), retain_graph=True, allow_unused=True)
        assert any(gradient is not None and gradient.abs().sum() > 0 for gradient in gradients)


def test_what_is_spread_stands_for_the_draws(policy: Policy) -> None:
    """A few of them have the mean of many draws, and they do not depend on the rest of the batch."""
    matrix, mask = matrices()
    with torch.inference_mode():
        u, draws = policy.spread(matrix, mask, 64), policy.draw(matrix, mask, 4096, noise())
        alone = policy.spread(matrix[2:3], mask[2:3], 64)
    assert u.shape == (6, 64, 4)
    torch.testing.assert_close(alone, u[2:3], rtol=1e-3, atol=1e-4)
    for value in (torch.sin, torch.cos, torch.tanh):
        error = (value(u).mean(dim=1) - value(draws).mean(dim=1)).abs()
        assert (error < 0.4 * value(draws).std(dim=1) / 8).float().mean() > 0.6  # a third would be this good by chance


def test_yaw_goes_round_in_a_mixture() -> None:
    policy = create_policy("mixture")
    matrix, mask = matrices()
    u = policy.draw(matrix, mask, 3, noise())
    turned = u + torch.tensor([0.0, 0.0, 0.0, 2 * math.pi])
    density, again = (policy.log_density(matrix, mask, each) for each in (u, turned))
    torch.testing.assert_close(density, again, rtol=1e-3, atol=1e-3)


def test_a_squashed_policy_keeps_within_its_range() -> None:
    policy = create_policy("squashed")
    matrix, mask = matrices()
    u = policy.draw(30 * matrix, mask, 100, noise())
    assert (u.abs() <= torch.tensor([1.0, 1.0, 1.0, math.pi]) + 1e-6).all()
    assert u[..., 0].abs().max() > 0.9
