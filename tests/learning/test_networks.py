"""Networks see every present object, no absent one, and no other situation of the batch."""

import pytest
import torch

from ictamp_drake.learning.networks import ROLES, FlatNetwork, NetworkConfig, SetNetwork
from ictamp_drake.observation.state_matrix import ROWS, SCHEMA
from tests.learning.synthetic import matrices

EXTRA = 3
Network = SetNetwork | FlatNetwork


@pytest.fixture(params=["set", "flat"])
def network(request: pytest.FixtureRequest) -> Network:
    torch.manual_seed(0)
    return NetworkConfig(request.param, members=3, width=32).create(SCHEMA.width, EXTRA, 2).eval()


def extras(count: int) -> torch.Tensor:
    return torch.randn((count, EXTRA), generator=torch.Generator().manual_seed(1))


@pytest.mark.parametrize("member", range(3))
def test_the_output_depends_on_every_object_that_is_there_and_on_nothing_else(network: Network, member: int) -> None:
    matrix, mask = matrices()
    extra = extras(len(matrix)).requires_grad_()
    matrix = matrix.requires_grad_()
    for number in range(len(matrix)):
        outputs = network(matrix, mask, extra)[member, number].abs().sum()
        by_matrix, by_extra = torch.autograd.grad(outputs, [matrix, extra])
        seen = by_matrix.abs().sum(dim=-1) > 0
        assert torch.equal(seen[number], mask[number])
        assert not seen[torch.arange(len(matrix)) != number].any()
        assert torch.equal(by_extra.abs().sum(dim=-1) > 0, torch.arange(len(matrix)) == number)


def test_what_stands_in_absent_rows_makes_no_difference(network: Network) -> None:
    matrix, mask = matrices()
    filled = torch.where(mask[..., None], matrix, torch.tensor(7.0))
    torch.testing.assert_close(network(filled, mask, extras(6)), network(matrix, mask, extras(6)), rtol=0, atol=0)


def test_the_order_of_the_other_objects_makes_no_difference_to_a_set_alone() -> None:
    matrix, mask = matrices()
    order = torch.cat([torch.arange(ROLES), ROLES + torch.tensor([3, 0, 4, 1, 2])])
    for kind, same in (("set", True), ("flat", False)):
        torch.manual_seed(0)
        network = NetworkConfig(kind, members=2, width=32).create(SCHEMA.width, EXTRA, 1)  # type: ignore[arg-type]
        before, after = network(matrix, mask, extras(6)), network(matrix[:, order], mask[:, order], extras(6))
        assert torch.allclose(before, after, atol=1e-5) == same


def test_the_rows_of_an_action_are_told_apart(network: Network) -> None:
    matrix, mask = matrices()
    mask[:, :ROLES] = True
    swapped = torch.cat([torch.tensor([2, 1, 0]), torch.arange(ROLES, ROWS)])
    difference = network(matrix[:, swapped], mask, extras(6)) - network(matrix, mask, extras(6))
    assert difference.abs().min() > 1e-6


def test_an_answer_is_the_same_alone_and_in_a_batch_and_every_time(network: Network) -> None:
    matrix, mask = matrices()
    extra = extras(6)
    batch = network(matrix, mask, extra)
    assert torch.equal(batch, network(matrix, mask, extra))
    for number in range(6):
        one = slice(number, number + 1)
        torch.testing.assert_close(network(matrix[one], mask[one], extra[one]), batch[:, one], rtol=1e-4, atol=1e-6)


def test_members_differ_and_keep_to_their_own_weights(network: Network) -> None:
    matrix, mask = matrices()
    outputs = network(matrix, mask, extras(6))
    assert outputs.shape == (3, 6, 2)
    assert (outputs[0] - outputs[1]).abs().min() > 1e-6
    gradients = torch.autograd.grad(outputs[1].sum(), list(network.parameters()))
    for gradient in gradients:
        assert not gradient[[0, 2]].any()
        assert gradient[1].any()


@pytest.mark.parametrize("extra", [0, 16])
def test_the_default_ensemble_is_small(extra: int) -> None:
    network = NetworkConfig().create(SCHEMA.width, extra, 1)
    assert len(network.head_2.weight) == 5
    assert sum(weights.numel() for weights in network.parameters()) <= 300_000
