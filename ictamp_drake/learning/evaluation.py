"""Calibration and test of trained networks."""

import numpy as np
import torch

from ictamp_drake.core.types import FloatArray
from ictamp_drake.learning.batches import Batch
from ictamp_drake.learning.classifier import Classifier
from ictamp_drake.learning.dynamics import Dynamics, error, nominal
from ictamp_drake.learning.metrics import metrics, platt


def calibrate(classifier: Classifier, batch: Batch) -> None:
    """Set Platt's numbers by held-out attempts."""
    with torch.inference_mode():
        logits = classifier(batch.matrix, batch.mask, batch.k).numpy().astype(np.float64)
    slope, offset = platt(logits, _outcomes(batch))
    classifier.platt.copy_(torch.tensor([slope, offset]))


def evaluate_classifier(classifier: Classifier, batch: Batch) -> dict[str, float]:
    """Figures of `metrics` on held-out attempts."""
    with torch.inference_mode():
        P = classifier.belief(batch.matrix, batch.mask, batch.k).mean.numpy().astype(np.float64)
    return metrics(P, _outcomes(batch))


def evaluate_dynamics(dynamics: Dynamics, batch: Batch) -> dict[str, float]:
    """How far boxes of held-out successes are from where dynamics put them, and from where kinematics alone do.

    Returns:
        Count n; mean and median of position errors [m] and of yaw errors [rad], of both.
    """
    with torch.inference_mode():
        found = {
            "": dynamics(batch.matrix, batch.mask, batch.k),
            "nominal_": nominal(dynamics.skill, batch.matrix, batch.k),
        }
        figures = {"count": float(len(batch))}
        for prefix, pose in found.items():
            wrong = error(pose, batch.moved)
            for name, size in ("position", wrong[:, :3].norm(dim=-1)), ("yaw", wrong[:, 3].abs()):
                figures[f"{prefix}{name}_mean"] = size.mean().item()
                figures[f"{prefix}{name}_median"] = size.median().item()
    return figures


def _outcomes(batch: Batch) -> FloatArray:
    return batch.success.numpy().astype(np.float64)
