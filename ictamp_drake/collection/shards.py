"""Files of a collection: one part for each finished scene, joined in blocks of scenes."""

import re
from collections import Counter, defaultdict
from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from typing import Any

from ictamp_drake.learning.dataset import STAGES, AttemptRow, merge, read_rows, write

BLOCK = 100
"""Number of scenes whose rows share a file."""


class Shards:
    """Files of a collection in a folder, which survive an interruption at any moment."""

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._parts = folder / "parts"

    def add(self, scene: int, rows: Sequence[AttemptRow]) -> None:
        """Write the part of a scene, which completes the scene."""
        self._parts.mkdir(parents=True, exist_ok=True)
        write(rows, self._part(scene))
        self._note(scene).unlink(missing_ok=True)

    def begin(self, scene: int, attempt: int) -> None:
        """Record which attempt of a scene begins, in case the process does not survive it."""
        self._parts.mkdir(parents=True, exist_ok=True)
        self._note(scene).write_text(str(attempt))

    def read_begun(self, scene: int) -> int | None:
        """Number of the attempt of a scene that began last, or None when none is recorded."""
        text = self._note(scene).read_bytes() if self._note(scene).exists() else b""
        return int(text) if text.isdigit() else None

    def list_done(self) -> set[int]:
        """Numbers of the finished scenes."""
        return {scene for first, last in self._blocks() for scene in range(first, last + 1)} | self._list_loose()

    def join(self, scenes: Sequence[int]) -> None:
        """Join the loose parts of these scenes in blocks, wherever all scenes of a block are finished."""
        joined = {scene for first, last in self._blocks() for scene in range(first, last + 1)}
        for scene in joined & self._list_loose():  # interrupted after its block was written
            self._part(scene).unlink()
        loose = self._list_loose()
        for start in range(0, len(scenes), BLOCK):
            block = scenes[start : start + BLOCK]
            parts = sorted(loose.intersection(block))
            if parts and loose | joined >= set(block):
                merge([self._part(scene) for scene in parts], self._folder / f"{parts[0]:06d}-{parts[-1]:06d}.parquet")
                for scene in parts:
                    self._part(scene).unlink()

    def _part(self, scene: int) -> Path:
        return self._parts / f"{scene:06d}.parquet"

    def _note(self, scene: int) -> Path:
        return self._parts / f"{scene:06d}.attempt"

    def _list_loose(self) -> set[int]:
        return {int(path.stem) for path in self._parts.glob("*.parquet") if path.stem.isdigit()}

    def _blocks(self) -> Iterator[tuple[int, int]]:
        for path in self._folder.glob("*.parquet"):
            found = re.fullmatch(r"(\d+)-(\d+)", path.stem)
            if found:
                yield int(found[1]), int(found[2])


def summary(folder: Path) -> dict[str, Any]:
    """Summarize a folder of joined attempts, in JSON types.

    Raises:
        IctampError: There are no recorded attempts in the folder, or a file is damaged or has other columns.
    """
    stages = [f"{stage}_ms" for stage in STAGES]
    rows = read_rows(folder, ["scene", "action", "sampler", "failure", "executed", *stages]).to_pylist()
    seconds = {stage: sum(row[f"{stage}_ms"] for row in rows) / 1000 for stage in STAGES}
    size = sum(path.stat().st_size for path in folder.glob("*.parquet"))
    by_sampler, failures = defaultdict[str, list[dict[str, Any]]](list), defaultdict[str, Counter[str]](Counter)
    for row in rows:
        by_sampler[f"{row['action']}, {row['sampler']}"].append(row)
        failures[row["action"]].update([row["failure"]] if row["failure"] else [])
    return {
        "scenes": len({row["scene"] for row in rows}),
        **_counts(rows),
        "bytes": size,
        "cpu_hours": {stage: round(value / 3600, 3) for stage, value in seconds.items()},
        "by_skill_and_sampler": {name: _counts(group) for name, group in sorted(by_sampler.items())},
        "failures": {action: dict(counts.most_common()) for action, counts in sorted(failures.items())},
    }


def _counts(rows: Sequence[Mapping[str, Any]]) -> dict[str, int]:
    return {
        "attempts": len(rows),
        "executed": sum(row["executed"] for row in rows),
        "succeeded": sum(row["failure"] is None for row in rows),
    }
