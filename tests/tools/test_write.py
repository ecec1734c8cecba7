"""The files in `sdf/` equal the output of the script."""

import base64
import json

import numpy as np
import pytest

from ictamp_drake.models.things import FOLDER
from tools.write import contents

CONTENTS = contents()


def decode_gltf(text: str) -> tuple[np.ndarray, np.ndarray, int]:
    """Vertices and normals of a glTF file, shape (n, 3) each, and three times the number of its triangles."""
    document = json.loads(text)
    blob = base64.b64decode(document["buffers"][0]["uri"].split(",")[1])
    count, _, corners = (accessor["count"] for accessor in document["accessors"])
    vectors = np.frombuffer(blob[: 24 * count], "<f4").reshape(2, -1, 3)
    return vectors[0], vectors[1], corners


def test_no_file_is_missing_or_left_over() -> None:
    assert {path.name for path in FOLDER.iterdir()} == set(CONTENTS)


@pytest.mark.parametrize("name", [name for name in CONTENTS if name.endswith(".sdf")])
def test_sdf_files_are_up_to_date(name: str) -> None:
    assert (FOLDER / name).read_text() == CONTENTS[name]


@pytest.mark.parametrize("name", [name for name in CONTENTS if name.endswith(".gltf")])
def test_bodies_are_up_to_date(name: str) -> None:
    vertices, normals, corners = decode_gltf((FOLDER / name).read_text())
    fresh_vertices, fresh_normals, fresh_corners = decode_gltf(CONTENTS[name])
    assert corners == fresh_corners
    np.testing.assert_allclose(vertices, fresh_vertices, atol=3e-5)
    np.testing.assert_allclose(normals, fresh_normals, atol=5e-3)


def test_files_are_small() -> None:
    assert sum(path.stat().st_size for path in FOLDER.iterdir()) < 1.8e6
