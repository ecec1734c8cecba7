"""Trained networks, loaded from their checkpoints and ready for use."""

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, TypeVar

import numpy as np
import torch
from numpy.typing import NDArray
from torch import nn

from ictamp_drake.core.decoding import decode
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.reading import in_file
from ictamp_drake.core.types import FloatArray
from ictamp_drake.learning.checkpoint import Arrays, Kind, load, name_of
from ictamp_drake.learning.classifier import Classifier
from ictamp_drake.learning.dynamics import Dynamics
from ictamp_drake.learning.networks import NetworkConfig
from ictamp_drake.learning.parameters import parameter
from ictamp_drake.learning.policies import Policy, PolicyNetworkConfig
from ictamp_drake.observation.state_matrix import Observation

Module = TypeVar("Module", bound=nn.Module)


@dataclass(frozen=True, eq=False)
class SkillModel:
    """Trained networks of one skill: the policy π(k | matrix) and the critics Q(matrix, k)."""

    policy: Policy
    critic: Classifier

    def draw(self, observation: Observation, count: int, rng: np.random.Generator) -> FloatArray:
        """Draw `count` parameters k for each of n situations, shape (n, count, 4)."""
        matrix, mask = tensors(observation)
        noise = torch.Generator().manual_seed(int(rng.integers(2**63)))
        with torch.inference_mode():
            k = parameter(self.critic.skill, matrix, self.policy.draw(matrix, mask, count, noise))
        return k.numpy().astype(np.float64)

    def Q(self, observation: Observation, k: FloatArray) -> FloatArray:
        """Estimated probability of success of each k, shape (n, m, 4) -> (n, m)."""
        with torch.inference_mode():
            belief = self.critic.beliefs(*tensors(observation), torch.from_numpy(k.astype(np.float32)))
        return belief.mean.numpy().astype(np.float64)


@dataclass(frozen=True, eq=False)
class EstimatorModel:
    """Trained estimator of one skill's success: P(matrix), the mean of critics over the policy's k.

    Its critics were trained after the policy, on its outcomes. They are not the critics that the policy learned from.
    """

    policy: Policy
    critic: Classifier

    def believe(self, observation: Observation, draws: int, tries: int = 1) -> FloatArray:
        """P of n situations and the disagreement of the ensemble's members, shape (2, n).

        Args:
            observation: State matrices of the situations.
            draws: Number of k in the mean, see `Mixture.spread`.
            tries: Maximum number of k that a step draws, see `Classifier.probability_of_any`.
        """
        matrix, mask = tensors(observation)
        with torch.inference_mode():
            k = parameter(self.critic.skill, matrix, self.policy.spread(matrix, mask, draws))
            belief = self.critic.probability_of_any(matrix, mask, k, tries)
        return torch.stack(belief).numpy().astype(np.float64)


@dataclass(frozen=True, eq=False)
class DynamicsModel:
    """Trained dynamics of the box in one skill: T(matrix, k)."""

    dynamics: Dynamics

    def predict(self, observation: Observation, k: FloatArray) -> FloatArray:
        """(x, y, z, yaw) of U of the action's box in the target frame after a success, (n, 4) -> (n, 4) [m, rad]."""
        with torch.inference_mode():
            moved = self.dynamics(*tensors(observation), torch.from_numpy(k.astype(np.float32)))
        return moved.numpy().astype(np.float64)


def tensors(observation: Observation) -> tuple[torch.Tensor, torch.Tensor]:
    """Matrix and mask for the networks."""
    return torch.from_numpy(observation.matrix), torch.from_numpy(observation.mask)


def load_skill(folder: Path, skill: str, kind: Kind = "policy") -> SkillModel:
    """Load the policy of a skill, with the critics it was trained on or, for the kind "estimator", those of P.

    Raises:
        IctampError: The checkpoint cannot be loaded, see `checkpoint.load`.
    """
    return SkillModel(*_policy_and_critic(folder, kind, skill))


def load_estimator(folder: Path, skill: str) -> EstimatorModel:
    """Load the trained estimator of P of a skill.

    Raises:
        IctampError: The checkpoint cannot be loaded, see `checkpoint.load`.
    """
    return EstimatorModel(*_policy_and_critic(folder, "estimator", skill))


def _version(path: Path) -> tuple[int, ...]:
    """Version of a file, which changes when the file does; empty when there is no file."""
    if not path.exists():
        return ()
    found = path.stat()
    return found.st_mtime_ns, found.st_size, found.st_ino


@dataclass(frozen=True)
class _Networks:
    """Description of the networks in a checkpoint of the kinds policy and estimator."""

    policy: PolicyNetworkConfig
    critic: NetworkConfig


def _policy_and_critic(folder: Path, kind: Kind, skill: str) -> tuple[Policy, Classifier]:
    return _load_cached(folder, kind, skill, _version(folder / name_of(kind, skill)))


@lru_cache(maxsize=16)
def _load_cached(folder: Path, kind: Kind, skill: str, _: tuple[int, ...]) -> tuple[Policy, Classifier]:
    """Read once by each process; a file that has changed is read again."""
    torch.set_num_threads(1)  # small networks are fastest so
    found = load(folder, kind, skill)
    path = folder / name_of(kind, skill)
    with in_file(path):
        networks = decode(_Networks, found.network, "network")
    policy, critic = networks.policy.create(skill), Classifier(skill, networks.critic)
    return _fill_module(policy, found.arrays, "policy.", path), _fill_module(critic, found.arrays, "critic.", path)


def load_dynamics(folder: Path, skill: str) -> DynamicsModel:
    """Load the trained dynamics of a skill.

    Raises:
        IctampError: The checkpoint cannot be loaded, see `checkpoint.load`.
    """
    return _load_dynamics_cached(folder, skill, _version(folder / name_of("dynamics", skill)))


@lru_cache(maxsize=16)
def _load_dynamics_cached(folder: Path, skill: str, _: tuple[int, ...]) -> DynamicsModel:
    torch.set_num_threads(1)
    found = load(folder, "dynamics", skill)
    path = folder / name_of("dynamics", skill)
    with in_file(path):
        dynamics = Dynamics(skill, decode(NetworkConfig, found.network, "network"))
    return DynamicsModel(_fill_module(dynamics, found.arrays, "", path))


def arrays_of(module: nn.Module, prefix: str = "") -> dict[str, NDArray[Any]]:
    """The numbers of a network, for a checkpoint."""
    return {prefix + name: tensor.numpy() for name, tensor in module.state_dict().items()}


def _fill_module(module: Module, arrays: Arrays, prefix: str, path: Path) -> Module:
    state = {
        name.removeprefix(prefix): torch.from_numpy(array) for name, array in arrays.items() if name.startswith(prefix)
    }
    try:
        module.load_state_dict(state)
    except RuntimeError as error:
        raise IctampError(Code.DAMAGED, "its numbers do not fit the networks that it describes", file=path) from error
    return module.eval()
