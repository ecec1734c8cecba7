"""T(matrix, k): pose of an action's box after a success, learned as a correction of the kinematics."""

import torch
from torch import Tensor, nn

from ictamp_drake.learning import parameters
from ictamp_drake.learning.networks import NetworkConfig
from ictamp_drake.observation.situations import LIFT
from ictamp_drake.observation.state_matrix import SCHEMA

SCALES = (0.01, 0.01, 0.01, 0.1)
"""Scales of errors in x, y, z [m] and yaw [rad]."""
_HELD = 1
"""Row of the held box."""


def nominal(skill: str, matrix: Tensor, k: Tensor) -> Tensor:
    """Pose of the box by kinematics alone: (x, y, z, yaw) of U in the target frame K, shape (n, 4) [m, rad].

    Pick: the box rises with the hand from where it stood. Place: the center of its bottom face is at k, but at the
    height of the receptacle's top face.
    """
    if skill == "pick":
        return k.new_tensor([0.0, 0.0, LIFT, 0.0]).expand(len(k), 4)
    height = parameters.sides(matrix[:, _HELD])[:, 2:]
    return torch.cat([k[:, :2], height / 2, k[:, 3:]], dim=-1)


class Dynamics(nn.Module):
    """Dynamics of one skill: the nominal pose plus a residual from the network, in the frame turned by k's yaw.

    The box stays parallel to K except for yaw; a slight tilt between the fingers is neglected. Nothing else moves in a
    success.
    """

    def __init__(self, skill: str, network: NetworkConfig) -> None:
        super().__init__()
        self.skill = skill
        self.network = network.create(SCHEMA.width + parameters.SEEN, parameters.FEATURES, 4)
        self.register_buffer("scales", torch.tensor(SCALES), persistent=False)

    scales: Tensor

    def forward(self, matrix: Tensor, mask: Tensor, k: Tensor) -> Tensor:
        """Predict (x, y, z, yaw) of U of the action's box, in the target frame K as it was before the action.

        Args:
            matrix: Primitive state matrices, shape (n, 8, D).
            mask: True where a row holds an object, shape (n, 8).
            k: Parameters of the skill, shape (n, 4).

        Returns:
            Poses, shape (n, 4) [m, rad].
        """
        rows, extra = parameters.network_inputs(self.skill, matrix, k)
        x, y, z, yaw = (self.network(rows, mask, extra).mean(dim=0) * self.scales).unbind(-1)
        cos, sin = k[:, 3].cos(), k[:, 3].sin()
        residual = torch.stack([cos * x - sin * y, sin * x + cos * y, z, yaw], dim=-1)
        return nominal(self.skill, matrix, k) + residual


def error(found: Tensor, moved: Tensor) -> Tensor:
    """Difference of two poses (x, y, z, yaw), shape (n, 4) [m, rad]."""
    return torch.cat([(found - moved)[:, :3], parameters.wrap_angle((found - moved)[:, 3:])], dim=-1)
