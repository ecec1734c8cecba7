"""Ensembles of classifiers: what becomes of their logits."""

import pytest
import torch

from ictamp_drake.learning.classifier import Classifier
from tests.learning.synthetic import SIZE, matrices


@pytest.fixture(params=[False, True], ids=["P", "Q"])
def classifier(request: pytest.FixtureRequest) -> Classifier:
    torch.manual_seed(0)
    return Classifier("pick", SIZE, sees_k=request.param).eval()


K = torch.randn((6, 4), generator=torch.Generator().manual_seed(2)) * 0.05


def test_a_belief_is_the_mean_of_the_members_and_their_disagreement(classifier: Classifier) -> None:
    matrix, mask = matrices()
    members = torch.sigmoid(classifier(matrix, mask, K))
    mean, std = classifier.belief(matrix, mask, K)
    assert members.shape == (2, 6)
    torch.testing.assert_close(mean, (members[0] + members[1]) / 2)
    torch.testing.assert_close(std, (members[0] - members[1]).abs() / 2, rtol=1e-3, atol=1e-6)


def test_calibration_moves_and_stretches_the_logits(classifier: Classifier) -> None:
    matrix, mask = matrices()
    classifier.platt.copy_(torch.tensor([2.0, -1.0]))
    members = torch.sigmoid(2 * classifier(matrix, mask, K) - 1)
    torch.testing.assert_close(classifier.belief(matrix, mask, K).mean, members.mean(dim=0))


def test_only_a_critic_sees_k(classifier: Classifier) -> None:
    matrix, mask = matrices()
    for number in range(4):
        other = K.clone()
        other[:, number] += 0.3
        changed = ~torch.isclose(classifier(matrix, mask, other), classifier(matrix, mask, K), rtol=1e-4)
        assert changed.all() == classifier.sees_k
        assert changed.any() == classifier.sees_k


def test_several_k_are_judged_as_one_by_one() -> None:
    torch.manual_seed(0)
    critic = Classifier("place", SIZE, sees_k=True).eval()
    matrix, mask = matrices()
    several = torch.stack([K, K + 0.1, K - 0.2], dim=1)
    mean, std = critic.beliefs(matrix, mask, several)
    for number in range(3):
        one = critic.belief(matrix, mask, several[:, number])
        torch.testing.assert_close((mean[:, number], std[:, number]), tuple(one), rtol=1e-4, atol=1e-6)
