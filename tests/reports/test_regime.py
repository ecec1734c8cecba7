"""Tables read from the folder of a run."""

from itertools import product
from pathlib import Path

from ictamp_drake.core.errors import Code
from ictamp_drake.reports.regime import UNNAMED, read_regime, tabulate_runs
from ictamp_drake.runs.records import OWN
from tests.refusals import refusal
from tests.runs.recorded import CONDITIONS, folder_of, run


def test_a_regime_says_how_its_runs_were_made(tmp_path: Path) -> None:
    records = [run("b", 1), run("a", 0, level="medium"), run("b", 0, seed=3, solved=False, load=(3.0, 2.0, 1.0))]
    regime = read_regime(folder_of(tmp_path / "paper", records))
    assert (regime.name, regime.time_limit) == ("paper", 60.0)
    assert regime.strategies == ["b", "a"]
    assert regime.runs["level"].tolist() == ["easy", "easy", "medium"]
    assert regime.about == {
        "runs": "3",
        "program": "runner",
        "commit": "9760efb315-dirty",
        "drake": "1.51.1",
        "cores": "2",
        "workers": "2",
        "load": "2.0 (2.0 to 3.0)",
        "time limit of a run [s]": "60",
        "limit of low-level steps": "none",
        "seeds": "0, 3",
    }


def test_unsolved_runs_count_with_the_time_limit() -> None:
    records = [run("a", 0, seconds=4.0), run("a", 1, seconds=7.0, solved=False)]
    assert tabulate_runs(records, 60.0)["counted"].tolist() == [4.0, 60.0]
    assert tabulate_runs(records)["counted"].tolist() == [4.0, 7.0]


def test_rows_are_in_the_same_order_whatever_that_of_the_records() -> None:
    each = product((0, 1), ("easy", "hard"), (0, 1))
    records = [run("a", number, level=level, seed=seed) for number, level, seed in each]
    assert tabulate_runs(records).equals(tabulate_runs(records[::-1]))


def test_what_has_no_name_gets_one() -> None:
    runs = tabulate_runs([run("", level=None)])
    assert runs.loc[0, ["strategy", "level"]].tolist() == [UNNAMED, OWN]


def test_interrupted_runs_are_left_out_and_broken_ones_count(tmp_path: Path) -> None:
    records = [run("a", 0), run("a", 1, solved=False, stop_reason="STOPPED")]
    records.append(run("a", 2, solved=False, stop_reason="CRASHED", error="the process died"))
    regime = read_regime(folder_of(tmp_path / "run", records))
    assert regime.runs["problem"].tolist() == ["easy-000", "easy-002"]
    assert regime.about["runs"] == (
        "2; 1 of them broke down and count as unsolved; 1 more were interrupted and are left out"
    )


def test_what_no_configuration_tells_is_not_known(tmp_path: Path) -> None:
    regime = read_regime(folder_of(tmp_path / "run", [run("a")], config=None))
    assert regime.time_limit is None
    assert regime.about["commit"] == "not known"


def test_several_time_limits_are_no_limit_of_all(tmp_path: Path) -> None:
    config = CONDITIONS | {"strategies": {"b": {"time_limit": 30.0}}}
    regime = read_regime(folder_of(tmp_path / "run", [run("a")], config))
    assert regime.time_limit is None
    assert regime.about["time limit of a run [s]"] == "60, 30"


def test_a_folder_without_records_is_named_beside_those_that_have_them(tmp_path: Path) -> None:
    with refusal(Code.NOT_A_RUN, "runs", value=str(tmp_path / "nowhere"), choices=()):
        read_regime(tmp_path / "nowhere")
    folder_of(tmp_path / "default", [run("a")])
    with refusal(Code.NOT_A_RUN, "runs", choices=("default",)):
        read_regime(tmp_path / "nowhere")


def test_a_broken_configuration_is_named(tmp_path: Path) -> None:
    folder = folder_of(tmp_path / "run", [run("a")])
    (folder / "config.yaml").write_text("- 1")
    with refusal(Code.WRONG_TYPE, file=folder / "config.yaml", value=[1]):
        read_regime(folder)


def test_a_run_that_has_not_finished_anything_is_no_regime(tmp_path: Path) -> None:
    folder = folder_of(tmp_path / "run", [run("a", solved=False, stop_reason="STOPPED")])
    with refusal(Code.TOO_FEW_DATA, file=folder / "results.jsonl"):
        read_regime(folder)


def test_a_robot_and_what_served_with_it_are_named(tmp_path: Path) -> None:
    served = {"sampler": "geometric", "estimator": "constant"}
    records = [run("a", number, robot="/home/me/own.yaml", stand_ins=served) for number in (0, 1)]
    about = read_regime(folder_of(tmp_path / "own", records)).about
    assert about["robot"] == "own.yaml (estimator constant, sampler geometric)"
    other = [run("a", 0), run("a", 1, robot="ur5e_2f85")]
    assert read_regime(folder_of(tmp_path / "both", other)).about["robot"] == "panda, ur5e_2f85"
