"""The programs that take a plan file: `replay` and `export`."""

from pathlib import Path

import pytest

from ictamp_drake import export, replay
from ictamp_drake.runs.command import BAD_INPUT, BROKEN, COMPLETE
from ictamp_drake.scenes.spec import load_scene
from ictamp_drake.tamp.plan import Plan
from ictamp_drake.world.world import World
from tests.runs.plans import small_plan

NOTHING_TO_DO = Path(__file__).parent / "scenes" / "cases" / "16-nothing-to-do.yaml"


@pytest.fixture(scope="module")
def path(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A plan file."""
    path = tmp_path_factory.mktemp("plan") / "plan.yaml"
    small_plan().save(path)
    return path


@pytest.mark.parametrize(
    "options",
    [
        [],
        ["--noise", "0.003", "2", "--seed", "1"],
        ["--friction", "0.7", "--mass", "1.2", "--grip-force", "0.7", "--stiffness", "0.5", "--time-step", "0.002"],
    ],
)
def test_a_plan_that_holds_is_reported_step_by_step(
    path: Path, options: list[str], tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    page = tmp_path / "page.html"
    assert replay.main([str(path), "--out", str(page), *options]) == COMPLETE
    output = capsys.readouterr().out
    assert "1  pick(red_box, table)  as expected" in output.replace("   ", "  ").replace("   ", "  ")
    assert output.count("as expected") == 2
    assert options or str(Plan.load(path).torque) in output
    assert "First missed" not in output
    assert "place(red_box, rack)" in page.read_text()


def test_the_step_that_is_missed_first_is_named(path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    assert replay.main([str(path), "--grip-force", "0.01"]) == BROKEN
    output = capsys.readouterr().out
    assert "missing: in-hand(red_box)" in output
    assert "First missed: step 1 of 2, pick(red_box, table)" in output
    assert path.with_name("replay.html").exists()


def test_an_export_writes_its_files_beside_the_plan_or_elsewhere(
    path: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    names = {"joints.csv", "gripper.csv", "joint_trajectory.yaml"}
    assert export.main([str(path), "--rate", "20"]) == COMPLETE
    assert names <= {file.name for file in path.parent.iterdir()}
    assert export.main([str(path), "--rate", "40", "--out", str(tmp_path / "new" / "folder")]) == COMPLETE
    assert {file.name for file in (tmp_path / "new" / "folder").iterdir()} == names
    rows = [(folder / "joints.csv").read_text().count("\n") for folder in (path.parent, tmp_path / "new" / "folder")]
    assert rows[1] == pytest.approx(2 * rows[0], rel=0.05)
    assert str(path.with_name("joints.csv")) in capsys.readouterr().out


def test_an_empty_plan_is_executed_and_exported(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    spec = load_scene(NOTHING_TO_DO)
    Plan(spec, World(spec).initial_configuration(), ()).save(tmp_path / "plan.yaml")
    assert replay.main([str(tmp_path / "plan.yaml"), "--noise", "0.001", "1"]) == COMPLETE
    assert "the goal holds" in capsys.readouterr().out
    assert export.main([str(tmp_path / "plan.yaml")]) == COMPLETE
    assert (tmp_path / "joints.csv").read_text().count("\n") == 1


@pytest.mark.parametrize(
    ("program", "options"),
    [
        ("export", ["--rate", "0"]),
        ("export", ["--out", "FILE/below"]),
        ("replay", ["--noise", "-1", "2"]),
        ("replay", ["--mass", "1000"]),
        ("replay", ["--mass", "90"]),
        ("replay", ["--time-step", "5"]),
    ],
)
def test_bad_input_is_refused_in_one_sentence(
    program: str, options: list[str], path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    options = [option.replace("FILE", str(path)) for option in options]
    main = {"export": export.main, "replay": replay.main}[program]
    assert main([str(path), *options]) == BAD_INPUT
    output = capsys.readouterr()
    assert output.err.count("\n") == 1
    assert output.out == ""


def test_actions_that_do_not_follow_from_each_other_are_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    plan = small_plan()
    Plan(plan.spec, plan.c, plan.attempts[1:]).save(tmp_path / "plan.yaml")
    assert replay.main([str(tmp_path / "plan.yaml")]) == BAD_INPUT
    output = capsys.readouterr()
    assert output.err.startswith(str(tmp_path / "plan.yaml"))
    assert output.err.count("\n") == 1
    assert output.out == ""


@pytest.mark.parametrize("place", ["file/below/page.html", "folder"])
def test_a_page_that_cannot_be_written_is_named(
    place: str, path: Path, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "file").write_text("")
    (tmp_path / "folder").mkdir()
    assert replay.main([str(path), "--out", str(tmp_path / place)]) == BAD_INPUT
    output = capsys.readouterr().err
    assert output.startswith(f"{tmp_path / place}: ")
    assert output.count("\n") == 1


@pytest.mark.parametrize("main", [export.main, replay.main])
def test_a_file_that_is_no_plan_is_refused_in_one_sentence(
    main: object, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    (tmp_path / "plan.yaml").write_text("format: [")
    assert callable(main)
    for name in ("plan.yaml", "missing.yaml"):
        assert main([str(tmp_path / name)]) == BAD_INPUT
        output = capsys.readouterr()
        assert output.err.startswith(str(tmp_path / name))
        assert output.err.count("\n") == 1
