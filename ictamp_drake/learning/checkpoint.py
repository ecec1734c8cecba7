"""Checkpoint files: trained arrays as safetensors, with JSON metadata that explains them. Works without torch."""

import json
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, Literal

import numpy as np
from numpy.typing import NDArray
from safetensors import SafetensorError, safe_open
from safetensors.numpy import save_file

from ictamp_drake.core.decoding import decode, mapping
from ictamp_drake.core.errors import Code, IctampError
from ictamp_drake.core.files import whole
from ictamp_drake.core.reading import in_file, parse_json
from ictamp_drake.observation.state_matrix import SCHEMA

SHIPPED = Path(__file__).parent / "checkpoints"
"""Folder of the checkpoints that come with the package."""

SKILLS = ("pick", "place")
"""Skills, each with its own networks."""

K_SCHEMA = {
    "version": 3,
    "pick": "x, y, z over half the box's sides along U's axes; yaw in radians",
    "place": "x, y over half the top face's sides, z as (z - 0.010 m) / 0.012 m; yaw in radians",
    "networks": "also see the hand at k from the base, all objects from k, and what is free around the hand",
}
"""Encoding of k in the networks; a new version of `learning.parameters` needs a new version here."""

_METADATA = "ictamp_drake"
Kind = Literal["policy", "estimator", "dynamics"]
_PROGRAMS: Mapping[Kind, str] = {
    "policy": "train_skill",
    "estimator": "train_estimator",
    "dynamics": "train_dynamics",
}
Arrays = Mapping[str, NDArray[Any]]


@dataclass(frozen=True, eq=False)
class Checkpoint:
    """Trained networks of one skill.

    Attributes:
        kind: Kind of networks: a policy with the critics it was trained on, an estimator of P, or dynamics.
        skill: Skill, pick or place.
        arrays: Weights and other arrays of the networks, by name.
        network: Configuration of the networks.
        provenance: Command, fingerprint of the attempts, commit, and similar facts.
        metrics: Figures on held-out scenes.
    """

    kind: Kind
    skill: str
    arrays: Arrays
    network: Mapping[str, Any]
    provenance: Mapping[str, Any]
    metrics: Mapping[str, float]

    def save(self, folder: Path) -> Path:
        """Write to a folder, under the file name that `load` reads."""
        folder.mkdir(parents=True, exist_ok=True)
        metadata = {name: getattr(self, name) for name in ("kind", "skill", "network", "provenance", "metrics")}
        path = folder / name_of(self.kind, self.skill)
        write(path, self.arrays, {**metadata, "schema": SCHEMA.as_dict(), "k": K_SCHEMA})
        return path


def name_of(kind: Kind, skill: str) -> str:
    """File name of a checkpoint."""
    return f"{skill}_{kind}.safetensors"


def load(folder: Path, kind: Kind, skill: str) -> Checkpoint:
    """Load the checkpoint of a skill from a folder.

    Raises:
        IctampError: The file is missing or damaged, holds something else, or was trained on another version of the
            state matrix or of k.
    """
    path = folder / name_of(kind, skill)
    if not path.is_file():
        advice = f"train it with ictamp_drake.experiments.{_PROGRAMS[kind]}, or give the folder that has it"
        raise IctampError(Code.NOT_FOUND, "no such checkpoint", file=path, advice=advice)
    arrays, metadata = read(path)
    with in_file(path):
        found = decode(_Metadata, metadata)
        _check_metadata(found, kind, skill)
        _check_arrays(arrays)
    return Checkpoint(kind, skill, arrays, found.network, found.provenance, found.metrics)


@dataclass(frozen=True)
class _Metadata:
    """Meaning of a file's numbers."""

    kind: str
    skill: str
    network: dict[str, object]
    provenance: dict[str, object]
    metrics: dict[str, float]
    schema: dict[str, object]
    k: dict[str, object]


def _check_metadata(found: _Metadata, kind: Kind, skill: str) -> None:
    """Raise IctampError unless the numbers are what is looked for, and made by this version."""
    holds, wanted = f"{found.kind} of {found.skill}", f"{kind} of {skill}"
    if holds != wanted:
        raise IctampError(Code.WRONG_TYPE, f"expected the {wanted}, got the {holds}", field="kind", value=holds)
    versions = {
        "schema": (found.schema, json.loads(json.dumps(SCHEMA.as_dict()))),
        "k": (found.k, json.loads(json.dumps(K_SCHEMA))),
    }
    for field, (theirs, ours) in versions.items():
        if theirs != ours:
            problem = f"expected version {ours['version']} of the networks' input, got {{value}}"
            version = theirs.get("version")
            advice = "train it again"
            raise IctampError(Code.OTHER_VERSION, problem, field=f"{field}.version", value=version, advice=advice)


def _check_arrays(arrays: Arrays) -> None:
    """Raise IctampError unless all weights are finite numbers."""
    for name, array in arrays.items():
        if not np.isfinite(array).all():
            raise IctampError(Code.DAMAGED, "expected finite numbers, got nan or infinity", field=name)


def check_all(folder: Path, kind: Kind) -> None:
    """Raise IctampError unless the checkpoints of all skills can be loaded, see `load`."""
    for skill in SKILLS:
        load(folder, kind, skill)


def write(path: Path, arrays: Arrays, metadata: Mapping[str, Any]) -> None:
    """Write arrays, and metadata as JSON, to a file that appears whole or not at all."""
    text = json.dumps(metadata)  # as one entry, since the order of several entries varies
    with whole(path) as temporary:
        save_file({name: np.ascontiguousarray(array) for name, array in arrays.items()}, temporary, {_METADATA: text})
        temporary.chmod(0o644)


def read(path: Path) -> tuple[Arrays, dict[str, Any]]:
    """Read the arrays and metadata of a file.

    Raises:
        IctampError: The file is damaged.
    """
    try:
        with safe_open(path, framework="np") as file:
            text = (file.metadata() or {}).get(_METADATA, "{}")
            arrays = {name: file.get_tensor(name) for name in file.keys()}  # noqa: SIM118  (not a dict)
    except (SafetensorError, OSError, ValueError) as error:
        raise IctampError(Code.DAMAGED, f"cannot be read as safetensors: {error}", file=path) from error
    with in_file(path):
        return arrays, dict(mapping(parse_json(text)))
