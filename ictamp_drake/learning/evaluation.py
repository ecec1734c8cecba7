"""Calibration and test of trained classifiers."""

import numpy as np
import torch

from ictamp_drake.core.types import FloatArray
from ictamp_drake.learning.batches import Batch
from ictamp_drake.learning.classifier import Classifier
from ictamp_drake.learning.metrics import metrics, platt


def calibrate(classifier: Classifier, batch: Batch) -> None:
    """Set Platt's numbers by held-out attempts."""
    with torch.inference_mode():
        logits = classifier(batch.matrix, batch.mask, batch.k).numpy().astype(np.float64)
    slope, offset = platt(logits, _outcomes(batch))
    classifier.platt.copy_(torch.tensor([slope, offset]))


def judged(classifier: Classifier, batch: Batch) -> dict[str, float]:
    """Figures of `metrics` on held-out attempts."""
    with torch.inference_mode():
        P = classifier.belief(batch.matrix, batch.mask, batch.k).mean.numpy().astype(np.float64)
    return metrics(P, _outcomes(batch))


def _outcomes(batch: Batch) -> FloatArray:
    return batch.success.numpy().astype(np.float64)
