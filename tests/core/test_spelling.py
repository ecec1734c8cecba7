"""Older spellings can still be read, and are written with today's spelling."""

from pathlib import Path

import numpy as np
import pytest
import yaml

from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.spelling import respell_option, respell_options, spellings
from ictamp_drake.experiments.strategies import methods
from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.folder import open_run_folder
from ictamp_drake.runs.records import Record, append, read_records
from ictamp_drake.scenes.spec import load_scene, to_yaml
from ictamp_drake.tamp.method import Method
from tests.runs.programs import SCENE

RESULTS = Path(__file__).parents[2] / "benchmarks" / "results" / "default"


def test_options_are_named_as_today() -> None:
    assert respell_option("--samplers.optimisation.restarts=3") == "--samplers.optimization.restarts=3"
    assert respell_option("--walk.sources.optimisation") == "--walk.sources.optimization"
    assert respell_option("optimisation") == "optimisation"
    assert spellings("optimisation") == spellings("optimization") == ["optimization", "optimisation"]


def test_a_sampler_is_chosen_by_either_name() -> None:
    assert Method(sampler="optimisation") == Method(sampler="optimization")


def test_a_strategy_is_chosen_by_either_name() -> None:
    older, today = (methods("default", [f"optimi{letter}ation-constant"], [0]) for letter in "sz")
    assert older == today
    (mine,) = methods("default", ["mine=--sampler optimisation --samplers.optimisation.restarts 3"], [0])["mine"]
    assert mine.sampler_config.restarts == 3  # type: ignore[attr-defined]


def test_a_scene_says_color_or_colour(tmp_path: Path) -> None:
    (tmp_path / "scene.yaml").write_text(SCENE.replace("color", "colour"))
    spec = load_scene(tmp_path / "scene.yaml")
    (tmp_path / "scene.yaml").write_text(to_yaml(spec))
    assert load_scene(tmp_path / "scene.yaml") == spec
    assert "color:" in to_yaml(spec)
    assert "colour" not in to_yaml(spec)
    box = next(iter(yaml.safe_load(SCENE)["boxes"]))
    both = yaml.safe_load(to_yaml(spec))
    both["boxes"][box]["colour"] = [0, 0, 0]
    (tmp_path / "scene.yaml").write_text(yaml.safe_dump(both))
    with pytest.raises(IctampError) as refusal:
        load_scene(tmp_path / "scene.yaml")
    assert refusal.value.code is Code.REPEATED


def test_runs_of_the_older_spelling_are_continued(tmp_path: Path) -> None:
    (method,) = methods("default", ["optimization-constant"], [0])["optimization-constant"]
    decisive = {name: value for name, value in method.decisive.items() if name != "seed"}
    older = dict(decisive, sampler="optimisation", samplers={"optimisation": decisive["samplers"]["optimization"]})
    conduct = Conduct(out=tmp_path / "run")
    with open_run_folder("runner", {"strategies": {"optimisation-constant": older}}, conduct) as folder:
        append(
            Record(
                problem="a",
                strategy="optimisation-constant",
                level=None,
                seed=0,
                stop_reason="STOPPED",
                planning_time_s=1.0,
            ),
            folder / "results.jsonl",
        )
        (folder / "optimisation-constant").mkdir()
    text = (folder / "config.yaml").read_text()
    assert "optimisation-constant" in text
    with open_run_folder("runner", {"strategies": {"optimization-constant": decisive}}, conduct):
        assert list(read_records(folder / "results.jsonl")) == ["optimization-constant/0/a"]
    assert list(yaml.safe_load((folder / "config.yaml").read_text())["strategies"]) == ["optimization-constant"]
    assert (folder / "optimization-constant").is_dir()


def test_committed_results_are_those_of_todays_strategies() -> None:
    records = read_records(RESULTS / "results.jsonl").values()
    assert {record.strategy for record in records} == set(methods("default", (), [0]))
    config = respell_options(yaml.safe_load((RESULTS / "config.yaml").read_text()))
    for name, (method,) in methods("default", (), [0]).items():
        assert config["strategies"][name]["sampler"] == method.sampler
        np.testing.assert_equal(set(config["strategies"][name]["samplers"]), {method.sampler})
