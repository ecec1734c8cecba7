"""Calibration and evaluation of trained networks."""

import numpy as np
import torch

from ictamp_drake.core.types import FloatArray
from ictamp_drake.learning.batches import Batch
from ictamp_drake.learning.classifier import Classifier
from ictamp_drake.learning.dynamics import Dynamics, error, nominal
from ictamp_drake.learning.metrics import metrics, platt


def calibrate(classifier: Classifier, batch: Batch) -> None:
    """Fit the two numbers of Platt's method to held-out attempts."""
    with torch.inference_mode():
        logits = classifier(batch.matrix, batch.mask, batch.k).numpy().astype(np.float64)
    slope, offset = platt(logits, _outcomes(batch))
    classifier.platt.copy_(torch.tensor([slope, offset]))


def evaluate_classifier(classifier: Classifier, batch: Batch) -> dict[str, float]:
    """Compute the figures of `metrics` on held-out attempts."""
    with torch.inference_mode():
        P = classifier.belief(batch.matrix, batch.mask, batch.k).mean.numpy().astype(np.float64)
    return metrics(P, _outcomes(batch))


def evaluate_dynamics(dynamics: Dynamics, batch: Batch) -> dict[str, float]:
    """Measure the errors of predicted box poses on held-out successes, by dynamics and by kinematics alone.

    Returns:
        Count n; mean and median of position errors [m] and of yaw errors [rad], for both predictions.
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
