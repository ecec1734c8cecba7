"""Spoiled scene files are functions of their number, and loading them ends in a sentence or a task."""

from pathlib import Path

import pytest

from benchmarks.fuzz_scenes import ACCEPTED, SENTENCE, attempt
from benchmarks.spoiled import BASE, CLASSES, spoiled
from ictamp_drake.tamp.task import load

SEED = 7


def test_the_scene_that_is_spoiled_is_valid(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    path.write_text(BASE)
    assert load(path).goal


def test_the_files_are_in_all_classes_and_stay_the_same() -> None:
    files = [spoiled(SEED, number) for number in range(100)]
    assert files == [spoiled(SEED, number) for number in range(100)]
    kinds = [kind for kind, _ in files]
    assert {kind: kinds.count(kind) for kind in kinds} == {make.__name__: share for make, share in CLASSES.items()}


@pytest.mark.slow
def test_no_file_ends_otherwise_than_in_a_sentence_or_a_task(tmp_path: Path) -> None:
    path = tmp_path / "scene.yaml"
    for number in range(100):
        kind, content = spoiled(SEED, number)
        path.write_bytes(content)
        outcome, detail = attempt(path)
        assert outcome in (SENTENCE, ACCEPTED), (number, kind, detail)
