"""T(matrix, k): where an action's box is after a success, learned as what kinematics alone do not tell."""

import torch
from torch import Tensor, nn

from ictamp_drake.learning import parameters
from ictamp_drake.learning.networks import NetworkConfig
from ictamp_drake.observation.situations import LIFT
from ictamp_drake.observation.state_matrix import SCHEMA

SCALES = (0.01, 0.01, 0.01, 0.1)
"""Of errors in x, y, z [m] and yaw [rad]."""
_HELD = 1
"""Row of the held box."""


def nominal(skill: str, matrix: Tensor, k: Tensor) -> Tensor:
    """Where kinematics put the box: (x, y, z, yaw) of U in the target frame K, shape (n, 4) [m, rad].

    Pick: it rises with the hand from where it stood. Place: its bottom's centre is at k, but on the receptacle's top.
    """
    if skill == "pick":
        return k.new_tensor([0.0, 0.0, LIFT, 0.0]).expand(len(k), 4)
    height = parameters.sides(matrix[:, _HELD])[:, 2:]
    return torch.cat([k[:, :2], height / 2, k[:, 3:]], dim=-1)


class Dynamics(nn.Module):
    """Of one skill: the nominal pose and a residual that the network gives, its shift in the frame turned by k's yaw.

    The box stays parallel to K but for yaw: that it may tilt a little between the fingers is neglected. Nothing else
    moves in a success.
    """

    def __init__(self, skill: str, network: NetworkConfig) -> None:
        super().__init__()
        self.skill = skill
        self.network = network.create(SCHEMA.width + parameters.SEEN, parameters.FEATURES, 4)
        self.register_buffer("scales", torch.tensor(SCALES), persistent=False)

    scales: Tensor

    def forward(self, matrix: Tensor, mask: Tensor, k: Tensor) -> Tensor:
        """(x, y, z, yaw) of U of the action's box in the target frame K of before.

        Args:
            matrix: shape (n, 8, D).
            mask: shape (n, 8).
            k: shape (n, 4).

        Returns:
            Shape (n, 4) [m, rad].
        """
        rows, extra = parameters.network_inputs(self.skill, matrix, k)
        x, y, z, yaw = (self.network(rows, mask, extra).mean(dim=0) * self.scales).unbind(-1)
        cos, sin = k[:, 3].cos(), k[:, 3].sin()
        residual = torch.stack([cos * x - sin * y, sin * x + cos * y, z, yaw], dim=-1)
        return nominal(self.skill, matrix, k) + residual


def error(found: Tensor, moved: Tensor) -> Tensor:
    """Difference of two poses (x, y, z, yaw), shape (n, 4) [m, rad]."""
    return torch.cat([(found - moved)[:, :3], parameters.wrap_angle((found - moved)[:, 3:])], dim=-1)
