"""The files in `sdf/` are what the script writes."""

import base64
import json

import numpy as np
import pytest

from ictamp_drake.models.write import FOLDER, contents

CONTENTS = contents()


def decoded(text: str) -> tuple[np.ndarray, list[int]]:
    """Vertices and normals of a glTF file, shape (n, 3), and the numbers of elements of its arrays."""
    document = json.loads(text)
    blob = base64.b64decode(document["buffers"][0]["uri"].split(",")[1])
    counts = [accessor["count"] for accessor in document["accessors"]]
    size = 12 * (counts[0] + counts[1])
    return np.frombuffer(blob[:size], "<f4").reshape(-1, 3), counts


def test_no_file_is_missing_or_left_over() -> None:
    assert {path.name for path in FOLDER.iterdir()} == set(CONTENTS)


@pytest.mark.parametrize("name", [name for name in CONTENTS if name.endswith(".sdf")])
def test_sdf_files_are_up_to_date(name: str) -> None:
    assert (FOLDER / name).read_text() == CONTENTS[name]


@pytest.mark.parametrize("name", [name for name in CONTENTS if name.endswith(".gltf")])
def test_bodies_are_up_to_date(name: str) -> None:
    committed, counts = decoded((FOLDER / name).read_text())
    fresh, fresh_counts = decoded(CONTENTS[name])
    assert counts == fresh_counts
    np.testing.assert_allclose(committed, fresh, atol=2e-3)


def test_files_are_small() -> None:
    assert sum(path.stat().st_size for path in FOLDER.iterdir()) < 1.5e6
