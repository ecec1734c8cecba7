"""The training loop: epochs with early stopping. An interrupted run continues with exactly the same result."""

import json
from collections.abc import Callable, Mapping
from dataclasses import asdict, dataclass
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import torch
from torch import Tensor

from ictamp_drake.core.checks import check_range
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.seeding import Stream, generator
from ictamp_drake.learning.batches import Batch
from ictamp_drake.learning.checkpoint import read, write
from ictamp_drake.learning.objectives import Objective
from ictamp_drake.learning.symmetry import vary_description

STATE = "state.safetensors"
LOG = "epochs.jsonl"
Figures = dict[str, float]


class Data(NamedTuple):
    """Attempts for training, and others for early stopping."""

    training: Batch
    validation: Batch


@dataclass(frozen=True)
class FitConfig:
    """Settings for training a network.

    Attributes:
        epochs: Maximum number of passes over the attempts.
        batch: Number of attempts in a step.
        rate: Initial learning rate; it falls along half a cosine.
        decay: Weight decay.
        clip: Maximum norm of a gradient.
        vary: Whether to draw another description of every attempt each time it is used, see `symmetry`.
        patience: Number of epochs without a better validation loss after which training ends.
        seed: Random seed of initial weights, order, bootstraps and noise.
    """

    epochs: int = 100
    batch: int = 512
    rate: float = 1e-3
    decay: float = 1e-3
    clip: float = 2.0
    vary: bool = True
    patience: int = 15
    seed: int = 0

    def __post_init__(self) -> None:
        for field, least in ("epochs", 1), ("batch", 1), ("rate", 1e-9), ("decay", 0), ("clip", 1e-9), ("patience", 0):
            check_range(f"fit.{field}", getattr(self, field), least, 1e9)
        check_range("fit.seed", self.seed, 0, 2**63 - 1)


def seeded_generator(seed: int, *keys: int) -> torch.Generator:
    """Create a torch generator for the training stream."""
    number = generator(Stream.TRAINING, seed, *keys).integers(2**63)
    return torch.Generator().manual_seed(int(number))


def start(seed: int) -> None:
    """Seed the initial weights, and use one thread, which is fastest for small networks and reproducible."""
    torch.set_num_threads(1)
    torch.manual_seed(int(generator(Stream.TRAINING, seed).integers(2**63)))


class Fit:
    """One training run with its folder.

    Args:
        objective: Objective to minimize; its module is trained in place and ends with the best weights.
        data: Attempts for training and for validation.
        config: Settings of the training.
        folder: Folder of the state after each epoch, from which the run continues, and of the log of epochs.
        purpose: Everything else that the result depends on; a folder with another purpose is refused.
    """

    def __init__(
        self, objective: Objective, data: Data, config: FitConfig, *, folder: Path, purpose: Mapping[str, Any]
    ) -> None:
        self.history: list[Figures] = []
        self._objective, self._data = objective, data
        self._config, self._folder = config, folder
        self._purpose = json.loads(json.dumps({**purpose, "fit": asdict(config)}, default=str))
        weights = objective.module.parameters()
        self._optimizer = torch.optim.AdamW(weights, config.rate, weight_decay=config.decay)
        self._best = _copy_state(objective.module.state_dict())

    @property
    def best_epoch(self) -> int:
        """Number of the epoch with the lowest validation loss, from 0; -1 before the first."""
        return int(np.argmin([figures["loss"] for figures in self.history])) if self.history else -1

    @property
    def finished(self) -> bool:
        """Whether no further epoch is needed."""
        epochs, config = len(self.history), self._config
        return epochs >= config.epochs or epochs - 1 - self.best_epoch >= config.patience

    def run(self, report: Callable[[Figures], None] = lambda _: None) -> bool:
        """Train until finished or until Ctrl-C, and return whether it finished. The module ends with the best weights.

        Raises:
            IctampError: The folder holds another training run or a damaged one.
        """
        self._restore()
        try:
            while not self.finished:
                self._epoch()
                self._save()
                report(self.history[-1])
        except KeyboardInterrupt:
            pass
        self._objective.module.load_state_dict(self._best)
        self._objective.module.eval()
        return self.finished

    def _epoch(self) -> None:
        config, number, module = self._config, len(self.history), self._objective.module
        noise = seeded_generator(config.seed, number)
        for group in self._optimizer.param_groups:
            group["lr"] = config.rate * (1 + np.cos(np.pi * number / config.epochs)) / 2
        module.train()
        losses = []
        for rows in torch.split(torch.randperm(len(self._data.training), generator=noise), config.batch):
            batch = self._data.training.rows(rows)
            if config.vary:
                batch = vary_description(self._objective.skill, batch, noise)
            loss = self._objective.loss(batch, noise)
            self._optimizer.zero_grad()
            torch.autograd.backward(loss)
            torch.nn.utils.clip_grad_norm_(module.parameters(), config.clip)
            self._optimizer.step()
            losses.append(float(loss.detach()))
        module.eval()
        with torch.inference_mode():
            figures = self._objective.validate(
                self._data.validation, seeded_generator(config.seed)
            )  # the same noise in all epochs
        self.history.append({"epoch": number, "training_loss": float(np.mean(losses)), **figures})
        if self.best_epoch == number:
            self._best = _copy_state(module.state_dict())

    def _save(self) -> None:
        """Save weights, best weights and the optimizer's moments in one file."""
        moments = {
            f"moments.{index}.{name}": value
            for index, state in self._optimizer.state_dict()["state"].items()
            for name, value in state.items()
        }
        weights = _add_prefix("weights.", self._objective.module.state_dict())
        tensors = {**weights, **_add_prefix("best.", self._best), **moments}
        arrays = {name: tensor.numpy() for name, tensor in tensors.items()}
        self._folder.mkdir(parents=True, exist_ok=True)
        write(self._folder / STATE, arrays, {"purpose": self._purpose, "history": self.history})
        (self._folder / LOG).write_text("".join(f"{json.dumps(figures)}\n" for figures in self.history))

    def _restore(self) -> None:
        path = self._folder / STATE
        if not path.exists():
            return
        arrays, metadata = read(path)
        if metadata.get("purpose") != self._purpose:
            problem, advice = "made with other options or other attempts", "give those again, or choose another --out"
            raise IctampError(Code.OTHER_OPTIONS, problem, file=path, advice=advice)
        tensors = {name: torch.from_numpy(array.copy()) for name, array in arrays.items()}
        self._objective.module.load_state_dict(_strip_prefix("weights.", tensors))
        self._best = _strip_prefix("best.", tensors)
        states: dict[int, dict[str, Tensor]] = {}
        for name, tensor in _strip_prefix("moments.", tensors).items():
            index, _, key = name.partition(".")
            states.setdefault(int(index), {})[key] = tensor
        groups = self._optimizer.state_dict()["param_groups"]
        self._optimizer.load_state_dict({"state": states, "param_groups": groups})
        self.history = metadata["history"]


def _copy_state(state: dict[str, Tensor]) -> dict[str, Tensor]:
    return {name: tensor.clone() for name, tensor in state.items()}


def _add_prefix(prefix: str, tensors: dict[str, Tensor]) -> dict[str, Tensor]:
    return {prefix + name: tensor for name, tensor in tensors.items()}


def _strip_prefix(prefix: str, tensors: dict[str, Tensor]) -> dict[str, Tensor]:
    return {name.removeprefix(prefix): tensor for name, tensor in tensors.items() if name.startswith(prefix)}
