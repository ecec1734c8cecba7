"""Ensembles of classifiers: how their logits are combined."""

import pytest
import torch

from ictamp_drake.learning.classifier import Classifier
from tests.learning.synthetic import SIZE, matrices


@pytest.fixture(params=["pick", "place"])
def critic(request: pytest.FixtureRequest) -> Classifier:
    torch.manual_seed(0)
    return Classifier(request.param, SIZE).eval()


K = torch.randn((6, 4), generator=torch.Generator().manual_seed(2)) * 0.05
SEVERAL = torch.stack([K, K + 0.1, K - 0.2], dim=1)


def test_a_belief_is_the_mean_of_the_members_and_their_disagreement(critic: Classifier) -> None:
    matrix, mask = matrices()
    members = torch.sigmoid(critic(matrix, mask, K))
    mean, std = critic.belief(matrix, mask, K)
    assert members.shape == (2, 6)
    torch.testing.assert_close(mean, (members[0] + members[1]) / 2)
    torch.testing.assert_close(std, (members[0] - members[1]).abs() / 2, rtol=1e-3, atol=1e-6)


def test_calibration_moves_and_stretches_the_logits(critic: Classifier) -> None:
    matrix, mask = matrices()
    critic.platt.copy_(torch.tensor([2.0, -1.0]))
    members = torch.sigmoid(2 * critic(matrix, mask, K) - 1)
    torch.testing.assert_close(critic.belief(matrix, mask, K).mean, members.mean(dim=0))


def test_every_number_of_k_counts(critic: Classifier) -> None:
    matrix, mask = matrices()
    for number in range(4):
        other = K.clone()
        other[:, number] += 0.3
        assert not torch.isclose(critic(matrix, mask, other), critic(matrix, mask, K), rtol=1e-4).any()


def test_several_k_are_judged_as_one_by_one(critic: Classifier) -> None:
    matrix, mask = matrices()
    mean, std = critic.beliefs(matrix, mask, SEVERAL)
    for number in range(3):
        one = critic.belief(matrix, mask, SEVERAL[:, number])
        torch.testing.assert_close((mean[:, number], std[:, number]), tuple(one), rtol=1e-4, atol=1e-6)


def test_what_is_expected_is_the_mean_over_k_of_each_member(critic: Classifier) -> None:
    matrix, mask = matrices()
    members = torch.stack([torch.sigmoid(critic(matrix, mask, SEVERAL[:, number])) for number in range(3)])
    mean, std = critic.probability_of_any(matrix, mask, SEVERAL)
    torch.testing.assert_close(mean, members.mean(dim=(0, 1)))
    torch.testing.assert_close(std, (members[:, 0] - members[:, 1]).mean(dim=0).abs() / 2, rtol=1e-3, atol=1e-6)
    torch.testing.assert_close(mean, critic.beliefs(matrix, mask, SEVERAL).mean.mean(dim=1))


def test_of_several_draws_each_member_expects_one_to_succeed(critic: Classifier) -> None:
    matrix, mask = matrices()
    members = torch.stack([torch.sigmoid(critic(matrix, mask, SEVERAL[:, number])) for number in range(3)])
    fails = 1 - members.mean(dim=0)
    mean, _ = critic.probability_of_any(matrix, mask, SEVERAL, tries=3)
    torch.testing.assert_close(mean, (1 - fails * fails * fails).mean(dim=0))
