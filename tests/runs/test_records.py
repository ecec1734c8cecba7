"""results.jsonl: records are read back as written, whatever interrupts the writing."""

import dataclasses
import json
import resource
from pathlib import Path

import pytest
from hypothesis import given
from hypothesis import strategies as st

from ictamp_drake.core.errors import Code
from ictamp_drake.runs.records import Record, append, drop_torn_line, read_records
from tests.refusals import refusal

counts = st.dictionaries(st.text(max_size=8), st.integers(0, 99), max_size=3)
records = st.builds(
    Record,
    problem=st.text(min_size=1, max_size=8),
    strategy=st.text(max_size=5),
    level=st.none() | st.text(max_size=5),
    seed=st.integers(0, 2**63 - 1),
    interference=st.lists(st.text(max_size=5), max_size=3).map(tuple),
    solved=st.booleans(),
    verified=st.none() | st.booleans(),
    stop_reason=st.sampled_from(["SOLVED", "STOPPED", "CRASHED"]),
    planning_time_s=st.floats(0, 1e6),
    steps_by_depth=st.lists(st.integers(0, 99), max_size=4).map(tuple),
    plan_length=st.none() | st.integers(0, 50),
    failures=counts,
    blocked=st.dictionaries(st.text(max_size=8), counts, max_size=3),
    obstacles=st.dictionaries(st.text(max_size=8), counts, max_size=3),
    error=st.none() | st.text(),
    load=st.tuples(*[st.floats(0, 100)] * 3),
)


def record(problem: str, **values: object) -> Record:
    return Record(
        **{"level": None, "seed": 0, "stop_reason": "SOLVED", "planning_time_s": 1.0, **values}, problem=problem
    )  # type: ignore[arg-type]


@given(written=st.lists(records, max_size=5, unique_by=lambda record: record.name), torn=st.binary(max_size=20))
def test_whole_lines_survive_a_torn_one(
    written: list[Record], torn: bytes, tmp_path_factory: pytest.TempPathFactory
) -> None:
    path = tmp_path_factory.mktemp("records") / "results.jsonl"
    for each in written:
        append(each, path)
    with path.open("ab") as file:
        file.write(torn.replace(b"\n", b""))
    drop_torn_line(path)
    assert list(read_records(path).values()) == written


def test_a_last_record_that_only_lacks_its_end_is_kept(tmp_path: Path) -> None:
    path = tmp_path / "results.jsonl"
    append(record("a"), path)
    path.write_text(path.read_text().rstrip("\n"))
    drop_torn_line(path)
    append(record("b"), path)
    assert list(read_records(path)) == ["a", "b"]


@pytest.mark.parametrize("room", [0, 50])
def test_a_record_that_the_disk_has_no_room_for_leaves_nothing(room: int, tmp_path: Path) -> None:
    path = tmp_path / "results.jsonl"
    append(record("a"), path)
    before, limits = path.read_bytes(), resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (len(before) + room, limits[1]))
    try:
        with refusal(Code.NOT_WRITABLE, file=path):
            append(record("b"), path)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limits)
    assert path.read_bytes() == before


def test_the_last_record_of_a_problem_counts(tmp_path: Path) -> None:
    path = tmp_path / "results.jsonl"
    for each in (record("a", solved=False), record("b"), record("a", solved=True)):
        append(each, path)
    assert list(read_records(path)) == ["b", "a"]
    assert read_records(path)["a"].solved


def test_the_last_record_of_a_strategy_a_seed_and_a_problem_counts(tmp_path: Path) -> None:
    path = tmp_path / "results.jsonl"
    written = [record("a", strategy=strategy, seed=seed) for strategy, seed in (("x", 0), ("y", 0), ("x", 1), ("y", 0))]
    for each in written:
        append(each, path)
    assert list(read_records(path)) == ["x/0/a", "x/1/a", "y/0/a"]
    assert list(read_records(path).values()) == [written[0], written[2], written[3]]


def test_records_from_before_steps_had_depths_are_read(tmp_path: Path) -> None:
    path = tmp_path / "results.jsonl"
    values = dataclasses.asdict(record("a"))
    del values["steps_by_depth"], values["strategy"]
    path.write_text(json.dumps(values) + "\n")
    assert read_records(path) == {"a": record("a", load=values["load"])}


def test_no_file_holds_no_records(tmp_path: Path) -> None:
    drop_torn_line(tmp_path / "results.jsonl")
    assert read_records(tmp_path / "results.jsonl") == {}


@pytest.mark.parametrize(
    ("line", "code", "field"),
    [
        ("no json", Code.NOT_JSON, ""),
        ("[" * 100_000, Code.TOO_DEEP, ""),
        ("[]", Code.WRONG_TYPE, ""),
        ("{}", Code.MISSING_FIELD, "problem"),
        ('{"problem": "a", "colour": 1}', Code.UNKNOWN_FIELD, "colour"),
    ],
)
def test_a_line_that_is_no_record_is_named(line: str, code: Code, field: str, tmp_path: Path) -> None:
    path = tmp_path / "results.jsonl"
    append(record("a"), path)
    with path.open("a") as file:
        file.write(line + "\n")
    with refusal(code, field, file=path, line=2):
        read_records(path)


def test_a_line_that_is_not_utf8_is_named(tmp_path: Path) -> None:
    (tmp_path / "results.jsonl").write_bytes(b'{"problem": "\xff"}\n')
    with refusal(Code.NOT_JSON, file=tmp_path / "results.jsonl", line=1):
        read_records(tmp_path / "results.jsonl")


@pytest.mark.parametrize(
    ("field", "value"),
    [
        ("planning_time_s", "fast"),
        ("solved", "no"),
        ("seed", True),
        ("failures", [1]),
        ("level", 3),
        ("load", ["much"]),
    ],
)
def test_a_value_of_the_wrong_type_is_named(field: str, value: object, tmp_path: Path) -> None:
    path = tmp_path / "results.jsonl"
    path.write_text(json.dumps(dataclasses.asdict(record("a")) | {field: value}) + "\n")
    with refusal(Code.WRONG_TYPE, field, file=path, line=1, value=value):
        read_records(path)


@pytest.mark.parametrize(
    ("values", "final"),
    [
        ({}, True),
        ({"stop_reason": "OUT_OF_TIME"}, True),
        ({"stop_reason": "STOPPED"}, False),
        ({"stop_reason": "CRASHED", "error": "Traceback"}, False),
        ({"error": "a picture could not be drawn"}, False),
    ],
)
def test_only_what_came_to_its_own_end_is_final(values: dict[str, object], final: bool) -> None:
    assert record("a", **values).is_final is final
