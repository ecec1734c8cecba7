"""Recorded attempts at skills: Parquet files of rows, read back lazily, and the arrays that networks learn from.

A folder holds any number of `*.parquet` files; together they form one table with the columns of `FIELDS`. A row holds c
itself and the text of its scene, not the state matrix, so a new schema of the matrix needs no new attempts.
"""

import json
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, fields
from functools import lru_cache
from itertools import groupby
from operator import itemgetter
from pathlib import Path
from typing import Any

import numpy as np
import pyarrow as pa
import pyarrow.dataset as pads
import pyarrow.parquet as pq
from numpy.typing import NDArray

from ictamp_drake.core.checks import check_choice
from ictamp_drake.core.decoding import decode
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.files import whole
from ictamp_drake.core.reading import in_file, parse_json
from ictamp_drake.core.spelling import respell
from ictamp_drake.core.types import Action, Attempt, Configuration, GripperCommand
from ictamp_drake.observation.state_matrix import ROWS, SCHEMA, Observation, Observer
from ictamp_drake.robots.spec import DEFAULT, read_robot
from ictamp_drake.scenes.spec import SceneSpec, to_dict

_ARM_JOINTS = len(read_robot(DEFAULT).joints)
"""Number of joints of the arm in data; those of the fingers follow. Data are collected with the robot of the levels."""
_WORD = pa.dictionary(pa.int32(), pa.string())


def _numbers(count: int) -> pa.DataType:
    return pa.list_(pa.float32(), count)


FIELDS = pa.schema(
    [
        ("scene", pa.int32()),  # number of the training scene
        ("spec", _WORD),  # the scene as JSON
        ("state", pa.int16()),  # number of c among those of its scene
        ("draw", pa.int16()),  # number of the attempt among those from this c
        ("action", _WORD),  # pick or place
        ("box", _WORD),
        ("place", _WORD),  # what it stands on or is put on
        ("sampler", _WORD),  # where k comes from
        ("k", _numbers(4)),  # null when none was found
        ("failure", _WORD),  # name of a Failure; null when the promised state was reached
        ("executed", pa.bool_()),  # in physics; False when motion planning refused k
        ("q", _numbers(9)),  # positions of the joints of the arm, then of the fingers
        ("poses", pa.list_(pa.float32())),  # X_WO of the boxes in the order of their names, 7 numbers each
        ("held", _WORD),
        ("gripper", _numbers(2)),  # width [m] and force [N]
        ("moved", _numbers(7)),  # X_WO of the action's box in c'; null when unknown
        ("sampling_ms", pa.int32()),
        ("motion_ms", pa.int32()),
        ("physics_ms", pa.int32()),
    ]
)
"""The columns of the files."""

ORDER = ("scene", "state", "draw")
"""Columns that number the rows."""

_OPTIONAL = frozenset({"k", "failure", "held", "moved"})
"""Columns that may be null."""


@dataclass(frozen=True, eq=False)
class AttemptRow:
    """One attempt, before it is written.

    Attributes:
        scene: Number of the training scene.
        spec: Scene as JSON.
        state: Number of c among those of its scene.
        draw: Number of the attempt among those from this c.
        sampler: Name of the source of k.
        c: Configuration from which the attempt started.
        attempt: Attempt, with its outcome.
    """

    scene: int
    spec: str
    state: int
    draw: int
    sampler: str
    c: Configuration
    attempt: Attempt[Configuration]

    def values(self) -> dict[str, Any]:
        """Values of all `FIELDS`, by name."""
        c, attempt, action = self.c, self.attempt, self.attempt.action
        after = attempt.successor
        return {
            "scene": self.scene,
            "spec": self.spec,
            "state": self.state,
            "draw": self.draw,
            "action": action.name,
            "box": action.args[0],
            "place": action.args[1],
            "sampler": self.sampler,
            "k": attempt.k,
            "failure": None if attempt.failure is None else attempt.failure.name,
            "executed": bool(attempt.motion),
            "q": np.append(c.q, c.fingers),
            "poses": np.concatenate(list(c.poses.values())),
            "held": c.held,
            "gripper": [c.gripper.width, c.gripper.force],
            "moved": None if after is None else after.poses[action.args[0]],
            **{f"{stage}_ms": round(1000 * attempt.seconds.get(stage, 0.0)) for stage in STAGES},
        }


STAGES = ("sampling", "motion", "physics")
"""Stages of an attempt whose computing times are recorded."""


def write(rows: Sequence[AttemptRow], path: Path) -> None:
    """Write rows to a file that appears whole or not at all."""
    columns = {name: [row[name] for row in (each.values() for each in rows)] for name in FIELDS.names}
    _write(pa.table(columns, schema=FIELDS), path)


def merge(paths: Sequence[Path], target: Path) -> None:
    """Merge the rows of several files into one file, in order of scene, state and draw.

    Raises:
        IctampError: A file is damaged or has other columns.
    """
    table = pa.concat_tables([_read(path) for path in paths]).unify_dictionaries()
    _write(table.sort_by([(name, "ascending") for name in ORDER]), target)


def _read(path: Path) -> pa.Table:
    _check_columns(path)
    with reading(path):
        return pq.read_table(path, schema=FIELDS)


def _write(table: pa.Table, path: Path) -> None:
    words = [field.name for field in FIELDS if pa.types.is_dictionary(field.type)]
    with whole(path) as temporary:
        pq.write_table(
            table,
            temporary,
            compression="zstd",
            compression_level=12,
            use_dictionary=words,
            dictionary_pagesize_limit=2**26,  # the dictionary of scenes is large and must never fall back to plain text
            write_statistics=["scene"],
        )


def open_table(folder: Path) -> pads.Dataset:
    """Open the table of a folder without reading its rows; pyarrow can then select columns and rows, see `reading`.

    Raises:
        IctampError: There are no recorded attempts in the folder, or a file is damaged or has other columns.
    """
    paths = sorted(path for path in folder.glob("*.parquet") if not path.name.startswith("."))
    if not paths:
        advice = "collect some with ictamp_drake.experiments.collect"
        raise IctampError(Code.NOT_FOUND, "no recorded attempts (*.parquet)", file=folder, advice=advice)
    for path in paths:
        _check_columns(path)
    return pads.dataset(paths, schema=FIELDS, format="parquet")


def _check_columns(path: Path) -> None:
    with reading(path):
        found = pq.read_schema(path)
    for field in FIELDS:
        if field.name not in found.names:
            raise IctampError(Code.MISSING_FIELD, "missing column", field=field.name, file=path)


@contextmanager
def reading(path: Path) -> Iterator[None]:
    """Turn the errors of pyarrow, while it reads a file or a folder, into one sentence.

    Raises:
        IctampError: A file is damaged, is not a Parquet file or has columns of other types.
    """
    try:
        yield
    except (pa.ArrowException, OSError) as error:
        problem = f"cannot be read as Parquet: {str(error).partition(chr(10))[0].rstrip('.')}"
        raise IctampError(Code.DAMAGED, problem, file=path, advice="remove it, or fetch it again") from error


def read_rows(folder: Path, columns: Sequence[str], where: pads.Expression | None = None) -> pa.Table:
    """Read columns of the table of a folder, in order of scene, state and draw if it has these columns.

    Raises:
        IctampError: There are no recorded attempts in the folder, or a file is damaged or has other columns.
    """
    with reading(folder):
        table = open_table(folder).to_table(columns=list(columns), filter=where)
        order = [(name, "ascending") for name in ORDER]
        table = table.sort_by(order) if {*ORDER} <= {*columns} else table
    with in_file(folder):
        _check_complete(table)
    return table


def _check_complete(table: pa.Table | pa.RecordBatch) -> None:
    """Raise IctampError when a value is missing that every row must have."""
    for name in set(table.schema.names) - _OPTIONAL:
        if table[name].null_count:
            raise IctampError(Code.MISSING_FIELD, "missing value", field=name)


def scene_text(spec: SceneSpec) -> str:
    """A scene as it stands in a row, JSON because reading YAML takes a hundred times as long."""
    return json.dumps(to_dict(spec), separators=(",", ":"))


@lru_cache(maxsize=256)
def scene(text: str) -> SceneSpec:
    """The scene of a row."""
    return decode(SceneSpec, parse_json(text))


def configuration(row: Mapping[str, Any]) -> Configuration:
    """c of a row, as exact as its 32-bit numbers."""
    names = sorted(scene(row["spec"]).boxes)
    if len(row["poses"]) != 7 * len(names):
        problem = f"expected {7 * len(names)} numbers, got {{value}}"
        raise IctampError(Code.WRONG_LENGTH, problem, field="poses", value=row["poses"])
    poses = np.reshape(row["poses"], (-1, 7)).astype(np.float64)
    width, force = row["gripper"]
    q, fingers = np.split(np.array(row["q"], np.float64), [_ARM_JOINTS])
    boxes = dict(zip(names, poses, strict=True))
    return Configuration(q, fingers, boxes, row["held"], GripperCommand(width, force))


def action(row: Mapping[str, Any]) -> Action:
    """a of a row."""
    return Action(row["action"], (row["box"], row["place"]))


@dataclass(frozen=True, eq=False)
class Attempts:
    """Arrays of n attempts, to learn from.

    Attributes:
        matrix: Primitive state matrices, shape (n, 8, D).
        mask: True where a row of the matrix holds an object, shape (n, 8).
        k: Parameters of the skill, shape (n, 4).
        success: Whether the promised state was reached, shape (n,).
        moved: Pose (x, y, z, yaw) of the upright frame U of the action's box in c', in the target frame K of c, without
            its tilt; nan where c' is unknown, shape (n, 4) [m, rad].
        executed: Whether physics executed the attempt, shape (n,); motion planning refused all others.
        scene: Number of the training scene, by which data are split, shape (n,).
        state: Number of c in its scene, shape (n,).
        action: Skill, pick or place, shape (n,).
        sampler: Name of the source of k, shape (n,).
        failure: Name of the failure, empty for a success, shape (n,).
    """

    matrix: NDArray[np.float32]
    mask: NDArray[np.bool_]
    k: NDArray[np.float32]
    success: NDArray[np.bool_]
    moved: NDArray[np.float32]
    executed: NDArray[np.bool_]
    scene: NDArray[np.int32]
    state: NDArray[np.int16]
    action: NDArray[np.str_]
    sampler: NDArray[np.str_]
    failure: NDArray[np.str_]

    def __len__(self) -> int:
        return len(self.k)

    def select(self, rows: NDArray[Any]) -> "Attempts":
        """Select some of the attempts, by a mask or by their numbers."""
        return Attempts(**{field.name: getattr(self, field.name)[rows] for field in fields(self)})


def load(folder: Path, skill: str | None = None) -> Attempts:
    """Load all attempts of a folder that have a k, with their matrices in the current schema.

    Args:
        folder: Folder of Parquet files.
        skill: Skill, pick or place; both by default.

    Raises:
        IctampError: There are no recorded attempts in the folder, a file is damaged or has other columns, or a row
            lacks a value or does not fit its scene.
    """
    wanted = pads.field("k").is_valid()
    if skill is not None:
        wanted &= pads.field("action").cast(pa.string()) == skill
    with reading(folder), in_file(folder):
        parts = [_attempts(batch) for batch in open_table(folder).to_batches(filter=wanted) if batch.num_rows]
    if not parts:
        return _attempts(pa.RecordBatch.from_pylist([], schema=FIELDS))
    joined = {field.name: np.concatenate([getattr(part, field.name) for part in parts]) for field in fields(Attempts)}
    return Attempts(**joined)


def _attempts(batch: pa.RecordBatch) -> Attempts:
    _check_complete(batch)
    observation, moved = _observe(batch)
    k = batch["k"].flatten().to_numpy(zero_copy_only=False).reshape(-1, 4)
    for field, numbers in (("q", observation.matrix), ("k", k)):
        if not np.isfinite(numbers).all():
            raise IctampError(Code.DAMAGED, "expected finite numbers, got nan or infinity", field=field)
    failure = batch["failure"].cast(pa.string())
    return Attempts(
        *observation,
        k=k,
        success=failure.is_null().to_numpy(zero_copy_only=False),
        moved=moved,
        executed=batch["executed"].to_numpy(zero_copy_only=False),
        scene=batch["scene"].to_numpy(),
        state=batch["state"].to_numpy(),
        action=_words(batch["action"]),
        sampler=np.array([respell(word) for word in _words(batch["sampler"]).tolist()], dtype=np.str_),
        failure=_words(failure),
    )


def _words(column: pa.Array) -> NDArray[np.str_]:
    return np.array(column.cast(pa.string()).fill_null("").to_pylist(), dtype=np.str_)


def _observe(batch: pa.RecordBatch) -> tuple[Observation, NDArray[np.float32]]:
    """Compute the matrices of the rows, which are sorted by scene, and the new poses of their boxes."""
    rows = batch.select(["spec", "q", "poses", "held", "gripper", "action", "box", "place", "moved"]).to_pylist()
    seen = [_observe_scene(list(group)) for _, group in groupby(rows, key=itemgetter("spec"))]
    if not seen:
        nothing = np.zeros((0, ROWS, SCHEMA.width), np.float32)
        return Observation(nothing, np.zeros((0, ROWS), bool)), np.zeros((0, 4), np.float32)
    matrix, mask, moved = (np.concatenate(parts) for parts in zip(*seen, strict=True))
    return Observation(matrix, mask), moved


def _observe_scene(rows: Sequence[Mapping[str, Any]]) -> tuple[NDArray[Any], ...]:
    """Compute the matrices, masks and new box poses of the rows of one scene."""
    for row in rows:
        check_objects(row)
    watching, options = observer(rows[0]["spec"]), [(configuration(row), action(row)) for row in rows]
    X_WO = np.array([row["moved"] or [np.nan] * 7 for row in rows])
    return *watching.observe_all(options), watching.measure_moved_box(options, X_WO).astype(np.float32)


def check_objects(row: Mapping[str, Any]) -> None:
    """Raise IctampError unless the objects of a row are in its scene."""
    spec = scene(row["spec"])
    check_choice("action", row["action"], ("pick", "place"))
    check_choice("box", row["box"], spec.boxes)
    check_choice("place", row["place"], (*spec.supports, *spec.boxes))
    if row["held"] is not None:
        check_choice("held", row["held"], spec.boxes)


@lru_cache(maxsize=256)
def observer(text: str) -> Observer:
    """Makes the matrices of a row's scene."""
    return Observer(scene(text))


def fingerprint(folder: Path) -> str:
    """Short hash of the attempts in a folder, independent of how they are split into files."""
    import hashlib  # noqa: PLC0415

    table = read_rows(folder, [*ORDER, "executed", "failure", "k"])
    return hashlib.sha256(json.dumps(table.to_pylist()).encode()).hexdigest()[:16]
