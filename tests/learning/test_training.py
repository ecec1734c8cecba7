"""The training loop learns, stops, continues, and refuses to continue from unsuitable folders."""

import json
from pathlib import Path

import numpy as np
import pytest
import torch

from ictamp_drake.core.errors import Code
from ictamp_drake.learning.batches import split
from ictamp_drake.learning.classifier import Classifier
from ictamp_drake.learning.dataset import load
from ictamp_drake.learning.evaluation import calibrate, evaluate_classifier
from ictamp_drake.learning.models import arrays_of
from ictamp_drake.learning.objectives import Classification
from ictamp_drake.learning.training import LOG, STATE, Data, Figures, Fit, FitConfig, start
from tests.learning.synthetic import SIZE, write_attempts
from tests.refusals import refusal

CONFIG = FitConfig(epochs=6, batch=64, rate=1e-2)


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Data:
    folder = tmp_path_factory.mktemp("attempts")
    write_attempts(folder)
    parts = split(load(folder, "pick"))
    return Data(parts.training.with_bootstrap_weights(SIZE.members, np.random.default_rng(0)), parts.validation)


def new(data: Data, folder: Path, config: FitConfig = CONFIG, **purpose: object) -> tuple[Fit, Classifier]:
    """Start like a program that only knows the folder."""
    start(config.seed)
    critic = Classifier("pick", SIZE)
    return Fit(Classification(critic), data, config, folder=folder, purpose=purpose), critic


def interrupt_after(epochs: int, fit: Fit):  # type: ignore[no-untyped-def]
    def report(_: Figures) -> None:
        if len(fit.history) == epochs:
            raise KeyboardInterrupt

    return report


def same(one: Classifier, other: Classifier) -> bool:
    return all(np.array_equal(array, arrays_of(other)[name]) for name, array in arrays_of(one).items())


def test_an_interrupted_run_goes_on_as_if_it_had_not_been(data: Data, tmp_path: Path) -> None:
    fit, whole = new(data, tmp_path / "whole")
    assert fit.run()
    for epochs in (1, 4):
        part, _ = new(data, tmp_path / "parts")
        assert not part.run(interrupt_after(epochs, part))
    rest, resumed = new(data, tmp_path / "parts")
    assert rest.run()
    assert rest.history == fit.history
    assert len(fit.history) == CONFIG.epochs
    assert same(resumed, whole)


def test_a_finished_run_is_only_read(data: Data, tmp_path: Path) -> None:
    fit, whole = new(data, tmp_path)
    fit.run()
    before = (tmp_path / STATE).read_bytes()
    again, loaded = new(data, tmp_path)
    assert again.run()
    assert same(loaded, whole)
    assert (tmp_path / STATE).read_bytes() == before


def test_the_best_epoch_counts_and_training_stops_when_none_is_better(data: Data, tmp_path: Path) -> None:
    config = FitConfig(epochs=40, batch=16, rate=0.05, patience=3)
    fit, critic = new(data, tmp_path, config)
    assert fit.run()
    losses = [figures["loss"] for figures in fit.history]
    assert len(losses) == int(np.argmin(losses)) + 1 + 3 < 40
    validation = Classification(critic).validate(data.validation, torch.Generator())
    assert validation["loss"] == pytest.approx(min(losses), rel=1e-6)
    assert not critic.training


def test_ctrl_c_keeps_the_best_so_far(data: Data, tmp_path: Path) -> None:
    fit, critic = new(data, tmp_path)
    assert not fit.run(interrupt_after(2, fit))
    validation = Classification(critic).validate(data.validation, torch.Generator())
    assert validation["loss"] == pytest.approx(min(figures["loss"] for figures in fit.history), rel=1e-6)


def test_the_log_has_a_line_an_epoch(data: Data, tmp_path: Path) -> None:
    fit, _ = new(data, tmp_path)
    fit.run()
    lines = [json.loads(line) for line in (tmp_path / LOG).read_text().splitlines()]
    assert lines == fit.history
    assert [line["epoch"] for line in lines] == list(range(CONFIG.epochs))
    assert lines[-1]["training_loss"] < lines[0]["training_loss"]


def test_seeds_make_a_difference(data: Data, tmp_path: Path) -> None:
    one, other = new(data, tmp_path / "0"), new(data, tmp_path / "1", FitConfig(epochs=2, seed=1))
    for fit, _ in (one, other):
        fit.run()
    assert not same(one[1], other[1])


def test_a_run_with_other_options_or_attempts_is_refused(data: Data, tmp_path: Path) -> None:
    fit, _ = new(data, tmp_path, attempts="abc")
    fit.run(interrupt_after(1, fit))
    for config, fingerprint in ((FitConfig(epochs=7), "abc"), (CONFIG, "abd")):
        with refusal(Code.OTHER_OPTIONS, file=tmp_path / STATE):
            new(data, tmp_path, config, attempts=fingerprint)[0].run()
    (tmp_path / STATE).write_bytes(b"x")
    with refusal(Code.DAMAGED, file=tmp_path / STATE):
        new(data, tmp_path, attempts="abc")[0].run()


def test_calibration_lowers_the_loss_it_is_made_by(data: Data, tmp_path: Path) -> None:
    fit, critic = new(data, tmp_path)
    fit.run()
    before = evaluate_classifier(critic, data.validation)
    calibrate(critic, data.validation)
    after = evaluate_classifier(critic, data.validation)
    assert after["log_loss"] < before["log_loss"]
    assert after["auc"] == pytest.approx(before["auc"], abs=0.02)
