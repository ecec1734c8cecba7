"""The program that trains dynamics, from recorded attempts to a checkpoint that predicts."""

from pathlib import Path

import numpy as np
import pytest

from ictamp_drake.experiments import train_dynamics
from ictamp_drake.experiments.train_dynamics import TrainDynamics
from ictamp_drake.experiments.trainer import main
from ictamp_drake.learning.checkpoint import load
from ictamp_drake.learning.dataset import load as load_attempts
from ictamp_drake.learning.models import load_dynamics
from ictamp_drake.observation.state_matrix import Observation
from tests.learning.synthetic import write_attempts


def dynamics(*arguments: str) -> int:
    quick = ["--skills", "pick", "--fit.epochs", "60", "--fit.batch", "64", "--fit.rate", "3e-3"]
    return main("ictamp_drake.experiments.train_dynamics", TrainDynamics, train_dynamics.train, [*quick, *arguments])


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("attempts")
    write_attempts(folder, scenes=120)
    return folder


@pytest.fixture(scope="module")
def trained(data: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run")
    assert dynamics("--data", str(data), "--out", str(folder)) == 0
    return folder


def test_what_the_fingers_do_to_the_box_is_learned(trained: Path) -> None:
    metrics = load(trained, "dynamics", "pick").metrics
    assert metrics["position_mean"] < metrics["nominal_position_mean"] / 3
    assert metrics["position_median"] < metrics["nominal_position_median"] / 3
    assert metrics["nominal_yaw_mean"] < 1e-3
    assert metrics["yaw_mean"] < 0.02


def test_only_successes_are_learned_from_and_tested_with(trained: Path, data: Path) -> None:
    attempts = load_attempts(data, "pick")
    wins = attempts.select(attempts.success)
    assert load(trained, "dynamics", "pick").metrics["count"] < len(wins) / 4
    moved = load_dynamics(trained, "pick").predict(Observation(wins.matrix, wins.mask), wins.k.astype(np.float64))
    assert np.linalg.norm((moved - wins.moved)[:, :3], axis=1).mean() < 0.002


def test_the_same_command_again_changes_nothing(trained: Path, data: Path) -> None:
    before = (trained / "pick_dynamics.safetensors").read_bytes()
    assert dynamics("--data", str(data), "--out", str(trained)) == 0
    assert (trained / "pick_dynamics.safetensors").read_bytes() == before


def test_too_few_attempts_are_answered_with_a_sentence(data: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert dynamics("--data", str(data), "--sampler", "policy") == 2
    assert capsys.readouterr().err.count("\n") == 1
