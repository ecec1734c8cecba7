"""Checkpoints are read back unchanged, or refused."""

import json
from pathlib import Path

import numpy as np
import pytest

from ictamp_drake.core.errors import Code
from ictamp_drake.learning.checkpoint import Checkpoint, load, read, write
from ictamp_drake.learning.models import load_dynamics, load_estimator, load_skill
from ictamp_drake.observation.state_matrix import SCHEMA
from tests.learning.synthetic import write_untrained
from tests.refusals import refusal

ARRAYS = {"one": np.arange(6, dtype=np.float32).reshape(2, 3), "two": np.array([1.5], dtype=np.float32)}
CHECKPOINT = Checkpoint("policy", "pick", ARRAYS, {"width": 3}, {"command": "python x"}, {"auc": 0.9})


def test_a_checkpoint_comes_back_as_it_was(tmp_path: Path) -> None:
    path = CHECKPOINT.save(tmp_path / "new")
    found = load(tmp_path / "new", "policy", "pick")
    assert path.name == "pick_policy.safetensors"
    assert [path.name for path in path.parent.iterdir()] == [path.name]
    assert (found.network, found.provenance, found.metrics) == ({"width": 3}, {"command": "python x"}, {"auc": 0.9})
    assert found.arrays.keys() == ARRAYS.keys()
    for name, array in ARRAYS.items():
        np.testing.assert_array_equal(found.arrays[name], array)


def test_the_metadata_say_what_the_columns_mean(tmp_path: Path) -> None:
    _, metadata = read(CHECKPOINT.save(tmp_path))
    assert metadata["schema"]["version"] == SCHEMA.version
    assert [column["name"] for column in metadata["schema"]["columns"]] == [each.name for each in SCHEMA.columns]


def assert_refused(folder: Path, code: Code, field: str = "", kind: str = "policy", skill: str = "pick") -> None:
    with refusal(code, field, file=folder / f"{skill}_{kind}.safetensors"):
        load(folder, kind, skill)  # type: ignore[arg-type]


def test_a_missing_file_is_refused(tmp_path: Path) -> None:
    assert_refused(tmp_path, Code.NOT_FOUND)
    assert_refused(tmp_path, Code.NOT_FOUND, kind="estimator", skill="place")
    assert_refused(tmp_path, Code.NOT_FOUND, kind="dynamics", skill="place")


@pytest.mark.parametrize("left", [0, 5, 100, -4])
def test_a_damaged_file_is_refused(tmp_path: Path, left: int) -> None:
    path = CHECKPOINT.save(tmp_path)
    path.write_bytes(path.read_bytes()[:left])
    assert_refused(tmp_path, Code.DAMAGED)


def test_a_file_of_something_else_is_refused(tmp_path: Path) -> None:
    path = CHECKPOINT.save(tmp_path)
    path.rename(tmp_path / "pick_estimator.safetensors")
    assert_refused(tmp_path, Code.WRONG_TYPE, "kind", "estimator")
    write(path, ARRAYS, {"kind": "policy"})
    assert_refused(tmp_path, Code.MISSING_FIELD, "skill")


@pytest.mark.parametrize("change", ["version", "columns"])
def test_another_state_matrix_is_refused(tmp_path: Path, change: str) -> None:
    path = CHECKPOINT.save(tmp_path)
    arrays, metadata = read(path)
    schema = metadata["schema"]
    metadata["schema"] = {**schema, "version": 0} if change == "version" else {**schema, "columns": []}
    write(path, arrays, metadata)
    assert_refused(tmp_path, Code.OTHER_VERSION, "schema.version")


def test_another_way_to_read_k_is_refused(tmp_path: Path) -> None:
    path = CHECKPOINT.save(tmp_path)
    arrays, metadata = read(path)
    write(path, arrays, {**metadata, "k": {"version": 0}})
    assert_refused(tmp_path, Code.OTHER_VERSION, "k.version")


@pytest.mark.parametrize(
    ("name", "value", "code"),
    [
        ("schema", [], Code.WRONG_TYPE),
        ("schema", None, Code.WRONG_TYPE),
        ("schema", {"columns": {"a": [1]}}, Code.OTHER_VERSION),
        ("k", 3, Code.WRONG_TYPE),
        ("k", "version", Code.WRONG_TYPE),
        ("k", {"version": [[[]]]}, Code.OTHER_VERSION),
        ("kind", ["policy"], Code.WRONG_TYPE),
        ("skill", {}, Code.WRONG_TYPE),
        ("metrics", {"auc": "high"}, Code.WRONG_TYPE),
        ("provenance", [1], Code.WRONG_TYPE),
        ("network", "wide", Code.WRONG_TYPE),
        ("more", 1, Code.UNKNOWN_FIELD),
    ],
)
def test_odd_metadata_are_refused(name: str, value: object, code: Code, tmp_path: Path) -> None:
    path = CHECKPOINT.save(tmp_path)
    arrays, metadata = read(path)
    write(path, arrays, {**metadata, name: value})
    with refusal(code, file=path):
        load(tmp_path, "policy", "pick")


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_weights_that_are_not_finite_are_refused(value: float, tmp_path: Path) -> None:
    path = CHECKPOINT.save(tmp_path)
    arrays, metadata = read(path)
    write(path, {**arrays, "two": np.array([value], dtype=np.float32)}, metadata)
    assert_refused(tmp_path, Code.DAMAGED, "two")


@pytest.mark.parametrize("content", [b"\x80\x04}q\x00.", b"PK\x03\x04" + b"x" * 100, b"version https://git-lfs\n"])
def test_files_of_other_formats_are_refused(content: bytes, tmp_path: Path) -> None:
    (tmp_path / "pick_policy.safetensors").write_bytes(content)
    assert_refused(tmp_path, Code.DAMAGED)


@pytest.mark.parametrize(
    ("kind", "loader"), [("policy", load_skill), ("estimator", load_estimator), ("dynamics", load_dynamics)]
)
def test_numbers_that_do_not_fit_are_refused(tmp_path: Path, kind: str, loader) -> None:  # type: ignore[no-untyped-def]
    write_untrained(tmp_path)
    path = tmp_path / f"pick_{kind}.safetensors"
    arrays, metadata = read(path)
    loader(tmp_path, "pick")
    for broken in (dict(list(arrays.items())[1:]), {name: array[..., :1] for name, array in arrays.items()}):
        write(path, broken, metadata)
        with refusal(Code.DAMAGED, file=path):
            loader(tmp_path, "pick")
    write(path, arrays, {**metadata, "network": json.loads('{"depth": 3}')})
    with refusal(Code.UNKNOWN_FIELD, "network.depth", file=path):
        loader(tmp_path, "pick")
