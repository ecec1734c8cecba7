"""Networks over the primitive state matrix; every layer holds one set of weights for each member of an ensemble."""

from dataclasses import dataclass
from typing import Literal

import torch
from torch import Tensor, nn
from torch.nn.functional import relu_

from ictamp_drake.core.checks import check_range
from ictamp_drake.observation.state_matrix import ROWS

ROLES = 3
"""Number of the first rows of a matrix, each of which has its own role; the rows after them are a set."""


@dataclass(frozen=True)
class NetworkConfig:
    """Size of a network.

    Attributes:
        kind: Kind of network: `set` reads the rows without a role as a set; `flat` reads the matrix as one long vector,
            as the networks of STAP do.
        members: Number of networks in the ensemble.
        width: Width of the hidden layers.
    """

    kind: Literal["set", "flat"] = "set"
    members: int = 5
    width: int = 80

    def __post_init__(self) -> None:
        check_range("members", self.members, 1, 100)
        check_range("width", self.width, 1, 4096)

    def create(self, columns: int, extra: int, outputs: int) -> "SetNetwork | FlatNetwork":
        """Create a network that reads matrices of `columns` columns and vectors of `extra` numbers."""
        network = SetNetwork if self.kind == "set" else FlatNetwork
        return network(self.members, columns, extra, self.width, outputs)


class Linear(nn.Module):
    """One linear layer for each member of an ensemble, (members or 1, n, inputs) -> (members, n, outputs)."""

    def __init__(self, members: int, inputs: int, outputs: int) -> None:
        super().__init__()
        bound = inputs**-0.5
        self.weight = nn.Parameter(torch.empty(members, inputs, outputs).uniform_(-bound, bound))
        self.bias = nn.Parameter(torch.zeros(members, 1, outputs))

    def forward(self, x: Tensor) -> Tensor:
        """Compute the layer's outputs."""
        return torch.baddbmm(self.bias, x.expand(len(self.weight), -1, -1), self.weight)


class SetNetwork(nn.Module):
    """Network that reads the rows with a role side by side, and the others as a set, conditioned on those with a role.

    Neither the order of the other rows nor the contents of absent rows make a difference: absent rows are masked.
    """

    def __init__(self, members: int, columns: int, extra: int, width: int, outputs: int) -> None:
        super().__init__()
        self.role_1 = Linear(members, ROLES * (columns + 1) + extra, width)
        self.role_2 = Linear(members, width, width)
        self.other_1 = Linear(members, columns, width)
        self.light = Linear(members, width, width)
        self.other_2 = Linear(members, width, width)
        self.head_1 = Linear(members, 3 * width, width)
        self.head_2 = Linear(members, width, outputs)

    def forward(self, rows: Tensor, mask: Tensor, extra: Tensor) -> Tensor:
        """Compute the outputs of all members.

        Args:
            rows: Rows of the matrices, shape (n, 8, columns).
            mask: True where a row holds an object, shape (n, 8).
            extra: Vectors of extra numbers, shape (n, extra).

        Returns:
            Outputs, shape (members, n, outputs).
        """
        count, present = len(rows), mask.to(rows.dtype)[..., None]
        roles = torch.cat([(rows[:, :ROLES] * present[:, :ROLES]).flatten(1), present[:, :ROLES, 0], extra], dim=1)
        role = relu_(self.role_2(relu_(self.role_1(roles[None]))))
        members, width = len(role), role.shape[-1]
        others = self.other_1(rows[:, ROLES:].flatten(0, 1)[None]).reshape(members, count, -1, width)
        others = relu_(others.add_(self.light(role)[:, :, None]))
        others = relu_(self.other_2(others.flatten(1, 2))).reshape_as(others) * present[:, ROLES:]
        pooled = torch.cat([role, others.amax(dim=2), others.mean(dim=2)], dim=-1)
        return self.head_2(relu_(self.head_1(pooled)))


class FlatNetwork(nn.Module):
    """Two hidden layers over the flattened matrix, as in STAP's actors and critics."""

    def __init__(self, members: int, columns: int, extra: int, width: int, outputs: int) -> None:
        super().__init__()
        self.layer_1 = Linear(members, ROWS * columns + extra, width)
        self.layer_2 = Linear(members, width, width)
        self.head = Linear(members, width, outputs)

    def forward(self, rows: Tensor, mask: Tensor, extra: Tensor) -> Tensor:
        """Compute the outputs of all members, see `SetNetwork.forward`."""
        flat = (rows * mask.to(rows.dtype)[..., None]).flatten(1)
        return self.head(relu_(self.layer_2(relu_(self.layer_1(torch.cat([flat, extra], dim=1)[None])))))
