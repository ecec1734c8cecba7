"""Run folders: new ones, continued ones, and those that cannot be continued."""

import os
from dataclasses import replace
from pathlib import Path

import pytest
import yaml

from ictamp_drake.core.decoding import decode
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.reading import parse
from ictamp_drake.planning.els import ElsConfig
from ictamp_drake.planning.proportional import ProportionalConfig
from ictamp_drake.runs.conduct import Conduct
from ictamp_drake.runs.folder import open_run_folder
from ictamp_drake.runs.jobs import Problem
from ictamp_drake.scenes.spec import SceneSpec
from ictamp_drake.tamp.method import Method, Planners
from ictamp_drake.world.config import PhysicsConfig
from tests.refusals import refusal
from tests.runs.programs import SCENE

WORK = {"program": "packing", "level": "easy"}
OPTIONS = {"options": Method().decisive}


@pytest.fixture(autouse=True)
def _here(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.chdir(tmp_path)


def start(method: Method | None = None, work: dict[str, object] | None = None, **conduct: object) -> Path:
    about = {**(work or WORK), "options": (method or Method()).decisive}
    with open_run_folder("packing-easy", about, Conduct(**conduct)) as folder:  # type: ignore[arg-type]
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
    names = [f"packing-easy-20261124-13305{second}" for second in (1, 2, 0)]
    for age, name in enumerate(names):
        start(out=Path("runs") / name)
        os.utime(Path("runs") / name / "config.yaml", (age, age))
    assert start(resume=True) == Path("runs") / names[-1]


def test_resume_takes_no_run_of_a_name_that_only_begins_the_same() -> None:
    start(out=Path("runs/packing-easy-high-20261124-133059"))
    with refusal(Code.NO_RUN):
        start(resume=True)


def test_resume_takes_a_name_literally() -> None:
    start(out=Path("runs/desk1-20261124-133059"))
    start(out=Path("runs/desk[1]-20261124-133058"))
    with open_run_folder("desk[1]", {**WORK, **OPTIONS}, Conduct(resume=True)) as folder:
        assert folder == Path("runs/desk[1]-20261124-133058")


def test_resume_without_a_run_is_refused() -> None:
    with refusal(Code.NO_RUN, file="runs/packing-easy-*"):
        start(resume=True)
    with refusal(Code.NO_RUN, file="out"):
        start(resume=True, out=Path("out"))
    assert not Path("out").exists()


def test_an_empty_folder_can_be_used() -> None:
    Path("out").mkdir()
    assert start(out=Path("out")) == Path("out")


def test_a_folder_of_something_else_is_left_alone() -> None:
    Path("out").mkdir()
    (Path("out") / "thesis.tex").touch()
    with refusal(Code.NOT_A_RUN, file="out"):
        start(out=Path("out"))
    assert [path.name for path in Path("out").iterdir()] == ["thesis.tex"]


def test_a_folder_in_which_a_run_was_killed_at_once_can_be_used() -> None:
    Path("out").mkdir()
    for name in (".lock", ".config.yaml.123"):
        (Path("out") / name).touch()
    assert start(out=Path("out")) == Path("out")


def test_a_folder_below_a_file_is_refused() -> None:
    Path("file").touch()
    with refusal(Code.NOT_WRITABLE, file="file/out"):
        start(out=Path("file/out"))


@pytest.mark.skipif(os.geteuid() == 0, reason="root writes anywhere")
def test_a_folder_that_cannot_be_written_is_refused() -> None:
    Path("out").mkdir(mode=0o555)
    with refusal(Code.NOT_WRITABLE, file="out"):
        start(out=Path("out"))


@pytest.mark.parametrize(
    ("content", "code", "field"),
    [
        (b"", Code.WRONG_TYPE, ""),
        (b"a: [", Code.NOT_YAML, ""),
        (b"\xff", Code.NOT_TEXT, ""),
        (b"strategies: [els]", Code.WRONG_TYPE, "strategies"),
        (b"sessions: 3", Code.WRONG_TYPE, "sessions"),
    ],
)
def test_a_broken_configuration_is_named(content: bytes, code: Code, field: str) -> None:
    Path("out").mkdir()
    Path("out/config.yaml").write_bytes(content)
    with refusal(code, field, file="out/config.yaml"):
        start(out=Path("out"))


@pytest.mark.parametrize("out", [300 * "a", 1000 * "long/", "with\0nul", f"out/{300 * 'a'}", 2000 * "a/"])
@pytest.mark.parametrize("resume", [False, True])
def test_a_path_that_the_system_refuses_is_refused_in_a_short_sentence(out: str, resume: bool) -> None:
    Path("out").mkdir()
    with pytest.raises(IctampError) as caught:
        start(out=Path(out), resume=resume)
    assert caught.value.code in (Code.NOT_WRITABLE, Code.TOO_DEEP, Code.NO_RUN)
    assert len(str(caught.value)) < 500
    assert "\0" not in str(caught.value) or resume


@pytest.mark.parametrize("name", [".lock", "results.jsonl", "config.yaml"])
def test_a_folder_in_the_place_of_a_file_of_the_run_is_refused(name: str) -> None:
    start(out=Path("out"))
    (Path("out") / name).unlink(missing_ok=True)
    (Path("out") / name).mkdir()
    with pytest.raises(IctampError):
        start(out=Path("out"))


@pytest.mark.parametrize(
    "name", ["results.jsonl", "config.yaml", "index.html", ".hidden", "..", "", "a/b", "a\0b", 201 * "a", 101 * "ä"]
)
def test_a_problem_does_not_take_the_name_of_anything_else(name: str) -> None:
    with refusal(Code.BAD_NAME, "name", value=name):
        Problem(name, decode(SceneSpec, parse(SCENE)))


def test_a_problem_may_have_any_other_name() -> None:
    for name in ("cost_$5_to_$10", "results.jsonl.old", 200 * "a", "with space", "äöü"):
        assert Problem(name, decode(SceneSpec, parse(SCENE))).name == name


def test_a_file_is_no_folder() -> None:
    Path("out").touch()
    with refusal(Code.NOT_A_RUN, file="out"):
        start(out=Path("out"))


@pytest.mark.parametrize(
    ("method", "option", "value"),
    [
        (Method(seed=3), "seed", 3),
        (Method(sampler="uniform"), "sampler", "uniform"),
        (Method(physics=PhysicsConfig(time_step=0.001)), "physics.time-step", 0.001),
        (Method(planners=Planners(completion_tree=ProportionalConfig(W=2.5))), "planners.completion-tree.W", 2.5),
    ],
)
def test_another_method_is_refused_with_the_option(method: Method, option: str, value: object) -> None:
    start(out=Path("out"))
    before = Path("out/config.yaml").read_text()
    with refusal(Code.OTHER_OPTIONS, option, file="out", value=value):
        start(method, out=Path("out"))
    assert Path("out/config.yaml").read_text() == before


def test_a_constant_of_what_is_not_chosen_may_change() -> None:
    out = Path("out")
    start(out=out)
    assert start(Method(planners=Planners(els=ElsConfig(p_w=3.0))), out=out) == out


def test_other_problems_are_refused() -> None:
    start(out=Path("out"))
    with refusal(Code.OTHER_OPTIONS, "level", value="hard"):
        start(work={**WORK, "level": "hard"}, out=Path("out"))


def test_an_option_that_the_old_run_did_not_know_is_named() -> None:
    start(out=Path("out"))
    config = yaml.safe_load(Path("out/config.yaml").read_text())
    del config["options"]["sampler"]
    Path("out/config.yaml").write_text(yaml.safe_dump(config))
    with refusal(Code.OTHER_OPTIONS, "sampler", value="policy"):
        start(out=Path("out"))


def test_a_folder_in_use_is_refused() -> None:
    conduct = Conduct(out=Path("out"))
    with (
        open_run_folder("packing-easy", {**WORK, **OPTIONS}, conduct),
        refusal(Code.IN_USE, file="out"),
    ):
        start(out=Path("out"))
    assert start(out=Path("out")) == Path("out")


def test_how_a_run_is_carried_out_may_change() -> None:
    out = Path("out")
    start(out=out)
    for conduct in (replace(Conduct(out=out), artefacts="none"), Conduct(out=out, grace=1.0, resume=True)):
        assert start(**vars(conduct)) == out


def comparison_config(what: str, **values: float) -> dict[str, object]:
    """Configuration of a comparison, with one value for each strategy or scene."""
    return {"program": "runner", what: {name: {"figure": value} for name, value in values.items()}}


@pytest.mark.parametrize("what", ["strategies", "scenes"])
def test_strategies_and_scenes_may_be_added_but_not_changed(what: str) -> None:
    conduct = Conduct(out=Path("out"))
    for values in ({"one": 60.0, "two": 60.0}, {"one": 60.0, "three": 60.0}):
        with open_run_folder("runner", comparison_config(what, **values), conduct):
            pass
    config = yaml.safe_load(Path("out/config.yaml").read_text())
    assert list(config[what]) == ["one", "two", "three"]
    assert len(config["sessions"]) == 2
    with (
        refusal(Code.OTHER_OPTIONS, f"{what}.two.figure", value=30.0),
        open_run_folder("runner", comparison_config(what, two=30.0), conduct),
    ):
        pass


def test_a_torn_record_is_dropped_when_a_run_is_continued() -> None:
    start(out=Path("out"))
    Path("out/results.jsonl").write_text('{"whole": 1}\n{"to')
    start(out=Path("out"))
    assert Path("out/results.jsonl").read_text() == '{"whole": 1}\n'


ODD = [
    "options: 2020-01-01",
    "options: {seed: !!set {a, b}}",
    "options: {seed: !!binary aGVsbG8=}",
    "options: {1: 2, 2020-01-01: 3}",
    "options: null",
    "options: [1, 2]",
    "problems: !!set {a, b}",
    "level: 2020-01-01 10:00:00",
    "seed: .nan",
]


@pytest.mark.parametrize("text", ODD)
def test_values_of_odd_types_are_other_options(text: str) -> None:
    start(out=Path("out"))
    config = Path("out/config.yaml")
    key = text.partition(":")[0]
    kept = {name: value for name, value in yaml.safe_load(config.read_text()).items() if name != key}
    config.write_text(f"{yaml.safe_dump(kept)}{text}\n")
    with refusal(Code.OTHER_OPTIONS, file="out"):
        start(out=Path("out"))


@pytest.mark.parametrize(
    "text",
    [
        "sessions: [2020-01-01, !!set {a}, !!binary aGVsbG8=, null, 3, {1: 2}]",
        "sessions: [{started: [], conduct: 3, versions: !!set {a}}]",
    ],
)
def test_sessions_of_odd_types_are_kept(text: str) -> None:
    start(out=Path("out"))
    config = Path("out/config.yaml")
    kept = {name: value for name, value in yaml.safe_load(config.read_text()).items() if name != "sessions"}
    config.write_text(f"{yaml.safe_dump(kept)}{text}\n")
    before = yaml.safe_load(config.read_text())["sessions"]
    start(out=Path("out"))
    assert yaml.safe_load(config.read_text())["sessions"][:-1] == before
