"""Metrics of probabilities."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from scipy.special import expit

from ictamp_drake.learning.metrics import calibration_error, metrics, platt

RNG = np.random.default_rng(0)
TRUTH = RNG.uniform(size=20_000)
OUTCOME = (RNG.uniform(size=20_000) < TRUTH).astype(np.float64)


def test_the_truth_is_calibrated_and_skilful() -> None:
    found = metrics(TRUTH, OUTCOME)
    assert found["ece"] < 0.02
    assert found["brier"] == pytest.approx(1 / 6, abs=0.005)  # mean of p (1 - p) for p uniform in [0, 1]
    assert found["brier_skill"] == pytest.approx(1 / 3, abs=0.02)
    assert found["auc"] == pytest.approx(5 / 6, abs=0.01)
    assert found["base_rate"] == OUTCOME.mean()


def test_the_base_rate_has_no_skill() -> None:
    found = metrics(np.full(len(OUTCOME), OUTCOME.mean()), OUTCOME)
    assert found["brier_skill"] == pytest.approx(0.0, abs=1e-9)
    assert found["auc"] == 0.5
    assert found["ece"] < 0.02


@given(st.floats(0, 1), st.floats(0, 1))
def test_one_probability_errs_by_its_distance_from_the_frequency(P: float, rate: float) -> None:
    success = (np.arange(15) < round(15 * rate)).astype(np.float64)
    error = calibration_error(np.full(15, P), success)
    assert abs(P - success.mean()) - 1e-9 <= error <= 1


def test_being_sure_and_wrong_is_the_greatest_error() -> None:
    outcome = np.repeat([0.0, 1.0], [30, 15])
    assert calibration_error(1 - outcome, outcome) == 1.0


def test_platts_numbers_undo_what_was_done_to_the_logits() -> None:
    logits = np.log(TRUTH / (1 - TRUTH))
    slope, offset = platt(np.stack([(logits + 0.5) / 3] * 2), OUTCOME)
    assert slope == pytest.approx(3.0, rel=0.05)
    assert offset == pytest.approx(-0.5, abs=0.05)
    assert calibration_error(expit(slope * (logits + 0.5) / 3 + offset), OUTCOME) < 0.02
