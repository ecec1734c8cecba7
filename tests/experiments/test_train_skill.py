"""The training programs, from recorded attempts to a checkpoint that plans."""

import re
from pathlib import Path

import numpy as np
import pytest

from ictamp_drake.core.types import Action, Configuration
from ictamp_drake.experiments import train_estimator, train_skill
from ictamp_drake.experiments.train_estimator import TrainEstimator
from ictamp_drake.experiments.train_skill import TrainSkill
from ictamp_drake.experiments.trainer import main
from ictamp_drake.learning.checkpoint import load
from ictamp_drake.learning.dataset import fingerprint
from ictamp_drake.learning.models import load_skill
from ictamp_drake.learning.networks import FlatNetwork
from ictamp_drake.learning.policies import Squashed
from ictamp_drake.observation.state_matrix import Observer
from ictamp_drake.scenes.training import training_scene
from tests.learning.synthetic import succeeds, write_attempts

QUICK = ["--skills", "pick", "--fit.epochs", "30", "--fit.batch", "128", "--fit.rate", "3e-3"]
SMALL = ["--critic.width", "32", "--critic.members", "2", "--policy.network.network.width", "32"]


def skill(*arguments: str) -> int:
    return main("ictamp_drake.experiments.train_skill", TrainSkill, train_skill.train, [*QUICK, *SMALL, *arguments])


def estimator(*arguments: str) -> int:
    command = [*QUICK, "--network.width", "32", *arguments]
    return main("ictamp_drake.experiments.train_estimator", TrainEstimator, train_estimator.train, command)


@pytest.fixture(scope="module")
def data(tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("attempts")
    write_attempts(folder, scenes=120)
    return folder


@pytest.fixture(scope="module")
def trained(data: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("run")
    assert skill("--data", str(data), "--out", str(folder)) == 0
    assert estimator("--data", str(data), "--out", str(folder), "--policy", str(folder)) == 0
    return folder


def test_what_can_be_learned_is_learned(trained: Path) -> None:
    """The outcome depends on k and on the box's place: the critics see both, P only the place."""
    critics, P = load(trained, "policy", "pick").metrics, load(trained, "estimator", "pick").metrics
    assert critics["auc"] > 0.8
    assert critics["brier_skill"] > 0.2
    assert critics["Q_of_best_of_16"] > critics["Q_of_one_draw"] > critics["base_rate"] + 0.1
    assert 0.55 < P["auc"] < critics["auc"]
    assert P["brier_skill"] < critics["brier_skill"]


def test_the_policy_succeeds_more_often_than_chance(trained: Path) -> None:
    """Judged by the rule itself, in scenes that were not used for training."""
    model = load_skill(trained, "pick")
    rng = np.random.default_rng(0)
    won = possible = 0
    for spec in map(training_scene, range(2005, 2405, 8)):
        c = Configuration(np.zeros(7), np.zeros(2), {name: box.X_WO for name, box in spec.boxes.items()})
        observation = Observer(spec).observe_all([(c, Action("pick", (box, "table"))) for box in spec.boxes])
        for matrix, drawn in zip(observation.matrix, model.draw(observation, 4, rng), strict=True):
            if succeeds(matrix, np.zeros(4)):
                possible += 4
                won += sum(succeeds(matrix, k) for k in drawn)
    assert won / possible > 0.75  # half of uniform draws succeed


def test_the_checkpoint_says_where_it_comes_from(trained: Path, data: Path) -> None:
    for kind in ("policy", "estimator"):
        provenance = load(trained, kind, "pick").provenance  # type: ignore[arg-type]
        assert provenance["command"].startswith("python -m ictamp_drake.experiments.train_")
        assert f"--out {trained}" in provenance["command"]
        assert provenance["data"] == {"fingerprint": fingerprint(data), "attempts": 120 * 12}
        assert provenance["options"]["fit"]["epochs"] == 30
        assert {"commit", "versions"} <= provenance.keys()


def test_the_same_command_again_changes_nothing(trained: Path, data: Path) -> None:
    before = (trained / "pick_estimator.safetensors").read_bytes()
    assert estimator("--data", str(data), "--out", str(trained), "--policy", str(trained)) == 0
    assert (trained / "pick_estimator.safetensors").read_bytes() == before


def test_an_interrupted_program_keeps_the_best_and_goes_on_to_the_same_end(
    trained: Path, data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    saved = 0
    original = train_skill.Course.fit.__globals__["Fit"]._save

    def save_or_interrupt(fit: object) -> None:
        nonlocal saved
        original(fit)
        saved += 1
        if saved in (3, 50):  # in the middle of training the critics, then the policy
            raise KeyboardInterrupt

    monkeypatch.setattr("ictamp_drake.learning.training.Fit._save", save_or_interrupt)
    command = ["--data", str(data), "--out", str(tmp_path)]
    assert skill(*command) == 130
    assert f"the same command with --out {tmp_path} goes on" in capsys.readouterr().out
    assert not (tmp_path / "pick_policy.safetensors").exists()
    while skill(*command) == 130:
        load_skill(tmp_path, "pick")
    final, whole = load(tmp_path, "policy", "pick"), load(trained, "policy", "pick")
    assert saved >= 50
    for name, array in whole.arrays.items():
        np.testing.assert_array_equal(final.arrays[name], array)


def test_the_reference_of_stap_is_trained_by_the_options_that_the_help_names(data: Path, tmp_path: Path) -> None:
    options = re.search(r"`(--critic.kind.*?)`", str(TrainSkill.__doc__), re.DOTALL)
    assert options is not None
    given = [*options[1].split(), "--fit.epochs", "1", "--skills", "pick", "--data", str(data), "--out", str(tmp_path)]
    assert main("ictamp_drake.experiments.train_skill", TrainSkill, train_skill.train, given) == 0
    model = load_skill(tmp_path, "pick")
    assert isinstance(model.policy, Squashed)
    assert isinstance(model.critic.network, FlatNetwork)
    assert model.critic.network.layer_1.weight.shape[0::2] == (2, 256)


def test_an_estimator_learns_from_further_attempts_too(data: Path, trained: Path, tmp_path: Path) -> None:
    more = tmp_path / "more"
    write_attempts(more, scenes=8)
    given = ["--data", str(data), "--policy", str(trained), "--fit.epochs", "2", "--out", str(tmp_path)]
    assert estimator(*given, "--also", str(more)) == 0
    found, alone = load(tmp_path, "estimator", "pick"), load(trained, "estimator", "pick")
    assert found.provenance["also"] == [fingerprint(more)]
    assert found.provenance["data"] == alone.provenance["data"]
    assert found.metrics["count"] == alone.metrics["count"]
    assert estimator(*given) == 2  # the training data is part of the run's purpose


@pytest.mark.parametrize(
    ("arguments", "place"),
    [
        (["--data", "nowhere"], "nowhere: "),
        (["--data", "{data}", "--sampler", "policy"], ""),
        (["--data", "{data}", "--also", "nowhere"], "nowhere: "),
        (["--data", "{data}", "--skills", "push"], "skills: "),
        (["--data", "{data}", "--fit.batch", "0"], "fit.batch: "),
        (["--data", "{data}", "--network.members", "0"], "members: "),
        (["--data", "{data}", "--out", "{out}", "--fit.seed", "3"], "{out}"),
    ],
)
def test_mistakes_are_answered_with_a_sentence(
    data: Path, trained: Path, capsys: pytest.CaptureFixture[str], arguments: list[str], place: str
) -> None:
    given = [each.format(data=data, out=trained) for each in arguments]
    assert estimator(*given) == 2
    error = capsys.readouterr().err
    assert error.startswith(place.format(out=trained))
    assert error.count("\n") == 1
