"""Quality of estimated probabilities, and Platt's calibration."""

import numpy as np
from numpy.typing import NDArray
from scipy.optimize import minimize
from scipy.special import expit
from sklearn.metrics import brier_score_loss, log_loss, roc_auc_score  # type: ignore[import-untyped]

from ictamp_drake.core.types import FloatArray

BINS = 15


def metrics(P: FloatArray, success: FloatArray) -> dict[str, float]:
    """Compare probabilities with outcomes of 0 and 1, both of shape (n,).

    Returns:
        Count n and base rate; AUC; Brier score and its skill, 1 - Brier / Brier of the base rate; ECE; log loss.
    """
    rate, brier = float(success.mean()), float(brier_score_loss(success, P))
    return {
        "count": float(len(P)),
        "base_rate": rate,
        "auc": float(roc_auc_score(success, P)),
        "brier": brier,
        "brier_skill": 1 - brier / (rate * (1 - rate)),
        "ece": calibration_error(P, success),
        "log_loss": float(log_loss(success, np.clip(P, 1e-7, 1 - 1e-7))),
    }


def calibration_error(P: FloatArray, success: FloatArray) -> float:
    """Expected calibration error (ECE): mean distance of probability and frequency over bins, see `bins`."""
    surplus = np.bincount(bins(P, np.ones(len(P))), P - success)
    return float(np.abs(surplus).sum() / len(P))


def bins(P: FloatArray, attempts: FloatArray) -> NDArray[np.intp]:
    """Bin of each case, shape (n,); bins hold equal numbers of attempts, as far as equal estimates stay together."""
    values, place = np.unique(P, return_inverse=True)
    mass = np.bincount(place, attempts, len(values))
    middle = (np.cumsum(mass) - mass / 2) / mass.sum()
    return np.minimum(middle * BINS, BINS - 1).astype(np.intp)[place]


def platt(logits: FloatArray, success: FloatArray) -> tuple[float, float]:
    """Fit slope and offset by maximum likelihood of the mean over members of sigmoid(slope * logit + offset).

    Args:
        logits: Logits of the members, shape (members, n).
        success: Outcomes, 0 or 1, shape (n,).
    """

    def cost(numbers: FloatArray) -> float:
        P = np.clip(expit(np.exp(numbers[0]) * logits + numbers[1]).mean(axis=0), 1e-7, 1 - 1e-7)
        return -float(np.mean(success * np.log(P) + (1 - success) * np.log1p(-P)))

    slope, offset = minimize(cost, np.zeros(2), bounds=[(-3, 3), (-5, 5)]).x
    return float(np.exp(slope)), float(offset)
