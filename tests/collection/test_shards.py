"""Shards of scenes, and the blocks into which they are joined."""

from pathlib import Path

import pytest

from ictamp_drake.collection.shards import BLOCK, Shards
from ictamp_drake.core.errors import Code
from tests.refusals import refusal


def names(folder: Path) -> list[str]:
    return sorted(path.name for path in folder.glob("*.parquet"))


def test_blocks_are_joined_as_soon_as_all_of_their_scenes_are_over(tmp_path: Path) -> None:
    shards, scenes = Shards(tmp_path), range(2 * BLOCK)
    for scene in range(BLOCK - 1):
        shards.add(scene, [])
    shards.join(scenes)
    assert names(tmp_path) == []
    shards.add(BLOCK - 1, [])
    shards.add(BLOCK, [])
    shards.join(scenes)
    assert names(tmp_path) == [f"000000-{BLOCK - 1:06d}.parquet"]
    assert names(tmp_path / "parts") == [f"{BLOCK:06d}.parquet"]
    assert shards.list_done() == set(range(BLOCK + 1))


def test_a_part_that_is_left_of_a_joined_block_goes(tmp_path: Path) -> None:
    shards = Shards(tmp_path)
    for scene in range(3):
        shards.add(scene, [])
    left = (tmp_path / "parts" / "000001.parquet").read_bytes()
    shards.join(range(3))
    (tmp_path / "parts" / "000001.parquet").write_bytes(left)
    shards.join(range(3))
    assert names(tmp_path) == ["000000-000002.parquet"]
    assert names(tmp_path / "parts") == []


def test_ranges_that_overlap_share_their_scenes(tmp_path: Path) -> None:
    shards = Shards(tmp_path)
    for scene in (5, 6):
        shards.add(scene, [])
    shards.join([5, 6])
    for scene in (4, 7):
        shards.add(scene, [])
    shards.join([4, 5, 6, 7])
    assert shards.list_done() == {4, 5, 6, 7}
    assert names(tmp_path) == ["000004-000007.parquet", "000005-000006.parquet"]


@pytest.mark.parametrize("content", [b"", b"PAR1", b"version https://git-lfs.github.com/spec/v1\n"])
def test_a_damaged_part_is_named_and_nothing_is_joined(content: bytes, tmp_path: Path) -> None:
    shards, scenes = Shards(tmp_path), range(BLOCK)
    for scene in scenes:
        shards.add(scene, [])
    part = tmp_path / "parts" / "000007.parquet"
    part.write_bytes(content)
    with refusal(Code.DAMAGED, file=part):
        shards.join(scenes)
    assert names(tmp_path) == []
    assert len(names(tmp_path / "parts")) == BLOCK


@pytest.mark.parametrize("content", [b"", b"x", b"\xff\x00", b"-3"])
def test_a_note_that_cannot_be_read_counts_as_none(content: bytes, tmp_path: Path) -> None:
    shards = Shards(tmp_path)
    shards.begin(3, 5)
    assert shards.read_begun(3) == 5
    (tmp_path / "parts" / "000003.attempt").write_bytes(content)
    assert shards.read_begun(3) is None
