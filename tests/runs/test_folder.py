"""The run folder: new ones, continued ones, and all that cannot be continued."""

import os
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from ictamp_drake.core.errors import IctampError
from ictamp_drake.planning.els import ElsConfig
from ictamp_drake.planning.proportional import ProportionalConfig
from ictamp_drake.runs.folder import opened
from ictamp_drake.runs.options import Conduct, Method, Planners
from ictamp_drake.world.simulate import PhysicsConfig

WORK = {"program": "packing", "level": "easy"}
OPTIONS = {"options": Method().decisive}


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def start(method: Method | None = None, work: dict[str, object] | None = None, **conduct: object) -> Path:
    about = {**(work or WORK), "options": (method or Method()).decisive}
    with opened("packing-easy", about, Conduct(**conduct)) as folder:  # type: ignore[arg-type]
        return folder


def test_a_new_run_gets_a_folder_of_its_own() -> None:
    folder = start()
    assert folder.parent == Path("runs")
    assert folder.name.startswith("packing-easy-")


def test_every_session_is_noted() -> None:
    out = Path("out")
    start(out=out)
    start(out=out, grace=7.0)
    config = yaml.safe_load((out / "config.yaml").read_text())
    assert [session["conduct"]["grace"] for session in config["sessions"]] == [Conduct().grace, 7.0]
    assert config["options"]["skills"]["draws"] == Method().skills.draws


def test_resume_takes_the_latest_run() -> None:
    for age, name in enumerate(("packing-easy-1", "packing-easy-2", "packing-easy-0")):
        start(out=Path("runs") / name)
        os.utime(Path("runs") / name / "config.yaml", (age, age))
    assert start(resume=True) == Path("runs/packing-easy-0")


def test_resume_without_a_run_is_refused() -> None:
    with pytest.raises(IctampError, match=r"^runs/packing-easy-\*: there is no run to resume"):
        start(resume=True)
    with pytest.raises(IctampError, match=r"^out: there is no run to resume"):
        start(resume=True, out=Path("out"))
    assert not Path("out").exists()


def test_an_empty_folder_can_be_used() -> None:
    Path("out").mkdir()
    assert start(out=Path("out")) == Path("out")


def test_a_folder_of_something_else_is_left_alone() -> None:
    Path("out").mkdir()
    (Path("out") / "thesis.tex").touch()
    with pytest.raises(IctampError, match=r"^out: exists and is not the folder of a run .* choose another --out$"):
        start(out=Path("out"))
    assert [path.name for path in Path("out").iterdir()] == ["thesis.tex"]


def test_a_file_is_no_folder() -> None:
    Path("out").touch()
    with pytest.raises(IctampError, match=r"^out: exists and is not the folder of a run"):
        start(out=Path("out"))


@pytest.mark.parametrize(
    ("method", "difference"),
    [
        (Method(seed=3), "--seed 3, since it was made with 0"),
        (Method(sampler="uniform"), '--sampler "uniform", since it was made with "policy"'),
        (Method(physics=PhysicsConfig(time_step=0.001)), "--physics.time-step 0.001, since it was made with"),
        (
            Method(planners=Planners(completion_tree=ProportionalConfig(W=2.5))),
            "--planners.completion-tree.W 2.5, since it was made with",
        ),
    ],
)
def test_another_method_is_refused_with_the_option_and_both_values(method: Method, difference: str) -> None:
    start(out=Path("out"))
    before = Path("out/config.yaml").read_text()
    with pytest.raises(IctampError) as error:
        start(method, out=Path("out"))
    assert str(error.value).startswith(f"out: cannot be continued with {difference}")
    assert Path("out/config.yaml").read_text() == before


def test_a_constant_of_what_is_not_chosen_may_change() -> None:
    out = Path("out")
    start(out=out)
    assert start(Method(planners=Planners(els=ElsConfig(p_w=3.0))), out=out) == out


def test_other_problems_are_refused() -> None:
    start(out=Path("out"))
    with pytest.raises(IctampError, match='level "hard", since it was made with "easy"'):
        start(work={**WORK, "level": "hard"}, out=Path("out"))


def test_an_option_that_the_old_run_did_not_know_is_named() -> None:
    start(out=Path("out"))
    config = yaml.safe_load(Path("out/config.yaml").read_text())
    del config["options"]["sampler"]
    Path("out/config.yaml").write_text(yaml.safe_dump(config))
    with pytest.raises(IctampError, match='--sampler "policy", since it was made with null'):
        start(out=Path("out"))


def test_a_folder_in_use_is_refused() -> None:
    conduct = Conduct(out=Path("out"))
    with (
        opened("packing-easy", {**WORK, **OPTIONS}, conduct),
        pytest.raises(IctampError, match="another process is at work"),
    ):
        start(out=Path("out"))
    assert start(out=Path("out")) == Path("out")


def test_how_a_run_is_carried_out_may_change() -> None:
    out = Path("out")
    start(out=out)
    for conduct in (replace(Conduct(out=out), artefacts="none"), Conduct(out=out, grace=1.0, resume=True)):
        assert start(**vars(conduct)) == out


def compared(**strategies: float) -> dict[str, object]:
    """What a comparison is about, of which each strategy has one option."""
    return {"program": "runner", "strategies": {name: {"time_limit": limit} for name, limit in strategies.items()}}


def test_strategies_may_be_added_but_not_changed() -> None:
    conduct = Conduct(out=Path("out"))
    for strategies in ({"els": 60.0, "stap": 60.0}, {"els": 60.0, "uniform": 60.0}):
        with opened("runner", compared(**strategies), conduct):
            pass
    config = yaml.safe_load(Path("out/config.yaml").read_text())
    assert list(config["strategies"]) == ["els", "stap", "uniform"]
    assert len(config["sessions"]) == 2
    with (
        pytest.raises(IctampError, match=r"strategies.stap.time_limit 30.0, since it was made with 60.0"),
        opened("runner", compared(stap=30.0), conduct),
    ):
        pass


def test_a_torn_record_is_dropped_when_a_run_is_continued() -> None:
    start(out=Path("out"))
    Path("out/results.jsonl").write_text('{"whole": 1}\n{"to')
    start(out=Path("out"))
    assert Path("out/results.jsonl").read_text() == '{"whole": 1}\n'
