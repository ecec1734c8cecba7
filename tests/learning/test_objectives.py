"""Objectives of policies: they reward all successful k, and do not spoil the critics."""

import math
from dataclasses import replace

import pytest
import torch
from torch import Tensor

from ictamp_drake.learning.batches import Batch
from ictamp_drake.learning.classifier import Classifier
from ictamp_drake.learning.dynamics import Dynamics
from ictamp_drake.learning.networks import NetworkConfig
from ictamp_drake.learning.objectives import Classification, Improvement, PolicyTraining, PoseRegression
from ictamp_drake.learning.parameters import normalize_parameter, parameter
from ictamp_drake.learning.policies import PolicyNetworkConfig
from tests.learning.synthetic import ONE, SIZE, matrices

MIXTURE = PolicyTraining(PolicyNetworkConfig("mixture", 6, NetworkConfig(members=1, width=32)))
STAP = PolicyTraining(
    PolicyNetworkConfig("squashed", network=NetworkConfig("flat", 1, 32)), imitation=0.0, temperature=0.1, entropy=-4.0
)


class Ridges(Classifier):
    """A critic that likes grasps across the box's faces near its middle: four directions, a quarter turn apart."""

    def probabilities(self, matrix: Tensor, mask: Tensor, k: Tensor) -> Tensor:  # noqa: ARG002
        u = normalize_parameter("pick", matrix, k)
        mean = torch.exp(-(u[:, :3] ** 2).sum(dim=-1)) * (0.5 + 0.5 * torch.cos(4 * k[:, 3]))
        return mean[None]


def critic() -> Classifier:
    torch.manual_seed(0)
    return Ridges("pick", SIZE)


def successes() -> Batch:
    """Grasps along and across."""
    matrix, mask = matrices(64)
    noise = torch.Generator().manual_seed(3)
    turns = torch.randint(0, 4, (64,), generator=noise) * math.pi / 2 - math.pi
    u = torch.cat([0.2 * torch.randn((64, 3), generator=noise), turns[:, None]], dim=1)
    return Batch(matrix, mask, parameter("pick", matrix, u), torch.ones(64), torch.zeros(64, 4), torch.ones(64, 1))


def train_policy(config: PolicyTraining, steps: int) -> Improvement:
    improvement = Improvement(config, critic())
    optimizer = torch.optim.Adam(improvement.module.parameters(), 3e-3)
    noise = torch.Generator().manual_seed(0)
    for _ in range(steps):
        loss = improvement.loss(successes(), noise)
        optimizer.zero_grad()
        loss.backward()
        optimizer.step()
    return improvement


def draws(improvement: Improvement) -> tuple[Tensor, Tensor]:
    """u and Q of many draws."""
    batch = successes()
    with torch.inference_mode():
        u = improvement.policy.draw(batch.matrix, batch.mask, 32, torch.Generator().manual_seed(1))
        Q = critic().beliefs(batch.matrix, batch.mask, parameter("pick", batch.matrix, u)).mean
    return u, Q


def test_a_mixture_finds_all_ways_to_succeed() -> None:
    u, Q = draws(train_policy(MIXTURE, 250))
    assert Q.mean() > 0.8
    quarters = torch.round(u[..., 3] / (math.pi / 2)).long() % 4
    shares = torch.bincount(quarters.flatten(), minlength=4) / quarters.numel()
    assert shares.min() > 0.05


def test_imitation_alone_draws_what_was_shown() -> None:
    improvement = train_policy(replace(MIXTURE, imitation=1e3), 250)
    u, _ = draws(improvement)
    assert u[..., :3].std() == pytest.approx(0.2, abs=0.1)
    assert torch.cos(4 * u[..., 3]).mean() > 0.8


def test_the_actor_of_stap_finds_one_way() -> None:
    u, Q = draws(train_policy(STAP, 400))
    assert Q.mean() > 0.6
    assert torch.cos(u[..., 3] - u[:, :1, 3]).mean() > 0.5


@pytest.mark.parametrize(("target", "falls"), [(-4.0, True), (20.0, False)])
def test_the_temperature_falls_while_the_entropy_is_above_its_target(target: float, falls: bool) -> None:
    torch.manual_seed(0)
    improvement = Improvement(replace(STAP, entropy=target), critic())
    improvement.loss(successes(), torch.Generator().manual_seed(0)).backward()
    slope = improvement.module.log_temperature.grad
    assert slope is not None
    assert (slope > 0) == falls


def test_caution_takes_the_disagreement_off() -> None:
    class Torn(Ridges):
        def probabilities(self, matrix: Tensor, mask: Tensor, k: Tensor) -> Tensor:
            (mean,) = super().probabilities(matrix, mask, k)
            return torch.stack([mean - 0.25, mean + 0.25])

    figures = []
    for caution in (0.0, 2.0):
        torch.manual_seed(0)
        improvement = Improvement(replace(MIXTURE, caution=caution, imitation=0.0), Torn("pick", SIZE))
        with torch.inference_mode():
            figures.append(improvement.validate(successes(), torch.Generator().manual_seed(0))["loss"])
    assert figures[1] - figures[0] == pytest.approx(0.5, abs=1e-5)


def test_the_critics_are_not_trained_with_the_policy() -> None:
    before = Classifier("pick", SIZE)
    improvement = Improvement(MIXTURE, before)
    improvement.loss(successes(), torch.Generator()).backward()
    assert all(weights.grad is None for weights in before.parameters())
    names = [name for name, weights in improvement.module.named_parameters() if weights.grad is not None]
    assert any(name.startswith("policy.") for name in names)


def test_members_learn_from_their_own_samples() -> None:
    classifier = Classifier("pick", SIZE)
    weighted = replace(successes(), weight=torch.tensor([[1.0, 0.0]]).expand(64, 2))
    Classification(classifier).loss(weighted, torch.Generator()).backward()
    for weights in classifier.parameters():
        assert weights.grad is not None
        assert not weights.grad[1].any()
        assert weights.grad[0].any()


def test_dynamics_are_wrong_by_what_they_miss() -> None:
    torch.manual_seed(0)
    dynamics, batch = Dynamics("pick", ONE), successes()

    def loss(*missed: float) -> float:
        moved = dynamics(batch.matrix, batch.mask, batch.k).detach() + torch.tensor(missed)
        return PoseRegression(dynamics).validate(replace(batch, moved=moved), torch.Generator())["loss"]

    assert loss(0.0, 0.0, 0.0, 2 * math.pi) == pytest.approx(0.0, abs=1e-6)
    assert loss(0.01, 0.0, 0.0, 0.0) == pytest.approx(loss(0.0, 0.0, 0.0, 0.1), rel=1e-3)
    assert loss(0.1, 0.0, 0.0, 0.0) == pytest.approx(10 * loss(0.01, 0.0, 0.0, 0.0), rel=0.1)  # and not its square
