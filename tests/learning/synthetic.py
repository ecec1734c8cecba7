"""Attempts whose outcomes follow a rule that can be learned, and checkpoints of untrained networks."""

from dataclasses import asdict
from pathlib import Path

import numpy as np
import torch

from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Attempt, Configuration, FloatArray
from ictamp_drake.learning.batches import Batch
from ictamp_drake.learning.checkpoint import Checkpoint
from ictamp_drake.learning.classifier import Classifier
from ictamp_drake.learning.dataset import AttemptRow, scene_text, write
from ictamp_drake.learning.dynamics import Dynamics, nominal
from ictamp_drake.learning.models import arrays_of
from ictamp_drake.learning.networks import NetworkConfig
from ictamp_drake.learning.policies import PolicyNetworkConfig
from ictamp_drake.observation.situations import LIFT
from ictamp_drake.observation.state_matrix import ROWS, SCHEMA, Observer
from ictamp_drake.scenes.training import training_scene
from ictamp_drake.world.frames import upright_frame
from tests.motions import stay

MOTION = (stay(0.1),)
SIZE = NetworkConfig(members=2, width=16)
ONE = NetworkConfig(members=1, width=16)
POLICY = PolicyNetworkConfig(components=3, network=ONE)
PROVENANCE = {"command": "python", "data": "none"}


def succeeds(matrix: FloatArray, k: FloatArray) -> bool:
    """The rule: the grasp is near the middle of the box, and the box is not far to one side."""
    half, y = matrix[0, SCHEMA.group("box")] / 2, matrix[0, SCHEMA.index("base_y")]
    return bool((abs(k[:2]) < 0.7 * half[:2]).all() and abs(y) < 0.3)


def lift_centered(c: Configuration, box: str, size: tuple[float, float, float], k: FloatArray) -> Configuration:
    """c after the box was lifted; the closing fingers have centered the box along their direction."""
    lying = upright_frame(c.poses[box], size)
    fingers = np.array([-np.sin(k[3]), np.cos(k[3]), 0.0])
    shift = lying.X_WU.rotation().matrix() @ (fingers * (fingers @ k[:3])) + [0.0, 0.0, LIFT]
    pose = c.poses[box] + np.concatenate([np.zeros(4), shift])
    return Configuration(c.q, c.fingers, {**c.poses, box: pose}, box, c.gripper)


def write_attempts(folder: Path, scenes: int = 40, draws: int = 12) -> None:
    """Write picks of boxes, by the middle and by the side, in scenes of the wider kind only."""
    rows = []
    for number in (8 * scene + 5 for scene in range(scenes)):
        spec = training_scene(number)
        rng = np.random.default_rng(number)
        text, boxes = scene_text(spec), sorted(spec.boxes)
        c = Configuration(np.zeros(7), np.zeros(2), {name: spec.boxes[name].X_WO for name in boxes})
        for draw in range(draws):
            action = Action("pick", (boxes[draw % len(boxes)], "table"))
            matrix = Observer(spec).observe(c, action).matrix
            half = matrix[0, SCHEMA.group("box")] / 2
            k = np.append(rng.uniform(-half, half), rng.uniform(-np.pi, np.pi))
            failure = None if succeeds(matrix, k) else Failure.NOT_GRASPED
            after = lift_centered(c, action.args[0], spec.boxes[action.args[0]].size, k)
            attempt = Attempt(action, failure, after, k, MOTION)
            rows.append(AttemptRow(number, text, 0, draw, "uniform", c, attempt))
    folder.mkdir(parents=True, exist_ok=True)
    write(rows, folder / "all.parquet")


def write_untrained(folder: Path) -> Path:
    """Write a folder with a policy, an estimator and dynamics of each skill, with their initial weights."""
    torch.manual_seed(0)
    for skill in ("pick", "place"):
        critic, policy = Classifier(skill, SIZE), POLICY.create(skill)
        arrays = {**arrays_of(policy, "policy."), **arrays_of(critic, "critic.")}
        network = {"policy": asdict(POLICY), "critic": asdict(SIZE)}
        Checkpoint("policy", skill, arrays, network, PROVENANCE, {"auc": 0.5}).save(folder)
        Checkpoint("estimator", skill, arrays, network, PROVENANCE, {}).save(folder)
        dynamics = Dynamics(skill, ONE)
        Checkpoint("dynamics", skill, arrays_of(dynamics), asdict(ONE), PROVENANCE, {}).save(folder)
    return folder


def matrices(count: int = 6, seed: int = 0) -> tuple[torch.Tensor, torch.Tensor]:
    """Random matrices. The rows of an action's objects are present, and some of the others are missing."""
    noise = torch.Generator().manual_seed(seed)
    mask = torch.rand((count, ROWS), generator=noise) < 0.6
    mask[:, [0, 2]] = True
    matrix = torch.randn((count, ROWS, SCHEMA.width), generator=noise)
    sides = matrix[:, :, SCHEMA.group("box")]
    sides.copy_(sides.abs() + 0.1)
    matrix[:, :, SCHEMA.group("support")] = 0.0
    return matrix * torch.from_numpy(SCHEMA.scales.astype(np.float32)) * mask[..., None], mask


def displace(skill: str, count: int, seed: int) -> Batch:
    """Successes after which the box is 8 mm off its nominal pose, across k's yaw, and turned by its width along x."""
    matrix, mask = matrices(count, seed)
    k = torch.randn((count, 4), generator=torch.Generator().manual_seed(seed)) * torch.tensor([0.05, 0.05, 0.05, 2.0])
    target = matrix[:, 0 if skill == "pick" else 2]
    turn = target[:, SCHEMA.index("box_x")]
    zero = torch.zeros(count)
    residual = torch.stack([-0.008 * k[:, 3].sin(), 0.008 * k[:, 3].cos(), zero, turn], dim=-1)
    return Batch(matrix, mask, k, torch.ones(count), nominal(skill, matrix, k) + residual, torch.ones(count, 1))
