"""Rows of attempts: written, joined, read back, and turned into training data."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pyarrow as pa
import pyarrow.dataset as pads
import pyarrow.parquet as pq
import pytest

from ictamp_drake.collection.shards import summary
from ictamp_drake.core.errors import Code
from ictamp_drake.core.failures import Failure
from ictamp_drake.core.types import Action, Attempt, Configuration, GripperCommand
from ictamp_drake.learning.cases import read_cases
from ictamp_drake.learning.dataset import (
    FIELDS,
    AttemptRow,
    action,
    configuration,
    fingerprint,
    load,
    merge,
    open_table,
    scene,
    scene_text,
    write,
)
from ictamp_drake.observation.state_matrix import ROWS, SCHEMA, Observer
from ictamp_drake.scenes.training import training_scene
from tests.motions import stay
from tests.refusals import refusal
from tests.skills.rig import rig

DATA = Path(__file__).parents[2] / "data"
MOTION = (stay(0.1),)


def row(number: int, state: int = 0, draw: int = 0, failure: Failure | None = None, k: bool = True) -> AttemptRow:
    """An attempt in a training scene: a pick in even states, a placement in odd ones."""
    spec = training_scene(number)
    rng = np.random.default_rng([number, state])
    box = min(spec.boxes)
    poses = {name: each.X_WO + rng.normal(scale=1e-3, size=7) for name, each in spec.boxes.items()}
    held = box if state % 2 else None
    c = Configuration(rng.normal(size=7), rng.normal(size=2), poses, held, GripperCommand(0.05, 30.0))
    executed = failure in (None, Failure.SLIPPED)
    attempt = Attempt(
        Action("place" if state % 2 else "pick", (box, "table")),
        failure,
        successor=c if executed else None,
        k=rng.normal(size=4) if k else None,
        motion=MOTION if executed else (),
        seconds={"sampling": 0.001, "motion": 0.0204, "physics": 0.25},
    )
    return AttemptRow(number, scene_text(spec), state, draw, "uniform", c, attempt)


ROWS_OF_TWO_SCENES = [
    row(3),
    row(3, 0, 1, Failure.SLIPPED),
    row(3, 1, 0, Failure.NO_PATH),
    row(4, 0, 0, Failure.NO_INVERSE_KINEMATICS, k=False),
    row(4, 1),
]


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    write(ROWS_OF_TWO_SCENES, tmp_path / "all.parquet")
    return tmp_path


def test_rows_come_back_as_they_were_written(folder: Path) -> None:
    read = open_table(folder).to_table().to_pylist()
    for written, found in zip(ROWS_OF_TWO_SCENES, read, strict=True):
        attempt, c = written.attempt, configuration(found)
        assert action(found) == attempt.action
        assert (found["scene"], found["state"], found["draw"]) == (written.scene, written.state, written.draw)
        assert found["failure"] == (attempt.failure.name if attempt.failure else None)
        assert found["executed"] == bool(attempt.motion)
        assert found["motion_ms"] == 20
        assert (c.held, found["sampler"]) == (written.c.held, "uniform")
        np.testing.assert_allclose(c.q, written.c.q, rtol=1e-6)
        np.testing.assert_allclose(c.fingers, written.c.fingers, rtol=1e-6)
        np.testing.assert_allclose([c.gripper.width, c.gripper.force], [0.05, 30.0], rtol=1e-6)
        for name, pose in written.c.poses.items():
            np.testing.assert_allclose(c.poses[name], pose, atol=1e-6)
        if attempt.k is None:
            assert found["k"] is None
        else:
            np.testing.assert_allclose(found["k"], attempt.k, rtol=1e-6)
        moved = None if attempt.successor is None else attempt.successor.poses[attempt.action.args[0]]
        assert (found["moved"] is None) == (moved is None)
        if moved is not None:
            np.testing.assert_allclose(found["moved"], moved, atol=1e-6)


@pytest.mark.parametrize("number", range(9))
def test_a_scene_comes_back_from_its_text(number: int) -> None:
    assert scene(scene_text(training_scene(number))) == training_scene(number)


def test_matrices_are_those_of_the_configurations(folder: Path) -> None:
    attempts = load(folder)
    with_k = [each for each in ROWS_OF_TWO_SCENES if each.attempt.k is not None]
    assert len(attempts) == len(with_k)
    for number, each in enumerate(with_k):
        seen = Observer(training_scene(each.scene)).observe(each.c, each.attempt.action)
        np.testing.assert_allclose(attempts.matrix[number], seen.matrix, atol=2e-5)
        np.testing.assert_array_equal(attempts.mask[number], seen.mask)
        np.testing.assert_allclose(attempts.k[number], each.attempt.k, rtol=1e-6)
        if each.attempt.successor is None:
            assert np.isnan(attempts.moved[number]).all()
        elif each.attempt.action.name == "pick":
            np.testing.assert_allclose(attempts.moved[number], 0.0, atol=1e-5)  # c' is c
        else:
            assert np.isfinite(attempts.moved[number]).all()
    assert attempts.success.tolist() == [True, False, False, True]
    assert attempts.executed.tolist() == [True, True, False, True]
    assert attempts.failure.tolist() == ["", "SLIPPED", "NO_PATH", ""]
    assert attempts.scene.tolist() == [3, 3, 3, 4]


def test_one_skill_can_be_chosen(folder: Path) -> None:
    attempts = load(folder, "place")
    assert set(attempts.action) == {"place"}
    assert len(attempts) == 2
    assert len(attempts.select(attempts.success)) == 1


def test_joining_changes_no_rows(folder: Path, tmp_path: Path) -> None:
    parts, joined = tmp_path / "parts", tmp_path / "joined"
    parts.mkdir()
    joined.mkdir()
    write(ROWS_OF_TWO_SCENES[3:], parts / "2.parquet")
    write([], parts / "1.parquet")
    write(ROWS_OF_TWO_SCENES[:3][::-1], parts / "0.parquet")
    merge(sorted(parts.glob("*.parquet")), joined / "all.parquet")
    assert open_table(joined).to_table().to_pylist() == open_table(folder).to_table().to_pylist()
    assert fingerprint(joined) == fingerprint(folder)


def test_the_fingerprint_tells_data_apart(folder: Path) -> None:
    before = fingerprint(folder)
    write([row(5)], folder / "more.parquet")
    assert fingerprint(folder) != before


def test_no_rows_are_no_attempts(tmp_path: Path) -> None:
    write([], tmp_path / "none.parquet")
    assert load(tmp_path).matrix.shape == (0, ROWS, SCHEMA.width)


def test_a_folder_without_attempts_is_named(tmp_path: Path) -> None:
    with refusal(Code.NOT_FOUND, file=tmp_path):
        load(tmp_path)


POINTER = b"version https://git-lfs.github.com/spec/v1\noid sha256:0\nsize 3\n"
READERS = [load, fingerprint, summary, lambda folder: read_cases(folder, "pick", least=1)]


@pytest.mark.parametrize("act", READERS)
@pytest.mark.parametrize("content", [b"", POINTER, b"PAR1", b"PAR1" + b"x" * 100 + b"PAR1"])
def test_a_file_that_is_not_parquet_is_named(act: Callable[[Path], object], content: bytes, folder: Path) -> None:
    (folder / "more.parquet").write_bytes(content)
    with refusal(Code.DAMAGED, file=folder / "more.parquet"):
        act(folder)
    with refusal(Code.DAMAGED, file=folder / "more.parquet"):
        merge([folder / "all.parquet", folder / "more.parquet"], folder / "merged.parquet")
    assert not (folder / "merged.parquet").exists()


@pytest.mark.parametrize("act", READERS)
@pytest.mark.parametrize("spoil", ["cut", "middle"])
def test_a_damaged_file_is_named(act: Callable[[Path], object], spoil: str, folder: Path) -> None:
    path = folder / "all.parquet"
    content = bytearray(path.read_bytes())
    if spoil == "cut":
        content = content[: len(content) // 2]
    else:
        content[4 : len(content) // 2] = bytes(len(content) // 2 - 4)
    path.write_bytes(content)
    with refusal(Code.DAMAGED):
        act(folder)


@pytest.mark.parametrize("column", FIELDS.names)
def test_a_missing_column_is_named(column: str, folder: Path) -> None:
    path = folder / "all.parquet"
    pq.write_table(pq.read_table(path).drop_columns([column]), path)
    with refusal(Code.MISSING_FIELD, column, file=path):
        load(folder)


@pytest.mark.parametrize(
    ("column", "values", "code"),
    [
        ("q", pa.array(["x"] * 5), Code.DAMAGED),
        ("poses", pa.array([[1.0]] * 5, pa.list_(pa.float32())), Code.WRONG_LENGTH),
        ("poses", pa.array([None] * 5, pa.list_(pa.float32())), Code.MISSING_FIELD),
        ("q", pa.array([[np.nan] * 9] * 5, pa.list_(pa.float32(), 9)), Code.DAMAGED),
        ("k", pa.array([[np.inf] * 4] * 5, pa.list_(pa.float32(), 4)), Code.DAMAGED),
        ("spec", pa.array(["no scene"] * 5), Code.NOT_JSON),
        ("spec", pa.array(["{}"] * 5), Code.MISSING_FIELD),
        ("box", pa.array(["nothing"] * 5), Code.UNKNOWN_CHOICE),
        ("action", pa.array(["throw"] * 5), Code.UNKNOWN_CHOICE),
        ("held", pa.array(["nothing"] * 5), Code.UNKNOWN_CHOICE),
        ("executed", pa.array([None] * 5, pa.bool_()), Code.MISSING_FIELD),
    ],
)
def test_rows_that_do_not_fit_are_refused(column: str, values: pa.Array, code: Code, folder: Path) -> None:
    path = folder / "all.parquet"
    table = pq.read_table(path)
    pq.write_table(table.set_column(table.schema.get_field_index(column), column, values), path)
    with refusal(code, file=folder):
        load(folder)


def test_unfinished_files_are_not_read(folder: Path) -> None:
    (folder / ".all.parquet.123").write_text("half of a fi")
    assert len(load(folder)) == 4


@pytest.mark.slow
@pytest.mark.parametrize("folder", ["ground_truth", "round_0", "round_1", "round_2"])
@pytest.mark.parametrize("name", ["pick", "place"])
def test_what_earlier_versions_recorded_can_be_tried_again(folder: str, name: str) -> None:
    """Its c has no simulator state: everything is at rest, and the arm is commanded to stay in place."""
    succeeded = pads.field("failure").is_null() & (pads.field("action").cast(pa.string()) == name)
    (recorded,) = open_table(DATA / folder).head(1, filter=succeeded).to_pylist()
    c, spec, tried = configuration(recorded), scene(recorded["spec"]), action(recorded)
    assert c.x is None
    assert c.commanded.tobytes() == c.q.tobytes()
    assert c.held == (None if name == "pick" else tried.args[0])
    attempt = rig(spec).attempt(c, tried, k=np.array(recorded["k"], dtype=float))
    assert attempt.succeeded, attempt.detail
    assert attempt.successor is not None
    np.testing.assert_allclose(attempt.successor.poses[tried.args[0]][4:], recorded["moved"][4:], atol=0.01)
